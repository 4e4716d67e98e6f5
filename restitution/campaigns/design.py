"""What a sweep varies: a TOML file of a base case, a design and the keys varied, and the cases that follow.

===================  ====================================================================================
design               runs
===================  ====================================================================================
``grid``             every combination of the values of ``[vary]``
``list``             one a ``[[runs]]``, whose keys are laid over the base as those of a case file are
``latin hypercube``  ``runs`` points in the ranges of ``[vary]``, one in each of so many layers of each
``sobol``            the same, ``runs`` a power of two, of low discrepancy (scrambled by Owen)
===================  ====================================================================================

Points of the last two are those of :mod:`scipy.stats.qmc` for the stated ``seed``. Every key of a case can be
varied, by its dotted name; ``St`` too, rho_p v d/(9 mu) at the speed v of the drive, through viscosity or speed.
Of several bases each has all points, such as cases of several records for a solver's calibration.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from restitution.cases.case import Case
from restitution.cases.reading import case_of, content_of, find, nested, over
from restitution.conditions import Record, defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import read_toml
from restitution.runs.record import RESOLVED
from restitution.stokes import convention

MOST_RUNS = 10**6
STOKES = "St"
TEMPLATE = Path(__file__).parent / "template.toml"
"""An example with every key explained."""

Value = float | int | str | bool | list | dict


class Range(Record):
    """From one end to the other, both included in a grid of ``count`` values, evenly in x or in log x.

    ``from`` and ``to`` are numbers in the unit of the key, or texts with a unit.
    """

    begin: float | str = Field(alias="from")
    end: float | str = Field(alias="to")
    count: Annotated[int, Field(ge=2, le=MOST_RUNS)] | None = None
    scale: Literal["linear", "log"] = "linear"


class SweepFile(Record):
    """The content of a sweep's file."""

    base: str | Annotated[tuple[str, ...], Field(min_length=1)]
    design: Literal["grid", "list", "latin hypercube", "sobol"] = "grid"
    models: tuple[Literal["resolved", "point particle"], ...] = (RESOLVED,)
    case: dict[str, Any] = Field(default_factory=dict)
    vary: dict[str, Any] = Field(default_factory=dict)
    runs: Annotated[int, Field(ge=1, le=MOST_RUNS)] | tuple[dict[str, Any], ...] | None = None
    seed: Annotated[int, Field(ge=0, le=2**32)] = 1
    st_through: Literal["fluid.viscosity", "release.speed"] = "fluid.viscosity"

    @model_validator(mode="after")
    def _of_one_design(self) -> SweepFile:
        """Each design has its own keys."""
        if not self.models:
            raise ValueError("names no model: 'resolved', 'point particle' or both")
        if self.design == "list":
            if self.vary or not isinstance(self.runs, tuple) or not self.runs:
                raise ValueError("the design 'list' takes [[runs]], each with its own keys, and no [vary]")
            return self
        if not self.vary:
            raise ValueError(f"the design {self.design!r} takes [vary] with the keys to vary")
        if self.design == "grid" and self.runs is not None:
            raise ValueError("the design 'grid' has as many runs as its values combine to: leave runs out")
        if self.design != "grid" and not isinstance(self.runs, int):
            raise ValueError(f"the design {self.design!r} needs runs, the number of its points")
        if self.design == "sobol" and self.runs & (self.runs - 1):
            raise ValueError("points of Sobol are balanced where runs is a power of two: 8, 16, 32, ...")
        return self


@dataclass(frozen=True)
class Varied:
    """One run to be: a case, the model of it, and the values of the keys that the sweep varies, in SI."""

    case: Case
    model: str
    parameters: dict[str, Any]


class Sweep:
    """A sweep's file with its base case, or several; :meth:`cases` are the runs that it asks for."""

    def __init__(self, path: str | Path):
        self.path, self.file = Path(path), str(path)
        try:
            self.asked = SweepFile.model_validate(read_toml(path))
        except ValidationError as error:
            raise InputError(*defects_of(error, self.file)) from None
        bases = (self.asked.base,) if isinstance(self.asked.base, str) else self.asked.base
        self.contents = {name: self._content(name) for name in bases}
        self.varied = _ways(self.asked.vary, self.file)
        """What is given to each key that varies, by its dotted name."""
        twice = sorted(set(_leaves(self.asked.case)) & set(self.varied))
        rule = "stands in [case] and in [vary]: every run has the value of one of them; leave the other out"
        if twice:
            raise InputError(*(Defect(rule, file=self.file, field=name) for name in twice))

    def _content(self, name: str) -> dict[str, Any]:
        """A base with what all runs have in place of its own."""
        beside = self.path.parent / f"{name.removesuffix('.toml')}.toml"
        base = beside if beside.is_file() and beside.resolve() != self.path.resolve() else name
        try:
            content = content_of(find(base))
        except InputError as error:
            if error.defects[0].file != str(base):
                raise
            raise InputError(Defect(error.defects[0].rule, file=self.file, field="base", value=name)) from None
        content = over(content, self.asked.case)
        case_of(content, self.file, runnable=False)
        return content

    @property
    def columns(self) -> list[str]:
        """The dotted keys that vary, in the order of the file; those of St are it and what it goes through."""
        given = self.asked.runs if self.asked.design == "list" else [nested(change) for change in self._examples()]
        names = list(dict.fromkeys(name for change in given for name in _leaves(change)))
        return [*names, self.asked.st_through] if STOKES in names else names

    def cases(self) -> Iterator[Varied]:
        """The runs; raises :class:`InputError` with every cause for which one cannot be made."""
        defects: dict[str, Defect] = {}
        columns, found = self.columns, []
        for (base, content), change in itertools.product(self.contents.items(), self._changes()):
            try:
                case = self._changed(content, change)
            except InputError as error:
                defects |= {str(d): d for d in error.defects}
                continue
            parameters = {name: change[STOKES] if name == STOKES else value_of(case, name) for name in columns}
            named = {"base": base} if self._named_apart else {}
            found += [Varied(case, model, named | parameters) for model in self.asked.models]
        if defects:
            raise InputError(*defects.values())
        return iter(found)

    @property
    def _named_apart(self) -> bool:
        """Whether several bases are told apart by nothing else: by no record of their own."""
        records = {content.get("record") for content in self.contents.values()}
        return len(records) < len(self.contents)

    def _changed(self, content: dict[str, Any], change: Mapping[str, Any]) -> Case:
        """A base with dotted keys changed."""
        plain = {name: value for name, value in change.items() if name != STOKES}
        content = over(content, nested(plain))
        if STOKES not in change:
            return case_of(content, self.file)
        case = case_of(content, self.file, runnable=False)
        return case_of(over(content, nested(self._for_stokes(case, change[STOKES]))), self.file)

    def _for_stokes(self, case: Case, stokes: float) -> dict[str, float]:
        """What gives the Stokes number at the speed of the drive."""
        wanted = self.asked.st_through
        if case.release.speed is None and wanted == "fluid.viscosity":
            rule = "is that of the speed of the drive, and the sphere is released from rest: vary fluid.viscosity"
            raise InputError(Defect(rule, file=self.file, field=STOKES))
        if not isinstance(stokes, int | float) or not 0 < stokes < math.inf:
            raise InputError(Defect("must be a positive number", file=self.file, field=STOKES, value=str(stokes)))
        per_speed = convention("st").per_speed(case.conditions)
        if wanted == "release.speed":
            return {wanted: stokes / per_speed}
        return {wanted: case.fluid.viscosity * per_speed * case.release.speed / stokes}

    def _changes(self) -> Iterator[dict[str, Any]]:
        """Dotted keys and their values, a run each."""
        asked = self.asked
        if asked.design == "list":
            yield from (_leaves(run) for run in asked.runs)
        elif asked.design == "grid":
            values = [self._values(name, given) for name, given in self.varied.items()]
            count = math.prod(map(len, values))
            if count > MOST_RUNS:
                rule = f"combine to {count} runs; at most {MOST_RUNS} are planned"
                raise InputError(Defect(rule, file=self.file, field="vary"))
            yield from (dict(zip(self.varied, point, strict=True)) for point in itertools.product(*values))
        else:
            yield from self._sampled()

    def _sampled(self) -> Iterator[dict[str, Any]]:
        from scipy.stats import qmc

        ends = {name: self._ends(name, given) for name, given in self.varied.items()}
        kind = qmc.LatinHypercube if self.asked.design == "latin hypercube" else qmc.Sobol
        points = kind(len(ends), rng=self.asked.seed).random(self.asked.runs)
        for point in points:
            yield {
                name: _between(*ends[name], self.varied[name].scale, float(share))
                for name, share in zip(ends, point, strict=True)
            }

    def _values(self, name: str, given: list | Range) -> list:
        """What a key takes in a grid."""
        if isinstance(given, list):
            return given
        if given.count is None:
            raise InputError(Defect("needs count in a grid", file=self.file, field=f"vary.{name}"))
        ends, last = self._ends(name, given), given.count - 1
        return [_between(*ends, given.scale, i / last) for i in range(given.count)]

    def _ends(self, name: str, given: list | Range) -> tuple[float, float]:
        """Both ends of a range in SI, as the case itself reads them."""
        field = f"vary.{name}"
        if not isinstance(given, Range):
            rule = f"must be a range, as in {{ from = 1, to = 2 }}, in the design {self.asked.design!r}"
            raise InputError(Defect(rule, file=self.file, field=field))
        if self.asked.design != "grid" and given.count is not None:
            rule = f"is for a grid; the design {self.asked.design!r} has runs"
            raise InputError(Defect(rule, file=self.file, field=f"{field}.count"))
        found = [self._in_si(name, end) for end in (given.begin, given.end)]
        for text, value in zip((given.begin, given.end), found, strict=True):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or (given.scale == "log" and value <= 0):
                rule = "must be a number" if not number else "must be positive on a logarithmic scale"
                raise InputError(Defect(rule, file=self.file, field=field, value=str(text)))
        if found[0] == found[1]:
            raise InputError(Defect("begins where it ends: write one value", file=self.file, field=field))
        return found[0], found[1]

    def _in_si(self, name: str, value: float | str) -> Any:
        if name == STOKES:
            return value
        content = next(iter(self.contents.values()))
        return value_of(case_of(over(content, nested({name: value})), self.file, runnable=False), name)

    def _examples(self) -> Iterator[dict[str, Any]]:
        """For each key that varies what it may be, for the names of the columns."""
        for name, given in self.varied.items():
            yield from ({name: value} for value in given) if isinstance(given, list) else ({name: 0.0},)


def value_of(case: Case, name: str) -> Any:
    """The value in SI of a case's dotted key; None where it has none."""
    found: Any = case
    for part in name.split("."):
        found = found.get(part) if isinstance(found, dict) else getattr(found, part, None)
    return list(found) if isinstance(found, tuple) else found


def _between(begin: float, end: float, scale: str, share: float) -> float:
    """A point of a range; its ends are met exactly."""
    if share in (0.0, 1.0):
        return end if share else begin
    if scale == "log":
        return float(f"{begin * (end / begin) ** share:.12g}")
    return float(f"{begin + share * (end - begin):.12g}")


def _ways(given: Mapping[str, Any], file: str, within: str = "") -> dict[str, list | Range]:
    """Values or a range by dotted name; ``[vary]`` may write sections as tables."""
    found: dict[str, list | Range] = {}
    for key, value in given.items():
        name = f"{within}.{key}" if within else key
        if isinstance(value, dict) and not {"from", "to"} & set(value):
            found |= _ways(value, file, name)
        elif isinstance(value, dict):
            try:
                found[name] = Range.model_validate(value)
            except ValidationError as error:
                raise InputError(
                    *(replace(d, field=f"vary.{name}.{d.field}") for d in defects_of(error, file))
                ) from None
        elif isinstance(value, list) and value:
            found[name] = value
        else:
            rule = "must be a list of values, or a range as in { from = 1, to = 2 }"
            raise InputError(Defect(rule, file=file, field=f"vary.{name}", value=str(value)))
    return found


def _leaves(tables: Mapping[str, Any], within: str = "") -> dict[str, Any]:
    """Tables as dotted keys."""
    found: dict[str, Any] = {}
    for key, value in tables.items():
        name = f"{within}.{key}" if within else key
        found |= _leaves(value, name) if isinstance(value, dict) else {name: value}
    return found
