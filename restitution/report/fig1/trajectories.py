"""What the whole trajectories say of Eq. (4): all positions of all measured records, in the Fig. 1 report.

The records become restitutions of their bounces by the equation of motion
(:mod:`restitution.calibration.trajectories.whole_trajectories`), with the wake of the approach and without; the
forms of Eq. (4) with K fitted are then ranked as in :mod:`restitution.report.fig1.verdict`, a record being a
source.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.bounce.wake import STRENGTH, STRENGTH_SIGMA
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.rebound_model import model_of
from restitution.calibration.result.fit_result import result_of
from restitution.calibration.result.prediction import predict
from restitution.calibration.result.ranking import Ranking, Score, rank
from restitution.calibration.trajectories.fit import CLEAR, Measured, closures_of, law_fit, observations
from restitution.calibration.trajectories.flights import WAKE
from restitution.calibration.trajectories.whole_trajectories import distance_d
from restitution.report.fig1.verdict import FORMS, SHOWN
from restitution.report.records import READING
from restitution.report.records import measured as measured_records

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory
    from restitution.conditions import Conditions

BOUNCES = 3
"""Bounces of each record whose restitution is tabulated."""
LEFT_OUT_FORM = "eq4_exponential"
"""The form of Eq. (4) of which K is told without single records."""
MODELS = {True: "with the wake of the approach", False: "without the wake"}


@dataclass(frozen=True)
class Trajectories:
    """The records under both models, and the forms of Eq. (4) ranked under each."""

    measured: Measured
    rankings: dict[bool, Ranking]

    @property
    def best(self) -> Score:
        """The best supported form under the model that the frames prefer."""
        return self.rankings[self.measured.preferred].scores[0]

    def band(self, St: NDArray, e_dry: float, conditions: Conditions) -> tuple[float, NDArray]:
        """K of the best form, and where its curve lies with 95 %, shape (n, 2)."""
        prediction = predict(result_of(self.best.fit), St, e_dry, conditions)
        # Four digits: what a search for a maximum gives on any machine.
        return float(self.best.fit.maximum.values[0]), np.round(prediction.law["95%"], 4)

    @cached_property
    def distances(self) -> dict[str, tuple[float, float]]:
        """By record, rms distance in d and first apex in m of the model with the best form and its one K."""
        trajectories = self.measured.trajectories[self.measured.preferred]
        return {t.recording.name: distance_d(t, closures_of(self.best.fit, t.forces))[1:] for t in trajectories}

    @cached_property
    def left_out(self) -> list[dict]:
        """Rows of what is left of the preference, and of K, with none, each record, each laboratory left out."""
        laboratories: dict[str, list[str]] = {}
        for r in self.measured.records:
            laboratories.setdefault(datasets.resource(r.name).experiment.cite, []).append(r.name)
        groups = {"": [], **{r.name: [r.name] for r in self.measured.records}, **laboratories}
        return [_left_out(self.measured, name, tuple(group)) for name, group in groups.items()]

    def frames(self) -> int:
        """How many positions take part."""
        return sum(len(r.time_s) + r.rest_frames for r in self.measured.records)


def gather() -> Trajectories:
    """All measured records."""
    measured = measured_records()
    plans = [(name, Plan(model_of(name))) for name in FORMS]
    rankings = {
        wake: rank(plans, observations(measured.trajectories[wake], READING), intervals=SHOWN)
        for wake in measured.trajectories
    }
    return Trajectories(measured, rankings)


def _K(score: Score, level: float = 0.95) -> tuple[float, float, float]:
    low, high = score.fit.maximum.intervals[level][0]
    return float(score.fit.maximum.values[0]), float(low), float(high)


def in_words(t: Trajectories) -> list[str]:
    """The verdict, said only as far as the scores go."""
    gain, records = t.measured.preference(), t.measured.records
    better = MODELS[gain > 0]
    for_wake = [name for name, g in t.measured.gains.items() if g > CLEAR]
    against = [name for name, g in t.measured.gains.items() if g < -CLEAR]
    words = [
        f"All {t.frames()} positions of {len(records)} records together prefer the model {better} by "
        f"{abs(gain):.0f} in ln of the evidence, whatever the law. Of single records {_named(for_wake)} clearly "
        f"prefer it with the wake, {_named(against)} without (by more than {CLEAR:g}).",
        _borne_out(t),
    ]
    for wake in (True, False):
        ranking = t.rankings[wake]
        values = [
            f"{s.label} {k:.1f} ({low:.1f} to {high:.1f})" for s in ranking.scores for k, low, high in [_K(s)]
        ]
        first, *others = ranking.rows()
        apart = [row.law for row in others if row.separated]
        near = [f"{row.law} by {row.behind:.1f} ± {row.behind_error:.1f}" for row in others if not row.separated]
        tell = f"separated from it: {', '.join(apart)}" if apart else "separated from it: none"
        behind = f"; not separated: {', '.join(near)}" if near else ""
        words.append(
            f"{MODELS[wake].capitalize()}, K (95 % interval): {'; '.join(values)}. {first.law} predicts impacts "
            f"left out best; {tell}{behind} (difference in log predictive density)."
        )
    outside = [
        f"{s.label} {MODELS[wake]}"
        for wake in (True, False)
        for s in t.rankings[wake].scores
        if not _K(s)[1] <= 18 <= _K(s)[2]
    ]
    if len(outside) == sum(len(ranking.scores) for ranking in t.rankings.values()):
        words.append("K = 18 lies outside the 95 % interval of every form under both models.")
    elif outside:
        words.append(f"K = 18 lies outside the 95 % interval of {', '.join(outside)}.")
    return words


def _named(records: list[str]) -> str:
    return ", ".join(records) or "none"


def _borne_out(t: Trajectories) -> str:
    """What is left of the preference without single records and laboratories."""
    rest = {row["left_out"]: row["gain_of_the_rest"] for row in t.left_out[1:]}
    worst = min(rest, key=lambda name: rest[name])
    strengths = ", ".join(
        "{}: {:.2f} ± {:.2f}".format(found.recording.name, *found.unknowns[WAKE])
        for found in t.measured.trajectories[True]
        if found.unknowns[WAKE][1] < 0.5 * STRENGTH_SIGMA
    )
    if rest[worst] > 0:
        verdict = "whichever record or laboratory is left out, the rest prefers the model with it, at least by"
    else:
        verdict = f"without {worst} the rest does not prefer the model with it:"
    return (
        "The form of the wake and its strength come from runs with the flow resolved, not from these records; the "
        f"strength is an unknown of each record, known before to be {STRENGTH:g} ± {STRENGTH_SIGMA:g}, which "
        f"costs evidence. One at a time, {verdict} {rest[worst]:+.1f} ({worst} left out). Records that tell it "
        f"to half of that error or better: {strengths or 'none'}."
    )


def _left_out(m: Measured, name: str, group: tuple[str, ...]) -> dict:
    rest = m.without(group)
    row: dict = {
        "left_out": name, "records_left": len(rest.records),
        "gain_of_the_left_out": sum(m.gains[n] for n in group), "gain_of_the_rest": rest.preference(),
    }  # fmt: skip
    for wake, words in ((False, "without_wake"), (True, "with_wake")):
        row[f"ln_evidence_{words}"] = sum(found.log_evidence for found in rest.trajectories[wake])
        fit = law_fit(Plan(model_of(LEFT_OUT_FORM)), observations(rest.trajectories[wake], READING))
        low, high = fit.maximum.intervals[0.68][0]
        row |= {f"K_{words}": float(fit.maximum.values[0]), f"K_low_68_{words}": low, f"K_high_68_{words}": high}
    return row


def table(t: Trajectories) -> list[dict]:
    """Rows of the forms for the page and the CSV file."""
    rows = []
    for wake in (True, False):
        for row in t.rankings[wake].rows():
            s, (K, low, high) = row.score, _K(row.score)
            names = [p.name for p in s.fit.maximum.parameters]
            rows.append(
                {
                    "model": MODELS[wake], "law": row.law, "K": K, "K_low_95": low, "K_high_95": high,
                    "scatter": float(s.fit.maximum.values[names.index("scatter")]), "impacts": len(s.loo),
                    "log_likelihood": s.log_likelihood, "elpd_loo": s.elpd_loo, "behind_best": row.behind,
                    "behind_best_error": row.behind_error, "elpd_leave_record_out": s.elpd_loso,
                    "separated_from_best": row.separated,
                }
            )  # fmt: skip
    return rows


def records(t: Trajectories) -> list[dict]:
    """Rows of the records for the page and the CSV file: each under both models."""
    rows = []
    for wake in (True, False):
        for trajectory in t.measured.trajectories[wake]:
            rows.append(_record(trajectory, wake, t))
    return rows


def _record(trajectory: WholeTrajectory, wake: bool, t: Trajectories) -> dict:
    d = trajectory.recording.conditions.sphere.diameter
    scale, scale_sigma = trajectory.unknowns["scale"]
    shown = wake == t.measured.preferred
    rms, apex = t.distances[trajectory.recording.name] if shown else (np.nan, np.nan)
    row = {
        "record": trajectory.recording.name, "model": MODELS[wake], "frames": len(trajectory.recording.time_s),
        "frames_at_rest": trajectory.recording.rest_frames, "ln_evidence": trajectory.log_evidence,
        "correlated_noise_d": trajectory.sigma_u[0] / d, "correlation_time_s": trajectory.tau[0],
        "scale": scale, "scale_sigma": scale_sigma, "rms_d": trajectory.rms_d, "rms_law_d": rms,
        "first_apex_law_m": apex,
    }  # fmt: skip
    e = trajectory.restitutions + [(np.nan, np.nan)] * BOUNCES
    for n in range(BOUNCES):
        row[f"e_{n + 1}"], row[f"e_{n + 1}_sigma"] = e[n]
    return row
