"""Whether the data can determine what is asked of them, and whether an estimate can be believed.

What cannot be determined is refused, saying what to do. An estimate is doubted where its parts contradict one
another:

- An interval of 95 % contains that of 68 %, and both contain the estimate.
- The standard error is that of the curvature at the maximum, the interval that of the whole profile; where they
  differ by more than a factor, one of them is wrong or the error means little.
- The curvature, scaled to a unit diagonal, has the ratio of its greatest to its least eigenvalue: beyond some
  ten digits nothing is left of the sixteen that the likelihood is computed with.
- Starts that end in many places leave it likely that others end in a better one.
- Impacts depart from the law by more than what rounding leaves of a sum of squares' curvature.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from restitution.calibration.estimation.likelihood import SCATTER, Likelihood
from restitution.calibration.estimation.maximum import LEVELS, Maximum
from restitution.calibration.estimation.parameters import Normal
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError

APART = 2.0
"""Factor between standard error and half the interval of 68 % from which on they contradict each other."""
_FAR_OFF = 0.05
"""Standard errors from the maximum that are too many."""
CONDITION = 1e10
"""Ratio of eigenvalues from which on errors and intervals are not believed."""

ROUNDING = float(np.sqrt(np.finfo(float).eps))
"""Error of e below which the misfit of the law is rounding."""
EXACT = 1e-11
"""Misfit of e below which the least scatter that a likelihood can have, 1e-12, hides it."""
_GIVE_ERRORS = "fill the column e_eff_sigma, or give one error to all that have none, as in --e-sigma 0.01"


class ExactImpactsError(InputError):
    """Impacts without errors that follow a law to the last digits: no fit and no ranking can come from them."""


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
        n = int((measured.e_sigma <= 0).sum())
        rule = (
            f"{n} of {len(measured)} impacts state no error of e_eff, and no scatter is estimated (--no-scatter): "
            f"{_GIVE_ERRORS}, or leave --no-scatter out"
        )
        raise InputError(Defect(rule, file=file, field="e_eff_sigma"))


def check_exact(likelihood: Likelihood, values: NDArray) -> None:
    """Refuse impacts without errors that a law meets to the last digits: ``values`` are those of least squares."""
    o = likelihood.observations
    measured = o.take(~o.censored)
    if SCATTER not in [p.name for p in likelihood.parameters] or np.max(measured.e_sigma) > 0:
        return
    misfit = float(np.max(np.abs(o.e - likelihood.moments(values)[0])[~o.censored]))
    if misfit < EXACT:
        law = likelihood.model.name if likelihood.model.name.isidentifier() else "the law"
        rule = (
            f"the impacts state no error of e_eff and follow {law} to {max(misfit, 1e-16):.0e}, "
            "as computed ones do and no measured ones, so that nothing tells how sure its parameters are: "
            f"{_GIVE_ERRORS}"
        )
        raise ExactImpactsError(Defect(rule, file=next(iter(o.files), None), field="e_eff_sigma"))


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


def of_search(likelihood: Likelihood, values: NDArray, tried: int) -> Iterator[Doubt]:
    """Doubts about where the estimate was found; ``tried`` starts that left others likely, or 0."""
    if tried:
        yield Doubt(
            "starts",
            f"{tried} starts ended in many maxima, and others may end in a higher one: narrow the bounds "
            "(--bounds), or give starts (--start)",
        )
    o, names = likelihood.observations, [p.name for p in likelihood.parameters]
    if SCATTER in names:
        error = np.hypot(o.e_sigma[~o.censored], values[names.index(SCATTER)])
        if np.max(error) < ROUNDING:
            yield Doubt(
                "scatter",
                f"the impacts follow the law to {np.max(error):.1e}, as computed ones do and no measured ones: "
                "rounding decides on parameters, errors and intervals; add e_eff_sigma",
            )


def of_estimate(best: Maximum, freedom: NDArray) -> Iterator[Doubt]:
    """Doubts about an estimate with intervals; ``freedom`` are the degrees of freedom of each parameter's t."""
    if best.condition is not None and best.condition > CONDITION:
        yield Doubt(
            "curvature",
            f"the parameters are nearly exchangeable (condition {best.condition:.1e} of the curvature): errors "
            "and intervals may be wrong; fix one, or give it a prior",
        )
    if best.unsettled > _FAR_OFF:
        yield Doubt(
            "maximum",
            f"the search stopped some {best.unsettled:.2g} standard errors from the maximum: rounding hides "
            "the rest of the way; fix a parameter, or give one a prior",
        )
    for j, p in enumerate(best.parameters):
        if not p.mean:
            continue
        narrow, wide = (best.intervals.get(level, np.full((j + 1, 2), np.nan))[j] for level in LEVELS)
        if np.isnan([*narrow, *wide]).any():
            continue
        slack = 1e-6 * (wide[1] - wide[0] + abs(best.values[j]) * 1e-9)
        if (
            wide[0] > narrow[0] + slack
            or wide[1] < narrow[1] - slack
            or not narrow[0] <= best.values[j] <= narrow[1]
        ):
            yield Doubt(
                "intervals",
                f"{p.name}: the intervals {narrow[0]:.6g} to {narrow[1]:.6g} (68 %) and {wide[0]:.6g} to "
                f"{wide[1]:.6g} (95 %) do not lie within one another about {best.values[j]:.6g}: the search for "
                "their ends failed; fix a parameter, narrow bounds, or take --posterior",
            )
        elif not best.open_ends[LEVELS[0]][j].any():
            half, nu = 0.5 * (narrow[1] - narrow[0]), freedom[j]
            t = stdtrit(nu if np.isfinite(nu) else 1e9, 0.5 * (1 + LEVELS[0]))
            ratio = half / best.sigma[j]
            # A bent law of few degrees of freedom has an interval between that of the normal and that of its t.
            if not 1 / APART < ratio < APART * t:
                yield Doubt(
                    "sigma",
                    f"{p.name}: its standard error {best.sigma[j]:.3g} by the curvature and half its 68 % "
                    f"interval, {half:.3g}, differ by a factor {ratio:.2g}: take the interval, not the error",
                )
