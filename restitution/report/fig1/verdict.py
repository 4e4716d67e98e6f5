"""Which reading of Eq. (4) do the measured rebounds support: predictive scores, with their uncertainty.

Each law is judged as it stands (its numbers held) and the forms of Eq. (4) once more with K fitted. Scatter from
impact to impact and an offset of each record are estimated with every law, so that a law is not punished for what
no law explains; impacts without a rebound count as limits. The scores are those of
:mod:`restitution.calibration.result.ranking`, a record being a source.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.rebound_model import model_of
from restitution.calibration.reading.observations import Observations
from restitution.calibration.result.ranking import Ranking, Score, rank

if TYPE_CHECKING:
    import pandas as pd

    from restitution.conditions import Conditions

FORMS = ("eq4_exponential", "eq4_rational", "eq4_linear")
"""The forms of Eq. (4) that differ once K is fitted: at one e_dry the others are the same curves."""
SHOWN = ("K",)
"""Parameters whose intervals are shown."""


@dataclass(frozen=True)
class Judgement:
    """Rankings under one definition of speed: laws as they stand, and forms of Eq. (4) with K fitted."""

    definition: str
    held: Ranking
    fitted: Ranking

    def reading(self, names: tuple[str, ...]) -> list[Score]:
        """The scores of some of the laws as they stand, best first."""
        return [s for s in self.held.scores if s.label in names]

    def K(self, form: str) -> tuple[float, float, float] | None:
        """K of a fitted form with its 95 % interval; None where it could not be fitted."""
        for s in self.fitted.scores:
            if s.label == form:
                low, high = s.fit.maximum.intervals[0.95][0]
                return float(s.fit.maximum.values[0]), float(low), float(high)
        return None


def observations(every: pd.DataFrame, definition: str, conditions: dict[str, Conditions]) -> Observations:
    """The measured impacts under one definition of speed, each record a source."""
    rows = every[(every.speed_definition == definition) & (every.kind == "measured")]
    return Observations.from_impacts(rows, [conditions[record] for record in rows.record])


def judge(every: pd.DataFrame, conditions: dict[str, Conditions], names: tuple[str, ...]) -> list[Judgement]:
    """Judgements under every definition of speed in the table; ``names`` are the laws to judge as they stand."""
    judgements = []
    for definition in dict.fromkeys(every.speed_definition):
        o = observations(every, definition, conditions)
        held = [(name, _plan(name, True)) for name in names]
        fitted = [(name, _plan(name, False)) for name in FORMS]
        rankings = (rank(plans, o, intervals=SHOWN) for plans in (held, fitted))
        judgements.append(Judgement(definition, *rankings))
    return judgements


def _plan(name: str, held: bool) -> Plan:
    model = model_of(name)
    return Plan(model, fixed={p.name: p.start for p in model.parameters} if held else {})


def in_words(judgements: list[Judgement], readings: tuple[str, ...]) -> list[str]:
    """The verdict, said only as far as the scores go."""
    words = []
    best = {j.definition: j.reading(readings)[0].label for j in judgements}
    if len(set(best.values())) == 1:
        words.append(
            f"With K = 18 as it stands, the rebounds support {_one(best)} under every definition of speed."
        )
    else:
        named = "; ".join(f"{label} under {d}" for d, label in best.items())
        words.append(f"With K = 18 as it stands, the best supported reading depends on the definition: {named}.")
    for j in judgements:
        first, second = j.reading(readings)[:2]
        gap, error = j.held.difference(first, second)
        apart = "separated" if j.held.separated(first, second) else "not separated by the data"
        rejected = [s.label for s in j.reading(readings)[1:] if j.held.separated(first, s)]
        also = f"; separated from it: {', '.join(rejected)}" if rejected else ""
        words.append(
            f"Under {j.definition}, {first.label} is ahead of the next reading, {second.label}, by "
            f"{gap:.1f} ± {error:.1f} in log predictive density ({apart}){also}."
        )
    for j in judgements:
        values = [
            f"{form} {K:.1f} ({low:.1f} to {high:.1f})"
            for form in FORMS
            if (k := j.K(form))
            for K, low, high in [k]
        ]
        contenders = [s.label for s in j.fitted.contenders]
        tell = (
            f"not separated: {', '.join(contenders)}"
            if len(contenders) > 1
            else f"separated: {contenders[0]} is best"
        )
        words.append(f"With K fitted under {j.definition} (95 % interval): {'; '.join(values)}; {tell}.")
    outside = [
        (j.definition, form)
        for j in judgements
        for form in FORMS[:2]
        if (k := j.K(form)) and not k[1] <= 18 <= k[2]
    ]
    if outside:
        listed = ", ".join(f"{form} under {d}" for d, form in outside)
        words.append(f"K = 18 lies outside the 95 % interval of {listed}.")
    return words


def _one(best: dict[str, str]) -> str:
    return next(iter(best.values()))


def table(judgements: list[Judgement]) -> list[dict]:
    """Rows for the page and the CSV file: one law or fitted form under one definition."""
    rows = []
    for j in judgements:
        for kind, ranking in (("as it stands", j.held), ("K fitted", j.fitted)):
            for row in ranking.rows():
                s, K = row.score, j.K(row.law) if kind == "K fitted" else None
                rows.append(
                    {
                        "speed_definition": j.definition,
                        "law": row.law,
                        "parameters": kind,
                        "K": K[0] if K else None,
                        "K_low_95": K[1] if K else None,
                        "K_high_95": K[2] if K else None,
                        "impacts": len(s.loo),
                        "aic": s.aic,
                        "bic": s.bic,
                        "elpd_loo": s.elpd_loo,
                        "behind_best": row.behind,
                        "behind_best_error": row.behind_error,
                        "elpd_leave_record_out": s.elpd_loso,
                        "predictive_check_p": s.check,
                        "separated_from_best": row.separated,
                    }
                )
    return rows
