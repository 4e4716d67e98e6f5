"""``restitution validate``: the scorecard of the solver, the closures and the point particle."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import validate_trajectory
from restitution.commands.console import show, show_rows

if TYPE_CHECKING:
    from restitution.validation.baseline import Baseline
    from restitution.validation.row import Row
    from restitution.validation.scorecard import Result, Scorecard

_STATUS = """exit status:
  0  every row passes, or is a known miss that has not moved from the baseline; after --bless, none fails the truth
  1  a row fails against the truth or the baseline
  2  input that cannot be used
  3  a row was not evaluated, or there is no baseline for it
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``validate``."""
    parser = commands.add_parser(
        "validate",
        help="did a change spoil the solver? A scorecard against the truth and against a baseline",
        description="Run rows of known answers and say of each whether it agrees with the truth, and whether it "
        "is what it was. Writes scorecard.json and a page with a small plot a row. Times are for two "
        "cores, once the kernels are compiled (half a minute, after each change of the solver).",
        epilog=_STATUS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--depth",
        choices=("quick", "default", "full"),
        default="default",
        help="quick: a minute; default: ten minutes; full: hours, all kept runs are made again",
    )
    parser.add_argument(
        "--only", nargs="+", action="extend", metavar="ROW", help="these rows, of any depth; may be repeated"
    )
    parser.add_argument(
        "--failed", action="store_true", help="the rows that did not pass in the folder's scorecard"
    )
    parser.add_argument("--list", action="store_true", help="name the rows, or those that were named, and stop")
    parser.add_argument(
        "--out",
        metavar="FOLDER",
        default="validation",
        help="where index.html and scorecard.json go; "
        "of --trajectory index.html, figure.svg, figure.png, scores.json (validation)",
    )
    parser.add_argument("--resume", action="store_true", help="go on where a stopped run of the same program was")
    parser.add_argument("--strict", action="store_true", help="a known miss of the truth fails too")
    parser.add_argument(
        "--baseline",
        metavar="FILE",
        help="what to compare with, or --bless writes (reports/validate/baseline.json, else the one installed)",
    )
    parser.add_argument(
        "--bless",
        metavar="REASON",
        help="renew the baseline with what these rows give now, and "
        "say why; lbm, restitution, data and reports/runs must be as committed",
    )
    parser.add_argument(
        "--runs", metavar="FOLDER", help="where runs are kept (reports/runs, else those installed)"
    )
    validate_trajectory.add_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure, print, write; returns the exit status."""
    from restitution.files import write_folder, write_whole
    from restitution.validation import page
    from restitution.validation.baseline import blessed
    from restitution.validation.row import Depth
    from restitution.validation.rows import Setting, all_rows, chosen, kept_runs
    from restitution.validation.scorecard import FILE, SO_FAR, Judged, Scorecard
    from restitution.validation.verdict import FAILED, Verdict

    validate_trajectory.check(args)
    runs = Path(args.runs or kept_runs())
    folder = _folder(args.out)
    if args.list:
        only = _only(args, folder)
        _list(chosen(all_rows(Setting(runs)), Depth.FULL, only))
        return 0
    if args.trajectory:
        return validate_trajectory.run(args, folder)
    path, baseline = _baseline(args)
    depth = Depth(args.depth)
    again = folder / "runs" if depth is Depth.FULL and not args.only and not args.failed else None
    every = all_rows(Setting(runs, again, not args.resume))
    rows = chosen(every, depth, _only(args, folder))
    if not rows:
        show("every row of that scorecard passed")
        return 0
    spread = _spread(args, path, rows)
    folder.mkdir(parents=True, exist_ok=True)
    results = _measured(args, rows, baseline, folder)
    judged = [Judged.of(row, results[name], baseline and baseline.held(row)) for name, row in rows.items()]
    card = Scorecard(
        judged, "as named" if args.only or args.failed else args.depth, str(path) if baseline else "", args.strict
    )
    write_folder(folder, {FILE: card.text(), "index.html": page.render(card)})
    (folder / SO_FAR).unlink(missing_ok=True)
    _show(card)
    if baseline is None:
        show(
            f"no baseline: {path} is not there, so nothing is known of what was (--baseline FILE, --bless REASON)"
        )
    for name in (FILE, "index.html"):
        show(str(folder / name))
    if args.bless is not None:
        write_whole(path, blessed(rows, results, spread, args.bless, baseline, every).text())
        show(f"{path}: {len(rows)} rows renewed")
        wrong = [judged.row.name for judged in judged if judged.truth is Verdict.FAIL]
        if wrong:
            show(f"doubt: held now, and still failing against the truth: {', '.join(wrong)}")
        return FAILED if wrong else 0
    return card.status


def _list(rows: dict[str, Row]) -> None:
    show_rows(("row", "depth", "kind", "quantity"), [(r.name, r.depth, r.kind, r.quantity) for r in rows.values()])


def _folder(given: str) -> Path:
    from restitution.errors import Defect, InputError
    from restitution.files import check_folder

    if not given:
        raise InputError(Defect("names no folder", field="--out"))
    check_folder(given)
    return Path(given)


def _baseline(args: argparse.Namespace) -> tuple[Path, Baseline | None]:
    """Where the baseline is, and what it holds; None where there is none and none was named."""
    from restitution.errors import Defect, InputError
    from restitution.validation.baseline import BASELINE, FOLDER, read_baseline, shipped

    path = Path(args.baseline or (shipped(BASELINE) if args.bless is None else FOLDER / BASELINE))
    if path.is_file():
        return path, read_baseline(path)
    if path.is_dir():
        rule = f"is a folder: name the file in it, such as {path / BASELINE}"
        raise InputError(Defect(rule, file=str(path), field="--baseline"))
    if args.baseline and args.bless is None:
        raise InputError(Defect("is not there", file=args.baseline, field="--baseline"))
    return path, None


def _spread(args: argparse.Namespace, path: Path, rows: dict[str, Row]) -> dict[str, dict[str, float]]:
    """The measured spread, where the baseline is to be renewed; what forbids that is said before any work."""
    from restitution.files import check_place
    from restitution.validation.baseline import SPREAD, check_blessing, read_spread, shipped

    if args.bless is None:
        return {}
    check_place(path)
    own = path.with_name(SPREAD)
    spread = read_spread(own if own.is_file() else shipped(SPREAD))
    check_blessing(rows, spread, args.bless)
    return spread


def _only(args: argparse.Namespace, folder: Path) -> list[str] | None:
    from restitution.errors import Defect, InputError
    from restitution.validation.scorecard import failed_rows

    if not args.failed:
        return args.only
    if args.only:
        raise InputError(Defect("stands beside --only: give the one or the other", field="--failed"))
    return failed_rows(folder)


def _measured(
    args: argparse.Namespace, rows: dict[str, Row], baseline: Baseline | None, folder: Path
) -> dict[str, Result]:
    from restitution.validation.measure import measure_all
    from restitution.validation.scorecard import Judged

    def say(text: str) -> None:
        print(text, file=sys.stderr)  # noqa: T201

    def done(row: Row, result: Result) -> None:
        judged = Judged.of(row, result, baseline and baseline.held(row))
        say(f"    {result.seconds:.1f} s; truth: {judged.truth}, baseline: {judged.baseline}")

    try:
        return measure_all(rows, folder, args.resume, say, done)
    except KeyboardInterrupt:
        say("stopped; the same command with --resume goes on with the row that was being measured")
        raise


def _show(card: Scorecard) -> None:
    from restitution.validation.verdict import Verdict

    lines = []
    for judged in card.rows:
        values = judged.result.numbers or {}
        wrong = [label for label, v in judged.truth_by_label.items() if v is not Verdict.PASS]
        wrong += [n for n, v in judged.baseline_by_label.items() if v is not Verdict.PASS and n not in wrong]
        said = judged.result.why or ", ".join(f"{n} {values[n]:.4g}" for n in wrong[:3] if n in values)
        more = f" and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        lines.append((judged.row.name, judged.truth, judged.baseline, f"{judged.result.seconds:.1f}", said + more))
    show_rows(("row", "truth", "baseline", "s", "what is not as it should be"), lines, right=("s",))
    for verdict in Verdict:
        truth, baseline = card.count(verdict)
        if truth or baseline:
            show(f"{verdict}: {truth} against the truth, {baseline} against the baseline")
