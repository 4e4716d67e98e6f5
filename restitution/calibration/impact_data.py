"""Reading what is fitted: tables of impacts and camera tracks, to one set of observations.

A table of impacts has the columns of ``measurement.json`` or others mapped to them; a track has ``time_s`` and
``gap_m`` or ``velocity_m_s`` and becomes impacts by :mod:`restitution.impacts`. Which Stokes number and which
impact speed is meant is stated by columns or by the caller, never assumed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.calibration.digitizer import PIXEL, is_export, read_export
from restitution.calibration.observations import Observations, join
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.errors import Defect, InputError
from restitution.impacts import find_impacts
from restitution.stokes import Speed, convention
from restitution.table_schema import read_schema
from restitution.tables import read_header, read_table
from restitution.tracks import Track

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = Path(__file__).with_name("measurement.json")
_CONDITIONS = ("fluid_density_kg_m3", "fluid_viscosity_Pa_s", "sphere_diameter_m", "sphere_density_kg_m3")
_SIGMAS = ("e_eff_sigma", "stokes_sigma", "e_dry_sigma", "impact_speed_sigma_m_s", "rebound_speed_sigma_m_s")
_GROUPS = ("material", "record")


@dataclass(frozen=True)
class Reading:
    """How files are read. ``columns`` maps columns of the schema to the files' own names."""

    stokes: str | None = None
    speed: Speed | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    conditions: Conditions | None = None
    unphysical: bool = False
    """Admit e_eff above 1 or below 0."""
    axes: tuple[str, str] = ("stokes", "e_eff")
    """Which columns x and y of a digitised plot are."""


def read(paths: list[str | Path], how: Reading) -> Observations:
    """The impacts of all files, or of shipped records; raises :class:`InputError` with what is wrong and where."""
    return join([_read_one(str(path), how) for path in paths])


def _read_one(path: str, how: Reading) -> Observations:
    if not Path(path).exists():
        if path in datasets.names():
            resource = datasets.resource(path)
            digest = resource.hash.removeprefix("sha256:")
            conditions = how.conditions or resource.conditions
            return from_track(datasets.load_track(path), conditions, how, path, digest)
        raise InputError(Defect("does not exist, and no shipped record has this name", path))
    if is_export(path):
        digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
        return from_digitised(path, how, digest)
    header = {how.columns.get(name, name) for name in ("time_s", "gap_m", "velocity_m_s")} & set(read_header(path))
    digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
    if len(header) == 2 and how.columns.get("time_s", "time_s") in header:
        return _track_file(path, how, digest)
    schema = read_schema(SCHEMA)
    known = set(schema.columns)
    for name in how.columns:
        if name not in known:
            raise InputError(
                Defect(f"is not a column that a fit uses; known: {', '.join(schema.columns)}", field=name)
            )
    return from_table(read_table(path, schema, how.columns), how, path, digest)


def _track_file(path: str, how: Reading, digest: str) -> Observations:
    track, conditions = track_of(path, how)
    return from_track(track, conditions, how, path, digest)


def track_of(path: str, how: Reading) -> tuple[Track, Conditions]:
    """The track in a file, and its conditions: the caller's, or those that its own columns state."""
    conditions = how.conditions or _conditions_of_track(path)
    columns = {k: v for k, v in how.columns.items() if k in ("time_s", "gap_m", "velocity_m_s")}
    header = read_header(path)
    value = next(name for name in ("gap_m", "velocity_m_s") if columns.get(name, name) in header)
    schema = datasets.schema("trajectory" if value == "gap_m" else "settling")
    mapped = {name: columns.get(name, name) for name in ("time_s", value)}
    return Track.from_table(read_table(path, schema, mapped)), conditions


def from_digitised(path: str, how: Reading, digest: str) -> Observations:
    """The points of a digitised plot, each data set a source."""
    columns = read_schema(SCHEMA).columns
    for option, name in zip(("--x", "--y"), how.axes, strict=True):
        if name not in columns:
            rule = f"is not a column that a fit uses; known: {', '.join(columns)}"
            raise InputError(Defect(rule, None, None, option, name))
    found = from_table(read_export(path, how.axes), how, path, digest)
    if not path.endswith(".json"):
        return found
    note = f"{path}: errors are those of a click, {PIXEL:g} pixel; those of the measurement are in the scatter"
    return replace(found, notes=(*found.notes, note))


def _conditions_of_track(path: str) -> Conditions:
    """The conditions that a track's own columns state, the same in every row."""
    header = read_header(path)
    needed = (*_CONDITIONS, "e_dry")
    if not set(needed) <= set(header):
        rule = f"is a track; fluid and sphere are needed: --conditions FILE, or the columns {', '.join(needed)}"
        raise InputError(Defect(rule, path))
    table = read_table(path, read_schema(SCHEMA), {name: name for name in needed})
    for name in needed:
        if table[name].nunique(dropna=False) != 1:
            row = int((table[name] != table[name].iloc[0]).to_numpy().argmax()) + 2
            raise InputError(Defect("must be the same in all rows of a track", path, row, name))
    return _conditions(table.iloc[0])


def from_track(track: Track, conditions: Conditions, how: Reading, name: str, digest: str) -> Observations:
    """The impacts of one track under the stated definition of speed, which must be far, contact or window."""
    speed = _stated_speed(how.speed, name)
    if speed not in (Speed.FAR, Speed.CONTACT, Speed.WINDOW):
        raise InputError(
            Defect("a track gives the far, contact or window speed", name, None, "--speed", str(speed))
        )
    stokes = how.stokes or "st"
    found = find_impacts(track, conditions, speed, stokes, Path(name).stem)
    if not found.rows:
        raise InputError(Defect("no impact is resolved in this track", name))
    how = replace(how, stokes=stokes, conditions=conditions)
    return replace(
        from_table(found.table().assign(source=Path(name).stem), how, name, digest),
        places=tuple((f"{name}, impact", int(row["impact"])) for row in found.rows),
        notes=tuple(f"{name}: {note}" for note in found.notes),
    )


def from_table(table: pd.DataFrame, how: Reading, file: str, digest: str) -> Observations:
    """Observations of a table that has some of the columns of the schema; row 2 of the file is its first."""
    table = table.reindex(columns=list(dict.fromkeys([*read_schema(SCHEMA).columns, *table.columns])))
    # A text column that the table lacks would be one of numbers, and take no text in its place.
    table = table.astype({f.name: object for f in read_schema(SCHEMA).fields if f.type == "string"})
    rows = np.arange(len(table)) + 2
    use = np.array([kind != "simulated" for kind in table["kind"]], bool)
    table, rows = table[use].reset_index(drop=True), rows[use]
    defects = [
        Defect("must be positive; leave the cell empty where it is not known", file, int(rows[i]), name, f"{x:g}")
        for name in _SIGMAS
        for i, x in enumerate(table[name].to_numpy(float))
        if x <= 0 or np.isinf(x)
    ]
    if defects:
        raise InputError(*defects)
    speed = _one(table, "speed_definition", how.speed, "--speed", file, rows)
    speed = _stated_speed(speed, file)
    per_row = _row_conditions(table, how)
    St, St_sigma, stokes = _stokes(table, how, per_row, file, rows)
    e, e_sigma, correlation = _restitution(table, St, St_sigma)
    none = (table["outcome"].isin(["no_rebound", "not_resolved"])).to_numpy(bool)
    upper = np.where(none, table["e_eff_upper"].fillna(0.0).to_numpy(float), np.nan)
    e = np.where(none, np.nan, e)
    _check_restitution(e, none, how.unphysical, file, rows)
    notes = _missing_sigmas(e_sigma, none, file) + _limits_of_zero(none & table["e_eff_upper"].isna(), file)
    known = e_sigma[~none & np.isfinite(e_sigma)]
    # A limit has no error of its own; that of a typical measured impact blurs it.
    e_sigma = np.where(np.isfinite(e_sigma), e_sigma, np.median(known) if len(known) else 0.0)
    e_dry = table["e_dry"].to_numpy(float)
    stated = np.array([np.nan if c is None or c.sphere.e_dry is None else c.sphere.e_dry for c in per_row])
    source = table["source"].fillna(table["record"]).fillna(Path(file).stem).to_numpy(object)
    labels = {"source": source}
    labels |= {n: table[n].fillna("").to_numpy(object) for n in _GROUPS if table[n].notna().any()}
    return Observations(
        St=St,
        St_sigma=np.nan_to_num(St_sigma),
        e=e,
        e_sigma=e_sigma,
        correlation=np.where(np.isnan(correlation) | (e_sigma == 0), 0.0, correlation),
        upper=upper,
        e_dry=np.where(np.isnan(e_dry), stated, e_dry),
        e_dry_sigma=table["e_dry_sigma"].to_numpy(float),
        labels=labels,
        convention=stokes,
        speed=speed,
        conditions=tuple(per_row),
        places=tuple((file, int(row)) for row in rows),
        files={file: digest},
        notes=notes,
    )


def _one(table, column: str, given: str | None, option: str, file: str, rows: np.ndarray) -> str | None:
    """The one value of a column that states a convention, or the caller's; None where nobody states it."""
    stated = table[column].dropna()
    if stated.empty:
        return given
    first = stated.iloc[0]
    for i, value in stated.items():
        if value != first:
            rule = f"differs from {first!r} in row {rows[stated.index[0]]}: one file has one definition; split it"
            raise InputError(Defect(rule, file, int(rows[i]), column, value))
    if given is not None and given != first:
        raise InputError(Defect(f"the file states another: {first!r}", file, int(rows[0]), option, str(given)))
    if len(stated) < len(table):
        row = int(rows[np.flatnonzero(table[column].isna())[0]])
        raise InputError(Defect("is empty here and given in other rows: give it in all", file, row, column))
    return first


def _stated_speed(speed: str | None, file: str) -> Speed:
    if speed is None:
        rule = (
            "which impact speed e_eff and St were made with is not stated: --speed far (outside the film), "
            "contact, window, film_edge or unstated, or the column speed_definition"
        )
        raise InputError(Defect(rule, file))
    return Speed(speed)


def _conditions(row: pd.Series) -> Conditions:
    e_dry = None if np.isnan(row["e_dry"]) else float(row["e_dry"])
    rho_f, mu, d, rho_p = (float(row[name]) for name in _CONDITIONS)
    return Conditions(
        fluid=Fluid(density=rho_f, viscosity=mu), sphere=Sphere(diameter=d, density=rho_p, e_dry=e_dry)
    )


def _row_conditions(table: pd.DataFrame, how: Reading) -> list[Conditions | None]:
    """The conditions of each row: its own columns where all four are there, else the caller's."""
    known: dict[tuple, Conditions] = {}
    result = []
    for row in table[[*_CONDITIONS, "e_dry"]].itertuples(index=False):
        if any(np.isnan(x) for x in row[:4]):
            result.append(how.conditions)
            continue
        key = tuple(np.nan_to_num(row, nan=-1.0))
        if key not in known:
            known[key] = _conditions(dict(zip((*_CONDITIONS, "e_dry"), row, strict=True)))
        result.append(known[key])
    return result


def _stokes(
    table: pd.DataFrame, how: Reading, conditions: list, file: str, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray, str]:
    """St and its error as the table gives them, or from the impact speed and the conditions."""
    St, sigma = table["stokes"].to_numpy(float).copy(), table["stokes_sigma"].to_numpy(float).copy()
    given = np.isfinite(St)
    key = _one(table, "stokes_convention", how.stokes, "--stokes", file, rows)
    if given.any() and key is None:
        rule = (
            "which Stokes number this is, is not stated: --stokes st (rho_p v d/(9 mu)), st_star, st_d, st_18 or "
            "st_b, or the column stokes_convention"
        )
        raise InputError(Defect(rule, file, int(rows[int(np.argmax(given))]), "stokes"))
    key = key or "st"
    convention(key)
    v, v_sigma = table["impact_speed_m_s"].to_numpy(float), table["impact_speed_sigma_m_s"].to_numpy(float)
    for i in np.flatnonzero(~given):
        if np.isnan(v[i]):
            rule = "is not given, nor the impact_speed_m_s and conditions that it would follow from"
            raise InputError(Defect(rule, file, int(rows[i]), "stokes"))
        if conditions[i] is None:
            rule = (
                f"needs fluid and sphere to become a Stokes number: {', '.join(_CONDITIONS)}, or --conditions FILE"
            )
            raise InputError(Defect(rule, file, int(rows[i]), "impact_speed_m_s", f"{v[i]:g}"))
        per_speed = convention(key).per_speed(conditions[i])
        St[i], sigma[i] = v[i] * per_speed, v_sigma[i] * per_speed
    return St, sigma, key


def _restitution(
    table: pd.DataFrame, St: np.ndarray, St_sigma: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """e_eff, its error and the correlation with that of St, as given or from independent speeds."""
    e, sigma = table["e_eff"].to_numpy(float), table["e_eff_sigma"].to_numpy(float)
    correlation = table["e_stokes_correlation"].to_numpy(float)
    v_in, s_in = table["impact_speed_m_s"].to_numpy(float), table["impact_speed_sigma_m_s"].to_numpy(float)
    v_out, s_out = table["rebound_speed_m_s"].to_numpy(float), table["rebound_speed_sigma_m_s"].to_numpy(float)
    derived = np.isnan(e) & np.isfinite(v_in) & np.isfinite(v_out)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = v_out / v_in
        from_speeds = np.hypot(s_out, ratio * np.nan_to_num(s_in)) / v_in
        # rho sigma_e sigma_St = -e sigma_St^2 / St
        rho = -ratio * St_sigma / (St * from_speeds)
    use = derived & np.isnan(sigma)
    return (
        np.where(derived, ratio, e),
        np.where(use, from_speeds, sigma),
        np.where(use & np.isnan(correlation), rho, correlation),
    )


def _check_restitution(e: np.ndarray, none: np.ndarray, unphysical: bool, file: str, rows: np.ndarray) -> None:
    missing = np.isnan(e) & ~none
    if missing.any():
        rule = "is empty: give it, or both speeds, or an outcome of no_rebound (a limit, not a zero)"
        raise InputError(Defect(rule, file, int(rows[int(np.argmax(missing))]), "e_eff"))
    wrong = np.flatnonzero((e < 0) | (e > 1))
    if len(wrong) and not unphysical:
        rule = (
            "lies outside 0 to 1: a rebound faster than the impact, or towards the wall; if errors of measurement "
            "explain it, --allow-unphysical fits it as it is (dropping it would bias the fit)"
        )
        raise InputError(*(Defect(rule, file, int(rows[i]), "e_eff", f"{e[i]:g}") for i in wrong))


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
