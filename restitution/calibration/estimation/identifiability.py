"""Whether the data can determine what is asked of them; a refusal says what to do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.likelihood import SCATTER, Likelihood
from restitution.calibration.estimation.maximum import Maximum
from restitution.calibration.estimation.parameters import Normal
from restitution.errors import Defect, InputError


def check_data(likelihood: Likelihood) -> None:
    """Refuse what no estimate can come from, saying what to do."""
    o = likelihood.observations
    measured = o.take(~o.censored)
    mean = [p for p in likelihood.parameters if p.mean]
    free = sum(not likelihood.known_beforehand(p) for p in mean)
    named = ", ".join(p.name for p in mean)
    file = next(iter(o.files), None)
    if not len(o):
        raise InputError(Defect("has no impacts", file=file))
    if not len(measured):
        rule = "no impact has a rebound: limits alone do not determine a law; add impacts with a measured e_eff"
        raise InputError(Defect(rule, file=file))
    needed = free + (SCATTER in [p.name for p in likelihood.parameters])
    if len(measured) < needed:
        rule = f"{len(measured)} measured impacts are fewer than the {needed} parameters ({named}"
        scatter = ", scatter" * (needed > free)
        raise InputError(Defect(f"{rule}{scatter}): add impacts, fix a parameter, or give it a prior", file=file))
    distinct = len(np.unique(measured.St))
    if distinct == 1 and len(measured) > 1:
        rule = "all measured impacts have the same Stokes number, which tells nothing of a law in it: vary St"
        raise InputError(Defect(rule, file=file, field="stokes", value=f"{measured.St[0]:g}"))
    if distinct < free:
        rule = f"{distinct} Stokes numbers cannot determine {free} parameters ({named}): vary St, or fix one"
        raise InputError(Defect(rule, file=file))
    if SCATTER not in [p.name for p in likelihood.parameters] and (measured.e_sigma <= 0).any():
        rule = "some impacts have no error, and no scatter is estimated: give e_eff_sigma, or let the scatter be"
        raise InputError(Defect(rule, file=file))


def check_bounds(best: Maximum) -> None:
    """Refuse an estimate stuck on a bound; e_dry may lie at 1, and a prior may hold a parameter anywhere."""
    for j, p in enumerate(best.parameters):
        side = best.at_bound(j) if p.mean else None
        if side and not p.name.startswith("e_dry") and not isinstance(p.prior, Normal):
            low, high = p.bounds
            rule = (
                f"is stuck on its {side} bound [{low:g}, {high:g}]: the data ask for more than the law allows; "
                f"widen it (--bounds {p.name}=LOW:HIGH), fix it, or fit another law"
            )
            raise InputError(Defect(rule, field=p.name, value=f"{best.values[j]:.4g}"))


def check_flat(likelihood: Likelihood, values: NDArray) -> None:
    """Refuse a likelihood that does not depend on a parameter, or only on a combination of several."""
    parameters = likelihood.parameters
    mean = np.flatnonzero([p.mean for p in parameters])
    J = likelihood.jacobian(values)[:, mean]
    for place, j in enumerate(mean):
        p = parameters[j]
        reach = (p.bounds[1] - p.bounds[0]) if p.scale == "linear" else values[j]
        if not likelihood.known_beforehand(p) and np.max(np.abs(J[:, place])) * reach < 1e-9:
            rule = "the likelihood does not depend on it here: it is flat; fix it, or choose another start or law"
            raise InputError(Defect(rule, field=p.name, value=f"{values[j]:.4g}"))
    size = np.sqrt(np.sum(J**2, axis=0))
    free = [i for i, j in enumerate(mean) if not likelihood.known_beforehand(parameters[j])]
    if len(free) > 1:
        _, singular, directions = np.linalg.svd(J[:, free] / size[free], full_matrices=False)
        if singular[-1] < 1e-5 * singular[0]:
            part = np.abs(directions[-1])
            names = " and ".join(parameters[mean[free[i]]].name for i in np.flatnonzero(part > 0.1))
            rule = "the likelihood is flat along a combination of them: only that is determined; fix one"
            raise InputError(Defect(rule, field=names))
