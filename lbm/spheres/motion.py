"""What every motion of a sphere along the normal of a wall has: a state of its own, and one step at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from lbm.spheres.contact import Impact


class Motion(ABC):
    """One sphere at one wall; lengths in cells, times in steps, velocities positive away from the wall.

    What it carries from step to step are the attributes named in ``remembered``, all of them numbers, NaN where
    there is nothing to remember.
    """

    remembered: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def matters(self, gap: float, v: float) -> bool:
        """Whether the wall may act within the next step."""

    @abstractmethod
    def step(
        self, time: float, gap: float, v: float, fluid: float, weight: float, mass: float
    ) -> tuple[float, float, list[Impact]]:
        """Gap, velocity and impacts one step later.

        ``fluid`` is the fluid's force on the sphere of ``mass``, ``weight`` its weight less buoyancy.
        """

    def numbers(self) -> list[float]:
        """The state, for a checkpoint."""
        return [float(getattr(self, name)) for name in self.remembered]

    def remember(self, numbers: list[float]) -> None:
        """Continue from :meth:`numbers`."""
        for name, value in zip(self.remembered, numbers, strict=True):
            setattr(self, name, float(value))
