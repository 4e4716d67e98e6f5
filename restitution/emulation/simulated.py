"""Whether runs are of the fluid and the sphere of the record that they are held against.

A run of this package says what it was of in its ``run.json``, beside its trajectory. What the runs vary is theirs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from restitution.conditions import Conditions
from restitution.doubts import Doubt
from restitution.emulation.runs_table import Run
from restitution.errors import InputError
from restitution.inputs import read_json
from restitution.runs.record import FILE

QUANTITIES = {
    "fluid.density": "kg/m3",
    "fluid.viscosity": "Pa s",
    "sphere.diameter": "m",
    "sphere.density": "kg/m3",
    "gravity": "m/s2",
}
_ALIKE = 0.02
"""Relative difference up to which two measured values of one fluid or sphere are the same."""


def of_simulated(
    runs: Sequence[Run], varied: Sequence[str], record: str, conditions: Conditions
) -> Iterator[Doubt]:
    """A doubt where runs are of another fluid or sphere than ``record``; ``varied`` are their parameters."""
    other: dict[str, str] = {}
    count = 0
    for run in runs:
        said = _said(run)
        apart = {}
        for name in (n for n in QUANTITIES if n not in varied):
            theirs, wanted = _at(said, name), _at(conditions.model_dump(), name)
            if isinstance(theirs, int | float) and abs(theirs - wanted) > _ALIKE * abs(wanted):
                apart[name] = f"{name} {theirs:.4g} {QUANTITIES[name]} where the record has {wanted:.4g}"
        other = apart | other
        count += bool(apart)
    if other:
        rule = (
            f"{count} of {len(runs)} runs are of another experiment: {', '.join(other.values())}. Their distance "
            "from this record is no error of the solver: name the record that they simulate"
        )
        yield Doubt("another experiment", rule, record)


def _said(run: Run) -> Any:
    """The case of a run of this package; nothing for another's."""
    try:
        return read_json(run.track.parent / FILE).get("case_as_run")
    except (InputError, AttributeError):
        return None


def _at(tables: Any, name: str) -> Any:
    for part in name.split("."):
        tables = tables.get(part) if isinstance(tables, dict) else None
    return tables
