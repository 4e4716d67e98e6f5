r"""What to measure next: the condition whose impacts would narrow a chosen interval most.

A fit has the covariance C of its parameters. m impacts at one St, of variance s^2 each (error, scatter) and with
the offset omega of one new source, add the information of a single one of variance s_m^2 = s^2/m + omega^2; with
g = df/dtheta there,

    C' = C - C g g^T C / (s_m^2 + g^T C g),

and the standard error of a combination a of the parameters (one of them, or df/dtheta at the St of interest)
becomes sqrt(a^T C' a). It is the expected information of the linearised law: it does not know that the law may be
wrong, nor that more data also tell the scatter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.likelihood import OFFSET, SCATTER
from restitution.calibration.result.fit_result import FitResult
from restitution.calibration.result.prediction import Evaluation, stokes_of
from restitution.calibration.result.release import fall_speed
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.errors import Defect, InputError
from restitution.tables.reading import read_table
from restitution.tables.schema import read_schema

PAIRS = Path(__file__).with_name("pairs.csv")
_SCHEMA = Path(__file__).with_name("pairs.json")


SAME_SPEED = 0.02
"""A higher fall that is faster by less than this fraction is the same experiment, at the terminal speed."""


@dataclass(frozen=True)
class Candidate:
    """One feasible experiment; ``height`` in m is that of the release, None where the speed is stated."""

    fluid: str
    sphere: str
    conditions: Conditions
    speed: float
    height: float | None = None


@dataclass(frozen=True)
class Gain:
    """What a candidate would do: standard errors of the target with so many shots, over the one now."""

    candidate: Candidate
    stokes: float
    e_eff: float
    ratio: tuple[float, ...]


def candidates(path: str | Path = PAIRS, heights: tuple[float, ...] = (0.01, 0.05, 0.2)) -> list[Candidate]:
    """The pairs of a table, each at its stated impact speed or after falls from rest over ``heights`` in m.

    Of falls that end at the same speed only the lowest is taken.
    """
    options: list[Candidate] = []
    for row in read_table(path, read_schema(_SCHEMA)).itertuples():
        fluid = Fluid(density=row.fluid_density_kg_m3, viscosity=row.fluid_viscosity_Pa_s)
        e_dry = None if np.isnan(row.e_dry) else row.e_dry
        sphere = Sphere(diameter=row.sphere_diameter_m, density=row.sphere_density_kg_m3, e_dry=e_dry)
        conditions = Conditions(fluid=fluid, sphere=sphere)
        name = f"{row.sphere} {row.sphere_diameter_m * 1e3:g} mm"
        if not np.isnan(row.impact_speed_m_s):
            options.append(Candidate(row.fluid, name, conditions, row.impact_speed_m_s))
            continue
        fastest = 0.0
        for height in sorted(heights):
            if (v := fall_speed(conditions, height)) > (1 + SAME_SPEED) * fastest:
                options.append(Candidate(row.fluid, name, conditions, v, height))
                fastest = v
    return options


@dataclass(frozen=True)
class Target:
    """What is to be known better: a parameter by name, or e_eff at a Stokes number."""

    parameter: str | None = None
    stokes: float | None = None


def levels_of(result: FitResult, target: Target, levels: Mapping[str, str] | None = None) -> dict[str, str]:
    """The levels of separate parameters that a target is about: those given, else that of the parameter itself."""
    name, _, level = (target.parameter or "").partition("[")
    own = {result.separate[name]: level.removesuffix("]")} if level and name in result.separate else {}
    return own | dict(levels or {})


class Design:
    """Expected gains of a fit for one target."""

    def __init__(
        self,
        result: FitResult,
        target: Target,
        e_dry: float | None = None,
        conditions: Conditions | None = None,
        e_sigma: float | None = None,
        stokes_sigma: float | None = None,
        same_source: bool = False,
        levels: Mapping[str, str] | None = None,
    ):
        """``e_sigma`` and ``stokes_sigma`` (relative) of a new impact; by default those typical of the fit.

        ``levels`` of separate parameters, as ``{"material": "steel"}``.
        """
        self.result, self.e_dry, self.levels = result, e_dry, levels_of(result, target, levels)
        self.law = Evaluation(result, e_dry, conditions, self.levels)
        if not self.law.names:
            raise InputError("the fit has no free parameter of the law: there is nothing to narrow")
        self.target = self._direction(target)
        measured = [p for p in result.points if p.e_eff is not None]
        self.e_sigma = float(np.median([p.e_eff_sigma for p in measured])) if e_sigma is None else e_sigma
        relative = float(np.median([p.stokes_sigma / p.stokes for p in measured]))
        self.stokes_sigma = relative if stokes_sigma is None else stokes_sigma
        self.offset = 0.0 if same_source else result.deviation(OFFSET)
        self.now = float(np.sqrt(self.target @ self.law.covariance @ self.target))
        if not self.now > 0:
            what = target.parameter or f"e_eff at St {target.stokes:g}"
            raise InputError(
                f"the fit leaves no error of {what} to narrow: choose another parameter or Stokes number"
            )

    def _direction(self, target: Target) -> NDArray:
        if target.stokes is not None:
            return self.law.jacobian(np.array([target.stokes]))[0]
        if target.parameter not in self.law.full_names:
            known = ", ".join(self.law.full_names)
            raise InputError(
                Defect(f"is not a parameter of the fitted law; there are: {known}", field=target.parameter)
            )
        return np.eye(len(self.law.names))[self.law.full_names.index(target.parameter)]

    def ratio(self, St: NDArray, shots: int, law: Evaluation | None = None) -> NDArray:
        """Standard error of the target after ``shots`` impacts at St, over the one now."""
        law = law or self.law
        C, g = self.law.covariance, law.jacobian(St)
        variance = self.e_sigma**2 + (law.slope(St) * self.stokes_sigma * St) ** 2
        s2 = (variance + self.result.deviation(SCATTER) ** 2) / shots + self.offset**2
        Cg = g @ C
        left = self.target @ C @ self.target - (Cg @ self.target) ** 2 / (s2 + np.einsum("ij,ij->i", Cg, g))
        return np.sqrt(np.maximum(left, 0.0)) / self.now

    def best(self, shots: int) -> tuple[float, float, float]:
        """The calibrated St where ``shots`` impacts narrow most, and the ends of where they do 9/10 of that."""
        low, high = self.result.stokes_range
        St = np.geomspace(low, high, 400)
        gain = 1 - self.ratio(St, shots)
        enough = St[gain >= 0.9 * gain.max()]
        return float(St[np.argmax(gain)]), float(enough[0]), float(enough[-1])

    def rank(self, options: list[Candidate], shots: tuple[int, ...], all_stokes: bool = False) -> list[Gain]:
        """Candidates within the calibrated range of St by the gain of the greatest number of shots, best first.

        Beyond it the law itself is not tested, so what it promises there is not counted unless ``all_stokes``.
        """
        low, high = self.result.stokes_range
        gains = []
        for option in options:
            St = stokes_of(self.result, np.array([option.speed]), option.conditions)
            if not all_stokes and not low <= St[0] <= high:
                continue
            law = Evaluation(self.result, self.e_dry, option.conditions, self.levels)
            ratios = tuple(float(self.ratio(St, m, law)[0]) for m in shots)
            gains.append(Gain(option, float(St[0]), float(law(St, law.values)[0]), ratios))
        return sorted(gains, key=lambda gain: gain.ratio[-1])


def best_of_pairs(gains: list[Gain]) -> list[Gain]:
    """Of a ranking the best speed of each fluid and sphere."""
    first: dict[tuple[str, str], Gain] = {}
    for gain in gains:
        first.setdefault((gain.candidate.fluid, gain.candidate.sphere), gain)
    return list(first.values())
