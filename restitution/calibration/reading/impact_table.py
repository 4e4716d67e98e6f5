"""A table of impacts as observations: St and e_eff as given, or derived from speeds with their errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution.calibration.reading.impact_checks import CONDITIONS, TableCheck
from restitution.calibration.reading.observations import (
    WITHOUT_REBOUND,
    Observations,
    correlation_of_independent_speeds,
)
from restitution.calibration.reading.reading import Reading
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.errors import Defect, InputError
from restitution.stokes import convention
from restitution.tables.schema import read_schema

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = Path(__file__).with_name("measurement.json")


def from_table(
    table: pd.DataFrame, how: Reading, file: str, digest: str, form_defects: Iterable[Defect] = ()
) -> Observations:
    """Observations of a table that has some of the columns of the schema; raises with all that is wrong in it.

    Rows of the file are its index if that is called ``row``, else they count from 2. ``form_defects`` are those
    of the table's form, to be named with the others.
    """
    rows = table.index.to_numpy() if table.index.name == "row" else np.arange(len(table)) + 2
    table = table.reindex(columns=list(dict.fromkeys([*read_schema(SCHEMA).columns, *table.columns])))
    # A text column that the table lacks would be one of numbers, and take no text in its place.
    table = table.astype({f.name: object for f in read_schema(SCHEMA).fields if f.type == "string"})
    use, selection = _selected(table, how, file)
    table, rows = table[use].reset_index(drop=True), rows[use]
    per_row = _row_conditions(table, how)
    none = table["outcome"].isin(WITHOUT_REBOUND).to_numpy(bool)
    check = TableCheck(table, how, file, rows, form_defects)
    check.errors()
    speed, stokes, edge = check.speed(), check.stokes(per_row), check.edge()
    check.dry()
    e = _restitution(table)
    check.restitution(e, none)
    if check.defects:
        raise InputError(*sorted(check.defects, key=lambda d: d.row or 0))
    St, St_sigma = _stokes(table, stokes, per_row)
    e_sigma, correlation = _errors(table, e, St, St_sigma)
    without = np.isnan(e_sigma) & ~none
    if how.e_sigma is not None:
        e_sigma = np.where(without, how.e_sigma, e_sigma)
        selection.append(f"{file}: {without.sum()} impacts state no error of e_eff: {how.e_sigma:g}, as given")
    notes = (
        *selection,
        *_missing_sigmas(e_sigma, none, file),
        *_limits_of_zero(none & table["e_eff_upper"].isna(), file),
        *_zeros((e == 0) & ~none, file),
    )
    read = table.assign(
        source=table["source"].fillna(table["record"]).fillna(Path(file).stem),
        stokes=St, stokes_sigma=St_sigma, stokes_convention=stokes, speed_definition=speed, film_edge_d=edge,
        e_eff=e, e_eff_sigma=e_sigma, e_stokes_correlation=correlation,
    )  # fmt: skip
    places = tuple((file, int(row)) for row in rows)
    return Observations.from_impacts(read, per_row, places=places, files={file: digest}, notes=notes)


def _selected(table: pd.DataFrame, how: Reading, file: str) -> tuple[np.ndarray, list[str]]:
    """Which rows are taken, and what was left out in words.

    Simulated impacts are never taken together with measured ones. Of a table under several definitions of speed,
    as this package writes them, the rows of the one that is asked for are taken.
    """
    simulated = (table["kind"] == "simulated").to_numpy(bool)
    every = len(table) > 0 and bool(simulated.all())
    use, notes = simulated if every else ~simulated, []
    if every:
        notes.append(f"{file}: the impacts are simulated: what is fitted is a model, not measurements")
    elif simulated.any():
        notes.append(f"{file}: {simulated.sum()} simulated impacts are left out")
    stated = table["speed_definition"]
    if how.speed is not None and stated.nunique() > 1 and (stated == str(how.speed)).any():
        other = use & (stated != str(how.speed)).to_numpy(bool)
        notes.append(f"{file}: {other.sum()} impacts under other definitions than {how.speed} are left out")
        use = use & ~other
    return use, notes


def conditions_of_row(row: Mapping[str, float]) -> Conditions:
    """Fluid and sphere of a row that has their columns."""
    e_dry = None if np.isnan(row["e_dry"]) else float(row["e_dry"])
    rho_f, mu, d, rho_p = (float(row[name]) for name in CONDITIONS)
    return Conditions(
        fluid=Fluid(density=rho_f, viscosity=mu), sphere=Sphere(diameter=d, density=rho_p, e_dry=e_dry)
    )


def _row_conditions(table: pd.DataFrame, how: Reading) -> list[Conditions | None]:
    """The conditions of each row: its own columns where all four are there, else the caller's."""
    known: dict[tuple, Conditions] = {}
    result = []
    for row in table[[*CONDITIONS, "e_dry"]].itertuples(index=False):
        if any(np.isnan(x) for x in row[:4]):
            result.append(how.conditions)
            continue
        key = tuple(np.nan_to_num(row, nan=-1.0))
        if key not in known:
            known[key] = conditions_of_row(dict(zip((*CONDITIONS, "e_dry"), row, strict=True)))
        result.append(known[key])
    return result


def _stokes(table: pd.DataFrame, key: str, conditions: list) -> tuple[np.ndarray, np.ndarray]:
    """St and its error as the table gives them, or from the impact speed and the conditions."""
    St, sigma = table["stokes"].to_numpy(float).copy(), table["stokes_sigma"].to_numpy(float).copy()
    v, v_sigma = table["impact_speed_m_s"].to_numpy(float), table["impact_speed_sigma_m_s"].to_numpy(float)
    for i in np.flatnonzero(np.isnan(St)):
        per_speed = convention(key).per_speed(conditions[i])
        St[i], sigma[i] = v[i] * per_speed, v_sigma[i] * per_speed
    return St, sigma


def _restitution(table: pd.DataFrame) -> np.ndarray:
    """e_eff as given, or the ratio of the speeds."""
    e = table["e_eff"].to_numpy(float)
    ratio = table["rebound_speed_m_s"].to_numpy(float) / table["impact_speed_m_s"].to_numpy(float)
    return np.where(np.isnan(e), ratio, e)


def _errors(
    table: pd.DataFrame, e: np.ndarray, St: np.ndarray, St_sigma: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The error of e_eff and its correlation with that of St, as given or from independent speeds."""
    sigma, correlation = table["e_eff_sigma"].to_numpy(float), table["e_stokes_correlation"].to_numpy(float)
    v_in, s_in = table["impact_speed_m_s"].to_numpy(float), table["impact_speed_sigma_m_s"].to_numpy(float)
    s_out = table["rebound_speed_sigma_m_s"].to_numpy(float)
    use = table["e_eff"].isna().to_numpy(bool) & np.isnan(sigma)
    with np.errstate(divide="ignore", invalid="ignore"):
        from_speeds = np.hypot(s_out, e * np.nan_to_num(s_in)) / v_in
        rho = correlation_of_independent_speeds(e, from_speeds, St, St_sigma)
    return np.where(use, from_speeds, sigma), np.where(use & np.isnan(correlation), rho, correlation)


def _zeros(zero: np.ndarray, file: str) -> tuple[str, ...]:
    n = int(zero.sum())
    if not n:
        return ()
    rule = "give an impact without a rebound the outcome no_rebound and the least e_eff that would have been seen"
    return (f"{file}: e_eff is exactly 0 in {n} rows and taken as measured; {rule} as e_eff_upper",)


def _limits_of_zero(without: pd.Series, file: str) -> tuple[str, ...]:
    n = int(without.sum())
    if not n:
        return ()
    return (
        f"{file}: {n} impacts without a rebound state no e_eff_upper and count as e_eff <= 0; give the least "
        "e_eff that would have been seen",
    )


def _missing_sigmas(e_sigma: np.ndarray, none: np.ndarray, file: str) -> tuple[str, ...]:
    missing, n = int((np.isnan(e_sigma) & ~none).sum()), int((~none).sum())
    if not missing:
        return ()
    if missing == n:
        return (f"{file}: no errors of e_eff are given; they are estimated together with the scatter",)
    return (f"{file}: {missing} of {n} errors of e_eff are missing; the median of the others is taken",)
