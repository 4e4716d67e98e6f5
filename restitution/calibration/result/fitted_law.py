"""A model of e_eff at values of its parameters, as the bouncing sphere asks for a rebound law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from restitution.calibration.estimation.rebound_model import ReboundModel
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.stokes import Speed, StokesNumber


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """A law of the registry or a formula of the user's own; ``values`` by name, for the film of ``edge``, in d."""

    model: ReboundModel
    values: Mapping[str, float]
    edge: float | None = None

    @property
    def name(self) -> str:
        return self.model.name

    @property
    def speed(self) -> Speed:
        return self.model.speed

    def __call__(
        self, St: StokesNumber, e_dry: float, conditions: Conditions, out_of_range: str = "ignore"
    ) -> float:
        """e_eff, held within 0 and 1; raises :class:`InputError` where the law has no finite value."""
        own = np.atleast_1d(np.asarray(St.to(self.model.convention, conditions).value, float))
        e = float(self.model(own, e_dry, self.values)[0][0])
        if not math.isfinite(e):
            at = ", ".join(f"{name} = {value:g}" for name, value in self.values.items())
            raise InputError(Defect(f"the law has no finite value here ({at})", field="St", value=f"{own[0]:g}"))
        return min(max(e, 0.0), 1.0)
