"""``restitution compare``: which law do the data support, and do they tell laws apart."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from restitution.commands import fit_options, options
from restitution.commands.console import now_and_then, show, show_doubts, show_rows

if TYPE_CHECKING:
    from restitution.calibration.result.ranking import Ranking, Row, Score


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``compare DATA... [--law LAW ...]``."""
    parser = commands.add_parser(
        "compare",
        help="rank laws on your own impacts, by refitting without each impact and each source",
        description="Rank rebound laws by AIC, BIC, leave-one-out and leave-one-source-out predictive scores.",
    )
    fit_options.add_data(parser)
    parser.add_argument(
        "--law",
        action="append",
        metavar="LAW",
        help="a law or a formula; may be repeated (default: all rebound laws)",
    )
    parser.add_argument("--law-stokes", metavar="CONVENTION", help="which Stokes number St in a formula is")
    parser.add_argument("--as-published", action="store_true", help="hold the laws' parameters at their defaults")
    fit_options.add_plan(parser)
    parser.add_argument("--out", metavar="FILE", help="also write the table, as CSV")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> None:
    """Print the ranking, best first, and what the data do not separate."""
    from restitution import laws
    from restitution.calibration.reading.impact_checks import doubts_about
    from restitution.calibration.reading.impact_data import read
    from restitution.calibration.result.ranking import rank
    from restitution.doubts import refuse
    from restitution.errors import InputError
    from restitution.files import write_whole

    if not args.data:
        raise InputError("name the data: CSV files or shipped records")
    options.check_output("--out", args.out, args.data)
    observations = read(args.data, fit_options.reading_of(args))
    plans = []
    wanted = args.law or laws.names("rebound")
    stokes = fit_options.convention_of_formula(args.law_stokes, wanted, observations.convention)
    for law in wanted:
        plan = fit_options.plan_of(args, law, stokes, strict=len(wanted) == 1)
        if args.as_published:
            plan = replace(plan, fixed={p.name: p.start for p in plan.model.parameters} | dict(plan.fixed))
        plans.append((law, plan))
    doubts = doubts_about(observations, plans[0][1].known_e_dry)
    if args.strict:
        refuse(doubts)
    ranking = rank(plans, observations, progress=now_and_then())
    if args.out:
        write_whole(args.out, _csv(ranking))
    show(f"{len(observations)} impacts; higher elpd and lower AIC, BIC are better; d: less than the best")
    _show(ranking)
    show_doubts(doubts)


_NAMED = 5
"""Impacts named one by one."""
HEADINGS = (
    "law",
    "k",
    "log L",
    "AIC",
    "BIC",
    "elpd, one out",
    "d",
    "+-",
    "elpd, source out",
    "check p",
    "separated",
)


def table(ranking: Ranking) -> list[tuple[str, ...]]:
    """The ranking as cells."""
    return [
        (
            row.law, str(s.parameters), f"{s.log_likelihood:.1f}", f"{s.aic:.1f}", f"{s.bic:.1f}",
            f"{s.elpd_loo:.1f}", f"{row.behind:.1f}", f"{row.behind_error:.1f}",
            "" if s.elpd_loso is None else f"{s.elpd_loso:.1f}",
            f"{s.check:.2f}", _apart(row),
        )
        for row in ranking.rows()
        for s in [row.score]
    ]  # fmt: skip


def _apart(row: Row) -> str:
    return "best" if row.best else "yes" if row.separated else "no"


COLUMNS = (
    "law",
    "parameters",
    "log_likelihood",
    "aic",
    "bic",
    "elpd_one_out",
    "difference",
    "difference_sigma",
    "elpd_source_out",
    "check_p",
    "separated",
)
"""Of the file, which has all digits."""


def _csv(ranking: Ranking) -> str:
    from restitution.tables.writing import rows_text

    rows = [
        (
            row.law, s.parameters, s.log_likelihood, s.aic, s.bic, s.elpd_loo, row.behind, row.behind_error,
            s.elpd_loso, f"{s.check:.3g}", _apart(row),
        )
        for row in ranking.rows()
        for s in [row.score]
    ]  # fmt: skip
    return rows_text(COLUMNS, rows)


def _show(ranking: Ranking) -> None:
    show_rows(HEADINGS, table(ranking), right=HEADINGS[1:-1])
    contenders = [s.label for s in ranking.contenders]
    if len(contenders) > 1:
        show(f"the data do not separate: {', '.join(contenders)}")
    elif len(ranking.scores) > 1:
        show(f"the data support {contenders[0]} over all others")
    for s in ranking.scores:
        if s.refitted < len(s.loo):
            show(f"{s.label}: {_how_left_out(s)}")
    unlike = [s.label for s in ranking.scores if s.check < 0.05]
    if unlike:
        show(
            f"note: neighbours in St deviate alike (check p < 0.05), so the shape is in doubt: {', '.join(unlike)}"
        )
    for reason in dict.fromkeys(ranking.failed.values()):
        show(f"left out: {', '.join(law for law, why in ranking.failed.items() if why == reason)}: {reason}")


def _how_left_out(score: Score) -> str:
    """Which impacts were left out by weights of draws, which by fits, and what that may do to the sum."""
    out, observations = score.left_out, score.fit.likelihood.observations
    n, distrusted = len(score.loo), out.distrusted
    checked = score.refitted - len(distrusted)
    text = (
        f"{n - score.refitted} of {n} impacts left out by Pareto-smoothed weights of draws (k up to "
        f"{out.largest_k:.2f}), {checked} drawn at random by fits, which puts the error of the "
        f"elpd at {out.error:.2g}"
    )
    if not len(distrusted):
        return text
    rows = [":".join(map(str, observations.place(i).values())) for i in distrusted[:_NAMED].tolist()]
    named = ", ".join(filter(None, rows)) + (", ..." if len(distrusted) > _NAMED else "")
    where = f" ({named})" if any(rows) else ""
    return f"{text}; {len(distrusted)} whose weights cannot be trusted by fits too{where}"
