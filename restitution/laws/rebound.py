"""How e_eff is defined: rebound speed over impact speed under liquid, as a law of the Stokes number.

    e_eff = v_out / v_in,   0 <= e_eff <= e_dry,   e_eff -> e_dry as St -> infinity,

v_in and v_out being the normal speeds of the sphere before and after the impact by one and the same
definition (:class:`restitution.stokes.Speed`), those of the motion outside the film for one edge of it: the same
frames want K of Eq. (4) to be 8.9 for an edge of 0.05 d and 14.8 for 0.3 d (``python -m benchmarks.film_edges``).
This module is what all rebound laws share; the laws themselves stand in the modules beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from restitution.conditions import Conditions
from restitution.errors import ConventionError
from restitution.laws.base import Law, OutOfRange
from restitution.stokes import Speed, StokesNumber, convention


@dataclass(frozen=True)
class ReboundLaw(Law):
    """e_eff(St, e_dry). St is a :class:`StokesNumber`, converted to the law's own convention or refused."""

    family: ClassVar[str] = "rebound"
    symbol: ClassVar[str] = r"e_{\mathrm{eff}}"
    variables: ClassVar[tuple[str, ...]] = ("St", "e_dry")
    upper: ClassVar[dict[str, float]] = {"e_dry": 1.0}
    convention: ClassVar[str] = "st"
    speed: ClassVar[Speed] = Speed.UNSTATED
    """The impact speed its source means; ``unstated`` takes any."""
    edge: ClassVar[float | None] = None
    """Edge of the film, in diameters, that its constants belong to; None: unstated, and taken at any edge."""

    def __call__(
        self,
        St: StokesNumber,
        e_dry: Any,
        conditions: Conditions | None = None,
        out_of_range: OutOfRange = "warn",
    ) -> Any:
        """e_eff, dimensionless, of the broadcast shape of ``St.value`` and ``e_dry``.

        ``conditions`` are needed only where the conversion of conventions needs them. Raises
        :class:`ConventionError` for a bare number or for another impact speed than the law's.
        """
        return super().__call__(self._own(St, conditions).value, e_dry, out_of_range=out_of_range)

    def derivative(
        self,
        St: StokesNumber,
        e_dry: Any,
        conditions: Conditions | None = None,
        out_of_range: OutOfRange = "warn",
    ) -> Any:
        """d e_eff / d St with respect to ``St`` in the convention in which it was given."""
        own = self._own(St, conditions)
        chain = own.value / St.value
        return super().derivative(own.value, e_dry, out_of_range=out_of_range) * chain

    def _latex_name(self, symbol: str) -> str:
        return convention(self.convention).symbol if symbol == "St" else super()._latex_name(symbol)

    def _own(self, St: StokesNumber, conditions: Conditions | None) -> StokesNumber:
        if not isinstance(St, StokesNumber):
            raise ConventionError(
                f"{self.name} was given a bare number {St!r} as Stokes number; "
                f"say which one it is: StokesNumber({St!r}, {self.convention!r})"
            )
        if self.speed not in (Speed.UNSTATED, St.speed):
            raise ConventionError(
                f"{self.name} is meant for the {self.speed} impact speed, the Stokes number was made with the "
                f"{St.speed} speed; these cannot be converted. St.read_as({self.speed.value!r}) ignores that"
            )
        return St.to(self.convention, conditions)
