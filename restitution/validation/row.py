"""What a row of the scorecard is: one quantity, its references, why it may differ by so much, and what it costs.

A row is a record, as a law is: :attr:`Row.measure` gives values by label from :attr:`Row.case`, its arguments,
and each :class:`Reference` says what a value is held against. The truth has three kinds of tolerance:

- the error of the reference itself (of a measurement, of a printed table), and of a grid of that size where the
  row says so; never what makes the row pass,
- *at most*, for what should be zero,
- *at least*, for an order of convergence or a speed.

A label in :attr:`Row.known` is known to miss the truth, and the row says why: it is shown as a miss, and fails
only where it moves from the baseline (:mod:`restitution.validation.verdict`).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Literal

Side = Literal["both", "at most", "at least"]
Values = Mapping[str, float]
_DIGITS = 12


class Kind(StrEnum):
    """What a reference is."""

    ANALYTICAL = "analytical"
    PUBLISHED = "published computation"
    MEASURED = "measured"
    REGRESSION = "regression"


class Depth(StrEnum):
    """From which depth on a row is run."""

    QUICK = "quick"
    DEFAULT = "default"
    FULL = "full"

    @property
    def includes(self) -> tuple[Depth, ...]:
        """The depths whose rows are run at this one."""
        every = tuple(Depth)
        return every[: every.index(self) + 1]


class NotEvaluatedError(Exception):
    """A row has no values here; the message says why, in one line."""


@dataclass(frozen=True)
class Reference:
    """What one value of a row is held against: ``value`` +- ``tolerance``, in the unit of the row.

    ``side`` "at most": any value up to ``value`` passes, in magnitude; "at least": any from there on.
    """

    label: str
    value: float
    tolerance: float = 0.0
    side: Side = "both"

    def holds(self, found: float) -> bool:
        """Whether a value agrees with the truth; NaN does not."""
        if self.side == "at most":
            return abs(found) <= self.value + self.tolerance
        if self.side == "at least":
            return found >= self.value - self.tolerance
        return abs(found - self.value) <= self.tolerance


def near(label: str, value: float, *, relative: float = 0.0, absolute: float = 0.0) -> Reference:
    """A reference with a relative or an absolute error."""
    return Reference(label, value, relative * abs(value) + absolute)


def at_most(label: str, bound: float) -> Reference:
    """A bound of what should be zero."""
    return Reference(label, bound, side="at most")


def at_least(label: str, bound: float) -> Reference:
    """What a value must reach."""
    return Reference(label, bound, side="at least")


@dataclass(frozen=True)
class Row:
    """One row.

    Parameters
    ----------
    name : on the command line, such as "shear-wave".
    quantity, unit : what is measured; unit "1" for a pure number.
    kind, source : what the references are and where they come from.
    references : what each value is held against; a function where a data set has to be read for it.
    tolerance : why the values may differ by so much.
    depth : from which depth on it is run.
    measure : called with ``case``, gives values by label; raises :class:`NotEvaluatedError` where it cannot.
    case : the arguments of ``measure``, on which the key of the row depends.
    known : by label, why a value is known to miss the truth.
    beside : what decides the values besides the arguments, as the content of a case that they name.
    """

    name: str
    quantity: str
    kind: Kind
    source: str
    references: tuple[Reference, ...] | Callable[[], tuple[Reference, ...]]
    tolerance: str
    measure: Callable[..., Values]
    case: Mapping[str, Any] = field(default_factory=dict)
    depth: Depth = Depth.QUICK
    unit: str = "1"
    known: Mapping[str, str] = field(default_factory=dict)
    beside: Any = None

    def truth(self) -> tuple[Reference, ...]:
        """The references."""
        return self.references() if callable(self.references) else self.references

    @property
    def key(self) -> str:
        """Hash of what is measured: the function by its name, and its arguments. A baseline is known by it."""
        function = getattr(self.measure, "__qualname__", type(self.measure).__qualname__)
        content = [f"{self.measure.__module__}.{function}", self.case, self.beside]
        text = json.dumps(content, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]

    def values(self) -> dict[str, float]:
        """What is measured, by label; every label of a reference has a value."""
        found = {label: float(value) for label, value in self.measure(**self.case).items()}
        missing = [r.label for r in self.truth() if r.label not in found]
        if missing:
            raise NotEvaluatedError(f"gave no value for {', '.join(missing)}")
        return found
