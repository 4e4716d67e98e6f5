"""``restitution fit --trajectory``: a law from all positions of whole trajectories."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import fit_options
from restitution.commands.console import now_and_then, show, show_doubts, show_facts, show_rows

if TYPE_CHECKING:
    from restitution.calibration.reading.reading import Reading
    from restitution.calibration.result.fit_result import FitResult
    from restitution.calibration.result.ranking import Ranking
    from restitution.calibration.trajectories.fit import Measured, TrajectoryFit
    from restitution.calibration.trajectories.recordings import Recording
    from restitution.doubts import Doubt


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options that belong to trajectories."""
    parser.add_argument(
        "--trajectory",
        action="store_true",
        help="fit to all positions of tracks of time and gap, by the equation of motion of a bouncing sphere; "
        "without --law every reading of Eq. (4), ranked",
    )
    parser.add_argument(
        "--wake",
        choices=("auto", "on", "off"),
        default="auto",
        help="with --trajectory: whether the sphere meets the wake of its approach (auto: what the frames prefer)",
    )
    parser.add_argument(
        "--film",
        action="store_true",
        help="with --trajectory: in place of the e of each bounce one resolved film a track, its h_min, tension "
        "and e_dry, with their correlations; no law",
    )
    parser.add_argument(
        "--release",
        metavar="LENGTH",
        help="with --trajectory: gap from which the sphere was let go at rest, as in 25.3mm (known to 1 %% and "
        "0.01 d; default: as conditions or settings state it, else what the frames tell)",
    )


def run(args: argparse.Namespace) -> None:
    """Fit, print, and write what was asked for."""
    from restitution.calibration.result.fit_summary import describe
    from restitution.calibration.trajectories.doubts import of_records
    from restitution.calibration.trajectories.fit import FEW, Measured, fit_law
    from restitution.calibration.trajectories.recordings import read_recordings
    from restitution.doubts import refuse
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole
    from restitution.foreign.settings import of_options
    from restitution.laws.source_abstract_eq4 import READINGS
    from restitution.stokes import H_FILM

    if args.speed not in (None, "far"):
        rule = "a whole trajectory gives the speed of the motion outside the film: far"
        raise InputError(Defect(rule, field="--speed", value=args.speed))
    how = fit_options.reading_of(args)
    if args.release is not None:
        how = replace(how, track=of_options(release=args.release).over(how.track))
    wakes = {"auto": (False, True), "on": (True,), "off": (False,)}[args.wake]
    plans = {
        law: fit_options.plan_of(args, law, args.law_stokes or how.stokes or "st", strict=args.law is not None)
        for law in ((args.law,) if args.law else READINGS)
    }
    if args.film:
        _fit_films(args, read_recordings(args.data, how), wakes)
        return
    edge = H_FILM if how.edge is None else how.edge
    measured = Measured.of(read_recordings(args.data, how), wakes, edge, now_and_then())
    show(f"within {edge:g} d of the wall e_eff stands for every viscous force; its law's constants belong to that")
    _show_records(measured)
    doubts = list(of_records(measured.trajectories[measured.preferred]))
    told = measured.rebounds_outside()
    if told == 0 or (args.law is None and told <= FEW):
        rule = f"{told or 'no'} rebound{'' if told == 1 else 's'} out of the film"
        show(f"laws are not ranked: {rule}, more than {FEW} are needed" + ("" if told else "; nothing is fitted"))
    if told == 0 or (args.law is None and told <= FEW and not (args.out or args.report)):
        show_doubts(doubts)
        if args.strict:
            refuse(doubts)
        return
    best = args.law or (READINGS[0] if told <= FEW else _rank(measured, plans, how))
    try:
        fit = fit_law(measured, plans[best], how)
    except InputError:
        show_doubts(doubts)  # they may be why
        raise
    if args.strict:
        refuse(fit.doubts)
    chain = None
    if args.posterior:
        from restitution.calibration.estimation.posterior import sample

        chain = sample(fit.fit.likelihood, fit.fit.maximum, args.seed, progress=sys.stderr.isatty())
    result = fit.result(chain)
    written = []
    if args.report:
        from restitution.report.fits import trajectories as report

        written = report.write(args.report, fit, result, args.out)
    elif args.out:
        write_whole(args.out, result.to_json())
    show_facts(describe(result))
    show_facts(_slopes(fit))
    _show_distances(result)
    for name in written:
        show(str(Path(args.report) / name))


def _fit_films(args: argparse.Namespace, records: Sequence[Recording], wakes: Sequence[bool]) -> None:
    """One film a record, and e_dry by all of them."""
    from restitution.calibration.trajectories.films import DRY_IMPACTS, FilmFit, combined
    from restitution.calibration.trajectories.flights import E_DRY, H_MIN, TENSION
    from restitution.doubts import refuse
    from restitution.errors import Defect, InputError

    for name, value in (("--law", args.law), ("--out", args.out), ("--report", args.report)):
        if value is not None:
            raise InputError(Defect("does not go with --film, which fits no law", field=name, value=value))
    doubts: list[Doubt] = []
    pairs = (H_MIN, E_DRY), (TENSION, E_DRY), (H_MIN, TENSION)
    for wake in wakes:
        fits = [FilmFit.of(r, wake) for r in records]
        rows = []
        for f in fits:
            (h, by_h), (tension, by_tension), t = f.factor(H_MIN), f.factor(TENSION), f.trajectory
            rows.append(
                (
                    f.name, f"{1e9 * h:.0f} */ {by_h:.1f}", f"{1e-3 * tension:.0f} */ {by_tension:.1f}",
                    "{:.3f} +- {:.3f}".format(*f.e_dry), *(f"{f.correlation(*pair):+.2f}" for pair in pairs),
                    f"{t.rms_d:.4f}", f"{t.log_evidence:.1f}",
                )
            )  # fmt: skip
            doubts += f.doubts
        show(f"one resolved film a record, {'with' if wake else 'without'} the wake of the approach:")
        heads = ("record", "h_min nm", "tension kPa", "e_dry", "r(h_min, e_dry)", "r(tension, e_dry)",
                 "r(h_min, tension)", "rms/d", "ln evidence")  # fmt: skip
        show_rows(heads, rows, right=heads[1:])
        if len(fits) > 1:
            c = combined(fits)
            show(
                f"together e_dry = {c.mean:.3f} +- {c.sigma:.3f} (chi^2 {c.chi_square:.1f} of {c.records} records)"
                f"; dry impacts of steel and glass: {DRY_IMPACTS[0]:g} +- {DRY_IMPACTS[1]:g}"
            )
    show_doubts(doubts)
    if args.strict:
        refuse(doubts)


def _show_records(measured: Measured) -> None:
    """What each record says, law or no law."""
    from restitution.calibration.trajectories.fit import FEW

    rows = []
    for wake, trajectories in measured.trajectories.items():
        for t in trajectories:
            d = t.recording.conditions.sphere.diameter
            e = ", ".join(f"{mean:.3f} +- {sigma:.3f}" for mean, sigma in t.restitutions)
            start = "{} {:.4g} +- {:.2g}".format(t.recording.start.name, *t.unknowns[t.recording.start.name])
            scale = "{:.3f} +- {:.3f}".format(*t.unknowns["scale"])
            noise = f"{t.sigma_u[0] / d:.2g} d, {1e3 * t.tau[0]:.2g} ms"
            rows.append((t.recording.name, "yes" if wake else "no", e, start, scale, noise, f"{t.rms_d:.4f}",
                         f"{t.log_evidence:.1f}"))  # fmt: skip
    heads = ("record", "wake", "e of each bounce", "start", "scale", "correlated noise", "rms/d", "ln evidence")
    show_rows(heads, rows, right=("rms/d", "ln evidence"))
    if measured.rebounds_outside() <= FEW:
        _show_bounces(measured)


def _show_bounces(measured: Measured) -> None:
    """The intervals of each e, where they are too few for a law to say more."""
    from scipy.special import ndtri

    from restitution.calibration.estimation.maximum import LEVELS

    rows = []
    for t in measured.trajectories[measured.preferred]:
        told = t.outside()
        for n, (mean, sigma) in enumerate(t.restitutions):
            ends = [f"{mean - z * sigma:.3f} to {mean + z * sigma:.3f}" for z in ndtri([0.84, 0.975])]
            rows.append((t.recording.name, str(n + 1), f"{mean:.3f}", *ends, "" if told[n] else "within the film"))
    show_rows(("record", "bounce", "e", *(f"{level:.0%}" for level in LEVELS), ""), rows)


def _rank(measured: Measured, plans: dict, how: Reading) -> str:
    """Every reading, with the wake and without; the best one under the model that the frames prefer."""
    from restitution.calibration.estimation.maximum import LEVELS
    from restitution.calibration.result.ranking import rank
    from restitution.calibration.trajectories.fit import law_fit, observations

    best = ""
    for wake, trajectories in measured.trajectories.items():
        o = observations(trajectories, how)
        ranking: Ranking = rank(list(plans.items()), o)
        rows = []
        for row in ranking.rows():
            s, best_of = row.score, law_fit(plans[row.law], o).maximum
            ends = ["{:.2f} to {:.2f}".format(*best_of.intervals[level][0]) for level in LEVELS]
            behind = "best" if row.best else f"{row.behind:.1f} +- {row.behind_error:.1f}"
            out = "" if s.elpd_loso is None else f"{s.elpd_loso:.1f}"
            apart = "yes" if row.separated else ""
            rows.append(
                (row.law, f"{best_of.values[0]:.2f}", *ends, f"{s.log_likelihood:.1f}", behind, out, apart)
            )
        show(f"{'with' if wake else 'without'} the wake of the approach, {len(o)} impacts:")
        heads = ("law", "K", "68 %", "95 %", "ln L", "elpd behind", "elpd, record out", "separated")
        show_rows(heads, rows, right=("K", "ln L"))
        for name, reason in ranking.failed.items():
            show(f"{name}: {reason}")
        if wake == measured.preferred:
            best = ranking.scores[0].label
    return best


def _slopes(fit: TrajectoryFit) -> list[tuple[str, str]]:
    """The slope-based fit beside it."""
    if isinstance(fit.slopes, str):
        return [("by slopes", f"no fit: {fit.slopes}")]
    maximum = fit.slopes.maximum
    facts = []
    for j, p in enumerate(maximum.parameters):
        if p.mean:
            low, high = maximum.intervals[0.68][j]
            facts.append(("by slopes", f"{p.name} {maximum.values[j]:.5g} (68% {low:.5g} to {high:.5g})"))
    return facts


def _show_distances(result: FitResult) -> None:
    """How far the model with the fitted law is from each record."""
    rows = [
        (t.record, f"{t.rms_law_d:.4f}", f"{t.rms_d:.4f}", f"{1e3 * t.apex_1_law_m:.3f}")
        for t in result.trajectories
    ]
    heads = ("record", "rms/d, e by the law", "rms/d, its own e", "first apex by the law, mm")
    show_rows(heads, rows, right=heads[1:])
