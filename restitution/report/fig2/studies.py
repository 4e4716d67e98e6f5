"""Groups of cases that differ in one choice, as their files state it (:class:`restitution.cases.case.Study`)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from restitution.cases.case import Case


@dataclass(frozen=True)
class Group:
    """What is varied, in words, and the cases; changes are from the first, which the others are against."""

    varies: str
    cases: tuple[Case, ...]

    @property
    def against(self) -> Case:
        """The case that the others are compared with."""
        return self.cases[0]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the cases."""
        return tuple(case.name for case in self.cases)

    @property
    def of_grids(self) -> bool:
        """Whether the cases differ in cells a diameter."""
        return len({case.numerics.cells_per_diameter for case in self.cases}) > 1


def groups(cases: Mapping[str, Case], record: str) -> list[Group]:
    """All groups whose first case is of the ``record``, in their order; the others as they stand in ``cases``."""
    members: dict[tuple[str, str], list[Case]] = {}
    for case in cases.values():
        if case.study is not None and case.study.against in cases and cases[case.study.against].record == record:
            members.setdefault((case.study.varies, case.study.against), []).append(case)
    found = [Group(varies, (cases[against], *others)) for (varies, against), others in members.items()]
    return sorted(found, key=_order)


def _order(group: Group) -> float:
    return min(case.study.order or math.inf for case in group.cases[1:])
