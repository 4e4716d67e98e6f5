"""A fit that was kept, as the prior of the next one."""

from __future__ import annotations

import numpy as np

from restitution.calibration.estimation.parameters import Earlier
from restitution.calibration.result.fit_result import FitResult
from restitution.errors import Defect, InputError
from restitution.stokes import Speed


def earlier_of(result: FitResult, origin: str) -> Earlier:
    """A fit as the prior of another; raises :class:`InputError` where its errors are not known."""
    own = [k for k, p in enumerate(result.parameters) if p.mean]
    C = np.array(
        [[np.nan if result.covariance[i][j] is None else result.covariance[i][j] for j in own] for i in own]
    )
    if not own or not np.isfinite(C).all() or (np.diag(C) <= 0).any():
        raise InputError(Defect("has no parameters of a law with known errors", file=origin, field="--prior"))
    return Earlier(
        origin=origin,
        law=result.law.text,
        names=tuple(result.parameters[k].name for k in own),
        mean=np.array([result.parameters[k].value for k in own]),
        covariance=C,
        convention=result.stokes_convention,
        speed=result.speed_definition,
        edge=result.edge_d if result.speed_definition == Speed.FAR else None,
        files=dict(result.files),
        impacts=np.array([(p.stokes, p.e_eff) for p in result.points if p.e_eff is not None]).reshape(-1, 2),
    )
