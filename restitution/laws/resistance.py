"""What all resistance laws share: how the drag on a sphere grows as it nears a wall or another sphere.

The laws give a dimensionless resistance of eps = gap / r, the multiple of the unbounded Stokes value:

    F = -6 pi mu r v * value(eps)            (``scale = "force"``)
    T = -8 pi mu r^3 omega * value(eps)      (``scale = "torque"``)

The couplings between translation and rotation state their own scale.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import Law


@dataclass(frozen=True)
class ResistanceLaw(Law):
    """A dimensionless resistance as a function of eps = gap/radius, vectorised over eps."""

    family: ClassVar[str] = "resistance"
    symbol: ClassVar[str] = r"\lambda"
    variables: ClassVar[tuple[str, ...]] = ("eps",)
    scale: ClassVar[str] = "force"
    motion: ClassVar[str] = "normal to a wall"
    """Which motion against which boundary the law is for."""
