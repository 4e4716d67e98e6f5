"""What all resistance laws share: how the drag on a sphere grows as it nears a wall or another sphere.

The laws give a dimensionless resistance of eps = gap/r, in units of what an unbounded sphere feels. ``scale``
says of what:

    "force"            F = 6 pi mu r v      * value(eps)    against the translation v
    "torque"           T = 8 pi mu r^3 omega * value(eps)   against the rotation omega
    "coupling force"   F = 6 pi mu r^2 omega * value(eps)   from the rotation omega
    "coupling torque"  T = 8 pi mu r^2 v    * value(eps)    from the translation v

The couplings are positive in the sense of rolling: translation along a wall turns the sphere as if it rolled,
and the rotation of rolling pushes it onwards. By reciprocity the coupling force is 4/3 of the coupling torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from restitution.laws.base import Law

Scale = Literal["force", "torque", "coupling force", "coupling torque"]


@dataclass(frozen=True)
class ResistanceLaw(Law):
    """A dimensionless resistance as a function of eps = gap/radius, vectorised over eps."""

    family: ClassVar[str] = "resistance"
    symbol: ClassVar[str] = r"\lambda"
    variables: ClassVar[tuple[str, ...]] = ("eps",)
    scale: ClassVar[Scale] = "force"
    motion: ClassVar[str] = "normal to a wall"
    """Which motion against which boundary the law is for."""
