"""Two verdicts a row: against the truth, and against the baseline; and what both say of a whole scorecard.

==============  ===========================================================================================
truth
==============  ===========================================================================================
pass            every value agrees with its reference
known miss      a value does not, and the row says why that is known; the baseline must hold it
fail            a value does not agree
not evaluated   there is no value: never a pass
==============  ===========================================================================================

==============  ===========================================================================================
baseline
==============  ===========================================================================================
pass            every value is the baseline's, within at least five times the spread that was measured; what should
                be zero keeps its bound
fail            a value has moved, towards the truth or away from it: ``--bless`` takes it where that is meant
not evaluated   there is no value, no baseline, or one of another case
==============  ===========================================================================================

A gate has to catch a change of what is already known to miss, and must not stop every change because of it. So a
known miss alone fails nothing; one that moves does, and without a baseline it is not known whether it did.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from restitution.validation.row import Reference, Row


class Verdict(StrEnum):
    """What is said of a row; see the head of this module."""

    PASS = "pass"
    KNOWN_MISS = "known miss"
    FAIL = "fail"
    NOT_EVALUATED = "not evaluated"


_WORST_LAST = (Verdict.PASS, Verdict.KNOWN_MISS, Verdict.NOT_EVALUATED, Verdict.FAIL)

NIL = 0.01
"""Of its bound, below which a value is one that should be zero, and no magnitude."""
_READ_TO = 1e-6
ALL_PASS, FAILED, BAD_INPUT, NOT_EVALUATED = 0, 1, 2, 3
"""Exit statuses; 2 is that of any input that cannot be used."""


@dataclass(frozen=True)
class Held:
    """What a baseline has of a value: ``value`` and how far another may be from it, absolutely."""

    value: float
    tolerance: float


def worst(verdicts: Iterable[Verdict]) -> Verdict:
    """The worst of some verdicts; of none, nothing was evaluated."""
    return max(verdicts, key=_WORST_LAST.index, default=Verdict.NOT_EVALUATED)


def against_truth(row: Row, values: Mapping[str, float] | None) -> dict[str, Verdict]:
    """The verdict of each reference of a row, by label."""
    found = {}
    for reference in row.truth():
        if values is None or reference.label not in values:
            found[reference.label] = Verdict.NOT_EVALUATED
        elif reference.holds(values[reference.label]):
            found[reference.label] = Verdict.PASS
        else:
            found[reference.label] = Verdict.KNOWN_MISS if reference.label in row.known else Verdict.FAIL
    return found


def against_baseline(
    row: Row, values: Mapping[str, float] | None, held: Mapping[str, Held] | None
) -> dict[str, Verdict]:
    """The verdict of each reference against what the baseline has, by label.

    What should be zero is held by its bound, unless it is known to miss it; but only where the baseline has the
    row: without one nothing is known of what was. A magnitude with a bound is held by that and by what it was.
    """
    found = {}
    for reference in row.truth():
        label = reference.label
        if held is None or values is None or label not in values:
            found[label] = Verdict.NOT_EVALUATED
        elif reference.side != "both" and label not in row.known:
            within = reference.holds(values[label]) and not (
                label in held and _magnitude(reference, held[label].value) and _moved(reference, values, held)
            )
            found[label] = Verdict.PASS if within else Verdict.FAIL
        elif label not in held:
            found[label] = Verdict.NOT_EVALUATED
        else:
            found[label] = Verdict.FAIL if _moved(reference, values, held) else Verdict.PASS
    return found


def _magnitude(reference: Reference, value: float) -> bool:
    """Whether a value with a bound is more than the rounding and small errors of what should be zero."""
    return abs(value) >= NIL * abs(reference.value)


def _moved(reference: Reference, values: Mapping[str, float], held: Mapping[str, Held]) -> bool:
    """Whether a value is not what it was; of one with a bound, a millionth of that is no change."""
    was = held[reference.label]
    room = was.tolerance if reference.side == "both" else max(was.tolerance, _READ_TO * abs(reference.value))
    return not abs(values[reference.label] - was.value) <= room


def status(verdicts: Iterable[tuple[Verdict, Verdict]], strict: bool = False) -> int:
    """The exit status of rows with their verdicts (truth, baseline); ``strict``: a known miss fails too."""
    every = [v for pair in verdicts for v in pair]
    if Verdict.FAIL in every or (strict and Verdict.KNOWN_MISS in every):
        return FAILED
    return NOT_EVALUATED if not every or Verdict.NOT_EVALUATED in every else ALL_PASS


def over_tolerance(difference: float, tolerance: float) -> float:
    """A difference in units of its tolerance; infinite where none is allowed and there is one."""
    if tolerance > 0:
        return difference / tolerance
    return 0.0 if difference == 0 else math.copysign(math.inf, difference)
