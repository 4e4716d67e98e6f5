"""First rebounds that this package's solver gives over St, density ratio and e_dry: does one K of Eq. (4) hold?

``rebounds.csv`` (``python -m benchmarks.simulated_rebounds``) has a row a run and definition of speed: the columns
of the impact table, and ``density_ratio``, ``stokes_of_drive``, ``cells_per_diameter`` and ``rates``. Runs of two
grids make one rebound. It is that of the finer one, whose error is taken to fall with the first order of the cell,

    sigma_grid = |e_fine - e_coarse|/(c_fine/c_coarse - 1),

c being the cells a diameter; that of reading it off the frames is added in quadrature. The forms of Eq. (4) with
K free are fitted to these rebounds alone, by the likelihood that fits measured ones; limits count as limits.
Measured and simulated rebounds are never in one table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.fitting import estimate
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.rebound_model import model_of
from restitution.calibration.reading.observations import Observations
from restitution.calibration.result.ranking import Ranking, Score, rank
from restitution.laws.source_abstract_eq4 import READINGS
from restitution.report.fig1.verdict import SHOWN
from restitution.stokes import Speed

if TYPE_CHECKING:
    import pandas as pd

FILE = "reports/rebounds/rebounds.csv"
DEFINITIONS = (Speed.FAR, Speed.CONTACT)
EXPONENTIAL = ("eq4_exponential", "eq4_exponential_over_e")
"""Forms of Eq. (4) of which every rebound gives a K of its own."""
PREFERRED = "balanced-by-place"
"""Rates of a rebound that was run with several, where both grids bear them: the solver's own."""
_KEY = ["density_ratio", "stokes_of_drive", "e_dry", "rates"]


@dataclass(frozen=True)
class Group:
    """Rebounds of one density ratio and e_dry: K of the best form that is theirs alone, with its 95 % interval."""

    density_ratio: float
    e_dry: float
    rebounds: int
    K: tuple[float, float, float]


class ChiSquare(NamedTuple):
    """Of values about what they have in common."""

    value: float
    freedom: int

    @property
    def p(self) -> float:
        """How often values that have it in common differ so much or more."""
        from scipy.stats import chi2

        return float(chi2.sf(self.value, self.freedom)) if self.freedom else 1.0

    @property
    def text(self) -> str:
        """As in a sentence."""
        return f"chi-square {self.value:.1f} on {self.freedom}, p = {self.p:.2g}"


@dataclass(frozen=True)
class Held:
    """One K for all rebounds under one definition of speed: the forms of Eq. (4), best first, and K by group.

    Chi-square with its degrees of freedom: of the groups' K about the one of all, ``every``; the same against St*,
    the Stokes number with added mass, ``with_added_mass``; about the one of a density ratio, ``at_a_ratio``.
    """

    definition: str
    ranking: Ranking
    by_group: tuple[Group, ...]
    every: ChiSquare
    with_added_mass: ChiSquare
    at_a_ratio: ChiSquare

    @property
    def best(self) -> Score:
        """The form that predicts best what it has not seen."""
        return self.ranking.scores[0]


@dataclass(frozen=True)
class Rebounds:
    """``points`` has a row a rebound and definition; ``held`` what the fits say; ``lost`` runs that diverged."""

    points: pd.DataFrame
    held: tuple[Held, ...]
    lost: pd.DataFrame
    rates_differ: float
    """Largest difference of e_eff between rates, where both were run."""

    def of(self, definition: str) -> pd.DataFrame:
        """The rebounds under one definition of speed."""
        return self.points[self.points.speed_definition == definition].reset_index(drop=True)


@cache
def gather(path: str | Path) -> Rebounds:
    """The rebounds of a table, each from its two grids, and the fits."""
    import pandas as pd

    table = pd.read_csv(path)
    lost = table[table.outcome == "diverged"]
    every = _of_two_grids(table[table.outcome != "diverged"])
    one = every.sort_values("rates", key=lambda r: r != PREFERRED, kind="stable")
    points = one.drop_duplicates([*_KEY[:-1], "speed_definition"])
    points = points.sort_values(_KEY, kind="stable").reset_index(drop=True)
    held = tuple(_held(points[points.speed_definition == str(d)]) for d in DEFINITIONS)
    seen = every[every.speed_definition.isin([str(d) for d in DEFINITIONS])]
    spread = seen.groupby([*_KEY[:-1], "speed_definition"]).e_eff
    return Rebounds(points, held, lost, float((spread.max() - spread.min()).max()))


def _of_two_grids(table: pd.DataFrame) -> pd.DataFrame:
    """The finer of two grids with the error that the coarser one tells; rebounds of one grid are left out."""
    import pandas as pd

    found = []
    for _, pair in table.groupby([*_KEY, "speed_definition"], sort=False):
        if len(pair) != 2 or pair.outcome.nunique() > 1:
            continue
        coarse, fine = (row for _, row in pair.sort_values("cells_per_diameter").iterrows())
        cells = (coarse.cells_per_diameter, fine.cells_per_diameter)
        sigma = abs(fine.e_eff - coarse.e_eff) / (cells[1] / cells[0] - 1)
        total = np.hypot(sigma, fine.e_eff_sigma)
        found.append(
            {**fine, "cells": cells, "e_grid_sigma": sigma, "e_coarse": coarse.e_eff, "e_total_sigma": total}
        )
    return pd.DataFrame(found)


def _held(rows: pd.DataFrame) -> Held:
    o = _observations(rows, False)
    ranking = rank([(name, Plan(model_of(name), offsets=False)) for name in READINGS], o, intervals=SHOWN)
    best = ranking.scores[0].label
    plain, starred = (_by_group(best, _observations(rows, star)) for star in (False, True))
    ratios = [[g for g in plain if g.density_ratio == ratio] for ratio in sorted({g.density_ratio for g in plain})]
    one = [_chi_square(groups) for groups in ratios]
    at_a_ratio = ChiSquare(sum(c.value for c in one), sum(c.freedom for c in one))
    definition = rows.speed_definition.iloc[0]
    return Held(definition, ranking, plain, _chi_square(plain), _chi_square(starred), at_a_ratio)


def _by_group(form: str, o: Observations) -> tuple[Group, ...]:
    found = []
    for source in dict.fromkeys(o.labels["source"]):
        own = o.labels["source"] == source
        if (own & ~o.censored).sum() < 2:
            continue
        fit = estimate(Plan(model_of(form), offsets=False, scatter=False), o.take(own), SHOWN)
        low, high = fit.maximum.intervals[0.95][0]
        K = tuple(map(float, (fit.maximum.values[0], low, high)))
        ratio, e_dry = map(float, source.split(" "))
        found.append(Group(ratio, e_dry, int(own.sum()), K))
    return tuple(found)


def _chi_square(groups: Sequence[Group]) -> ChiSquare:
    K, low, high = np.array([g.K for g in groups]).T
    weight = (2 * 1.96 / (high - low)) ** 2
    value = np.sum(weight * (K - np.sum(weight * K) / np.sum(weight)) ** 2)
    return ChiSquare(float(value), len(groups) - 1)


def _observations(rows: pd.DataFrame, star: bool) -> Observations:
    """Rebounds as the fits read them; with ``star`` against (rho_p + rho_f/2) v d/(9 mu)."""
    scale = 1 + 0.5 / rows.density_ratio if star else 1.0
    told = rows.assign(
        stokes=rows.stokes * scale,
        stokes_sigma=rows.stokes_sigma * scale,
        e_eff_sigma=rows.e_total_sigma,
        source=[f"{r:g} {e:g}" for r, e in zip(rows.density_ratio, rows.e_dry, strict=True)],
    )
    return Observations.from_impacts(told)


def each_K(form: str, rows: pd.DataFrame) -> tuple[NDArray, NDArray]:
    """K that each rebound of ``rows`` would have by itself in one of :data:`EXPONENTIAL`, and dK over -de_eff."""
    St, e, e_dry = (rows[name].to_numpy(float) for name in ("stokes", "e_eff", "e_dry"))
    scale = St / (1 + e_dry) * (e_dry if form == "eq4_exponential_over_e" else 1.0)
    return scale * np.log(e_dry / e), scale / e


def table(r: Rebounds) -> list[dict]:
    """Rows for the page: a form of Eq. (4) with one K for all, under one definition of speed."""
    rows = []
    for h in r.held:
        for row in h.ranking.rows():
            values, ends = row.score.fit.maximum.values, row.score.fit.maximum.intervals[0.95][0]
            rows.append(
                {
                    "speed_definition": h.definition,
                    "law": row.law,
                    "K": float(values[0]),
                    "K_low_95": float(ends[0]),
                    "K_high_95": float(ends[1]),
                    "scatter": float(values[-1]),
                    "rebounds": len(row.score.loo),
                    "aic": row.score.aic,
                    "elpd_loo": row.score.elpd_loo,
                    "behind_best": row.behind,
                    "behind_best_error": row.behind_error,
                    "predictive_check_p": row.score.check,
                    "separated_from_best": row.separated,
                }
            )
    return rows


def in_words(r: Rebounds) -> list[str]:
    """What the simulated rebounds say of Eq. (4), only as far as they go."""
    words = []
    for h in r.held:
        s, score = _range(r.of(h.definition)), h.best
        K, (low, high) = score.fit.maximum.values[0], score.fit.maximum.intervals[0.95][0]
        others = [row.law for row in h.ranking.rows() if not row.best and not row.separated]
        beside = f"not separated from it: {', '.join(others)}" if others else "all others are separated from it"
        words.append(
            f"Under {h.definition}, {len(score.loo)} rebounds ({s}) are predicted best by {score.label} with one "
            f"K = {K:.1f} ({low:.1f} to {high:.1f}, 95 %) and a scatter of {score.fit.maximum.values[-1]:.3f}; "
            f"{beside}."
        )
        each = ", ".join(f"{g.K[0]:.1f} ({g.density_ratio:g}; {g.e_dry:g})" for g in h.by_group)
        words.append(
            f"K of that form by density ratio and e_dry: {each}. Across e_dry at one density ratio "
            f"{_holds(h.at_a_ratio)}; across all {_holds(h.every)}. With added mass in the Stokes number, St*: "
            f"{h.with_added_mass.text}."
        )
        if h.ranking.failed:
            words.append(f"Under {h.definition} {', '.join(h.ranking.failed)} cannot be fitted to them.")
        if score.label in EXPONENTIAL:
            words.append(_slope(score.label, r.of(h.definition)))
    return words


def _holds(c: ChiSquare) -> str:
    said = "one K holds within the errors" if c.p > _LEAST_P else "no one K holds"
    return f"{said} ({c.text})"


def _slope(form: str, rows: pd.DataFrame) -> str:
    """K by the weakest and by the strongest rebound of each density ratio, at the greatest e_dry."""
    seen = rows[(rows.outcome == "rebound") & (rows.e_dry == rows.e_dry.max())]
    found = []
    for ratio, group in seen.groupby("density_ratio"):
        ends = group.sort_values("stokes").iloc[[0, -1]]
        (a, b), per_e = each_K(form, ends)
        sa, sb = ends.e_total_sigma.to_numpy(float) * per_e
        St = ends.stokes.to_numpy()
        found.append(f"{a:.1f} ± {sa:.1f} at St {St[0]:.0f}, {b:.1f} ± {sb:.1f} at St {St[1]:.0f} ({ratio:g})")
    return f"K by one rebound, weakest and strongest at e_dry {seen.e_dry.max():g}: {'; '.join(found)}."


_LEAST_P = 0.05


def _range(rows: pd.DataFrame) -> str:
    def numbers(name: str) -> str:
        return ", ".join(f"{x:g}" for x in sorted(set(rows[name])))

    St = rows.stokes
    return (
        f"density ratios {numbers('density_ratio')}; e_dry {numbers('e_dry')}; St {St.min():.0f} to {St.max():.0f}"
    )
