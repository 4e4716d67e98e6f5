"""What can be wrong with a table of impacts beyond its form: all of it, to be named at once.

The form of the table (columns, types, ranges) is the affair of its schema, ``measurement.json``; here stand the
rules between columns: one definition of St and of the impact speed in a file, St and e_eff given or derived from
speeds, errors positive, e_eff physical.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.reading import Reading
from restitution.doubts import Doubt, of_conditions, of_copies, of_impacts
from restitution.errors import Defect, InputError, of_rows
from restitution.stokes import H_FILM, film_edge

if TYPE_CHECKING:
    import pandas as pd

CONDITIONS = ("fluid_density_kg_m3", "fluid_viscosity_Pa_s", "sphere_diameter_m", "sphere_density_kg_m3")
NO_SPEED = (
    "which impact speed e_eff and St were made with is not stated: --speed far (outside the film), "
    "contact, window, film_edge or unstated, or the column speed_definition"
)
_NO_STOKES = (
    "which Stokes number this is, is not stated: --stokes st (rho_p v d/(9 mu)), st_star, st_d, st_18 or "
    "st_b, or the column stokes_convention"
)
NO_E_DRY = "is not stated: fill the column e_dry, or give --e-dry VALUE, VALUE+-SIGMA or free"
_UNPHYSICAL = (
    "lies outside 0 to 1: a rebound faster than the impact, or towards the wall; if errors of measurement "
    "explain it, --allow-unphysical fits it as it is (dropping it would bias the fit)"
)
_SIGMAS = ("e_eff_sigma", "stokes_sigma", "e_dry_sigma", "impact_speed_sigma_m_s", "rebound_speed_sigma_m_s")


class TableCheck:
    """The rules on one table; ``defects`` gathers what breaks them, no cell twice.

    ``rows`` are the lines of the file; in ``form_defects``, those of the table's form, the named cells are empty.
    """

    def __init__(
        self, table: pd.DataFrame, how: Reading, file: str, rows: Sequence[int], form_defects: Iterable[Defect]
    ):
        self.table, self.how, self.file, self.rows = table, how, file, rows
        self.defects = list(form_defects)
        self._named: dict[str | None, set[int | None]] = {}
        for d in self.defects:
            self._named.setdefault(d.field, set()).update((d.row, *d.others))
        # Where a column is misnamed, its empty cells are no further defects.
        self._complete = not any(d.row == 1 for d in self.defects)

    def _add_all(self, rule: str, where: Iterable[int], name: str, values: Any = None) -> None:
        """The cells of a column at these places, but those that are named already."""
        own = self.how.columns.get(name, name)
        named = self._named.setdefault(own, set())
        new = [(i, row) for i in where if (row := int(self.rows[i])) not in named]
        named.update(row for _, row in new)
        shown = None if values is None else lambda k: _shown(values[new[k][0]])
        self.defects += of_rows(rule, [row for _, row in new], shown, file=self.file, field=own)

    def definition(self, column: str, given: Any, option: str) -> Any:
        """The one value of a column that states a definition, or the caller's; None where nobody states it."""
        stated = self.table[column].dropna()
        if stated.empty:
            return given
        first, at = stated.iloc[0], stated.index[0]
        if given is not None and given != first:
            rule = f"the file states another: {_shown(first)}"
            self.defects.append(
                Defect(rule, file=self.file, row=int(self.rows[at]), field=option, value=str(given))
            )
        other = np.flatnonzero(
            self.table[column].notna().to_numpy(bool) & (self.table[column] != first).to_numpy(bool)
        )
        rule = f"differs from {first!r} in row {self.rows[at]}: one file has one definition; split it"
        self._add_all(rule, other, column, self.table[column])
        empty = np.flatnonzero(self.table[column].isna())
        self._add_all(f"is empty here and {first!r} in other rows: give it in all", empty, column)
        return first

    def speed(self) -> str | None:
        """The definition of the impact speed; that nobody states it is a defect."""
        speed = self.definition("speed_definition", self.how.speed, "--speed")
        if speed is None:
            self.defects.append(Defect(NO_SPEED, file=self.file))
        return speed

    def dry(self) -> None:
        """Where other definitions are missing, that of the dry restitution is asked for with them."""
        asked = {d.rule for d in self.defects} & {NO_SPEED, _NO_STOKES}
        if asked and not self.how.dry and self.table["e_dry"].isna().all():
            self.defects.append(Defect(NO_E_DRY, file=self.file, field="e_dry"))

    def edge(self) -> float:
        """The edge of the film in diameters that the table, or the caller, states; else that of the package."""
        given = None if self.how.edge is None else film_edge(self.how.edge, "--edge")
        stated = self.definition("film_edge_d", given, "--edge")
        return H_FILM if stated is None else float(stated)

    def stokes(self, conditions: Sequence) -> str:
        """The Stokes convention; St must be given under it, or follow from the impact speed and conditions."""
        key = self.definition("stokes_convention", self.how.stokes, "--stokes")
        given = self.table["stokes"].notna().to_numpy(bool)
        if given.any() and key is None:
            self._add_all(_NO_STOKES, [int(np.argmax(given))], "stokes")
        speed = self.table["impact_speed_m_s"].to_numpy(float)
        if self._complete:
            rule = "is not given, nor the impact_speed_m_s and conditions that it would follow from"
            self._add_all(rule, np.flatnonzero(~given & np.isnan(speed)), "stokes")
            without = np.array([c is None for c in conditions], bool)
            rule = (
                f"needs fluid and sphere to become a Stokes number: {', '.join(CONDITIONS)}, or --conditions FILE"
            )
            self._add_all(rule, np.flatnonzero(~given & np.isfinite(speed) & without), "impact_speed_m_s", speed)
        return key or "st"

    def errors(self) -> None:
        """Standard errors are positive."""
        given = self.how.e_sigma
        if given is not None and not 0 < given < np.inf:
            self.defects.append(Defect("must be positive and finite", field="--e-sigma", value=f"{given:g}"))
        for name in _SIGMAS:
            values = self.table[name].to_numpy(float)
            rule = "must be positive; leave the cell empty where it is not known"
            self._add_all(rule, np.flatnonzero((values <= 0) | np.isinf(values)), name, values)

    def restitution(self, e: np.ndarray, none: np.ndarray) -> None:
        """Each impact has an e_eff, or an outcome without one; its value is physical unless that is waived."""
        if self._complete:
            rule = "is empty: give it, or both speeds, or an outcome of no_rebound (a limit, not a zero)"
            self._add_all(rule, np.flatnonzero(np.isnan(e) & ~none), "e_eff")
        seen = self.table["e_eff"].to_numpy(float)
        rule = "is given for an impact without a rebound: leave it empty and give the limit as e_eff_upper"
        self._add_all(rule, np.flatnonzero(none & np.isfinite(seen) & (seen != 0)), "e_eff", seen)
        if not self.how.unphysical:
            self._add_all(_UNPHYSICAL, np.flatnonzero(_outside(e) & ~none), "e_eff", e)


def check_physical(o: Observations, how: Reading) -> Observations:
    """The same impacts of one's own tracks; refuses those whose e_eff is not physical, unless that is waived."""
    outside = np.flatnonzero(_outside(o.e)) if not how.unphysical else ()
    defects = [Defect(_UNPHYSICAL, **o.place(i), field="e_eff", value=f"{o.e[i]:g}") for i in outside]
    if defects:
        raise InputError(*defects)
    return o


def doubts_about(o: Observations, e_dry: float | None = None) -> tuple[Doubt, ...]:
    """What is doubtful about impacts: about their records and conditions, whether some are copies of others, and
    whether the film takes what it takes elsewhere. ``e_dry`` is taken where the impacts do not state it.
    """
    try:
        St = o.St * o.ratio_to("st")
    except InputError:  # fluid and sphere are not known: near enough, but for a factor that all conventions state
        St = o.St
    dry = np.where(np.isfinite(o.e_dry), o.e_dry, _TYPICAL_E_DRY if e_dry is None else e_dry)
    known, files = {doubt.message for doubt in o.doubts}, tuple(o.files)
    stated = [d for d in of_conditions(o.conditions, ", ".join(files)) if d.message not in known]
    copies = of_copies(o.St, o.e, o.e_sigma, o.places, files)
    return (*o.doubts, *stated, *copies, *of_impacts(St, o.e, dry, files))


_TYPICAL_E_DRY = 0.97
"""Of steel and glass, where nobody states it."""


def _shown(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _outside(e: np.ndarray) -> np.ndarray:
    return (e < 0) | (e > 1)
