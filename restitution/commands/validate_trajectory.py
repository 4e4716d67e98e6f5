"""``restitution validate --trajectory``: trajectories of somebody else's solver against a record."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import show, show_rows

if TYPE_CHECKING:
    from restitution.cases.case import Case
    from restitution.tracks import Track
    from restitution.validation.trajectory import Scored


def add_options(parser: argparse.ArgumentParser) -> None:
    """What is scored, against which record, and what its numbers mean."""
    group = parser.add_argument_group("a trajectory of another solver")
    group.add_argument(
        "--trajectory", nargs="+", action="extend", metavar="FILE",
        help="score these against the record of --case: time and gap, height or velocity, in any unit (--unit, "
        "--time-unit; a header such as t [s], gap/d or v says it); "
        "several stand side by side, what a header says going before these options",
    )  # fmt: skip
    group.add_argument("--case", metavar="CASE", help="a record or a shipped case, such as gondret-st152")
    group.add_argument(
        "--name", nargs="+", action="extend", metavar="NAME", help="what the trajectories are called (their files)"
    )
    group.add_argument(
        "--grid-error", type=options.number, metavar="X", default=0.0,
        help="relative error of the first apex by the solver's own grid, which the record's error is added to (0)",
    )  # fmt: skip
    group.add_argument(
        "--first-contact", type=options.number, metavar="S",
        help="time of the first contact in s, where it is better known: a contact stretched in time counts from "
        "its end",
    )  # fmt: skip
    options.add_columns(parser)
    options.add_track(parser, several=True)


def check(args: argparse.Namespace) -> None:
    """Refuse options of the one kind of scorecard beside those of the other: they would be without effect."""
    from restitution.errors import Defect, InputError

    own = ("case", "name", "first_contact", "column", *_TRACK)
    rows = ("only", "failed", "list", "resume", "strict", "baseline", "bless")
    of_rows = args.trajectory is None
    without = [name for name in (own if of_rows else rows) if getattr(args, name) not in (None, False, [])]
    if of_rows and args.grid_error:
        without.append("grid_error")
    rule = "belongs to --trajectory" if of_rows else "is of the scorecard of rows: --trajectory does not take it"
    if without:
        raise InputError(*(Defect(rule, field=f"--{name.replace('_', '-')}") for name in without))


_TRACK = ("settings", "unit", "time_unit", "fps", "pixel", "direction", "wall", "point", "particle", "sheet")
"""Options of a track (:func:`restitution.commands.options.add_track`)."""


def run(args: argparse.Namespace, folder: Path) -> int:
    """Score, print, write; exit status 0, 1 where a value is not the record's, 3 where one is lacking."""
    from restitution.errors import Defect, InputError
    from restitution.files import write_folder
    from restitution.validation import trajectory_page
    from restitution.validation.rebound import Errors
    from restitution.validation.trajectory import case_of, score
    from restitution.validation.verdict import FAILED, NOT_EVALUATED, Verdict

    if args.case is None:
        raise InputError(Defect("is needed: the record to hold it against, such as gondret-st152", field="--case"))
    if not 0 <= args.grid_error < 1:
        raise InputError(
            Defect("must be at least 0 and below 1", field="--grid-error", value=f"{args.grid_error:g}")
        )
    named = args.name or _names(args.trajectory)
    if len(named) != len(args.trajectory):
        rule = f"names {len(named)} of {len(args.trajectory)} trajectories: one each"
        raise InputError(Defect(rule, field="--name"))
    if twice := [name for name in named if named.count(name) > 1]:
        what = "--name" if args.name else "--trajectory"
        raise InputError(Defect("is given twice: they could not be told apart", field=what, value=twice[0]))
    case = case_of(args.case)
    errors = Errors(grid=args.grid_error)
    scored = [
        score(name, track, case, errors, args.first_contact, notes)
        for name, (track, notes) in zip(named, _tracks(args, case), strict=True)
    ]
    contents = trajectory_page.files(scored)
    write_folder(folder, contents)
    _show(scored)
    for name in contents:
        show(str(folder / name))
    verdict = trajectory_page.verdict_of(scored)
    return {Verdict.FAIL: FAILED, Verdict.NOT_EVALUATED: NOT_EVALUATED}.get(verdict, 0)


def _names(files: list[str]) -> list[str]:
    """What trajectories without a name are called: their files, with their folders where two are alike."""
    stems = [Path(file).stem for file in files]
    return stems if len(set(stems)) == len(stems) else [str(Path(file).with_suffix("")) for file in files]


def _tracks(args: argparse.Namespace, case: Case) -> list[tuple[Track, tuple[str, ...]]]:
    """The tracks with notes on how they were read, which is printed."""
    from restitution.errors import Defect, InputError
    from restitution.foreign import read_settings
    from restitution.validation.trajectory_file import read_trajectory

    options.check_track_columns(args.column)
    given, files, several = options.stated_by(args), args.settings or [], len(args.trajectory) > 1
    if len(files) > 1 and len(files) != len(args.trajectory):
        rule = f"names {len(files)} files for {len(args.trajectory)} trajectories: one for all, or one each"
        raise InputError(Defect(rule, field="--settings"))
    own = [read_settings(file) for file in files]
    shared = given if len(own) != 1 else given.over(own[0])
    tracks = []
    for k, file in enumerate(args.trajectory):
        if len(own) > 1:
            found = read_trajectory(file, case.conditions, own[k], shared)
        else:
            found = read_trajectory(
                file, case.conditions, None if several else shared, shared if several else None
            )
        if found.reading:
            show(f"{file}: {found.reading}")
        tracks.append((found.track, found.notes))
    return tracks


def _show(scored: list[Scored]) -> None:
    from restitution.validation.trajectory_page import rows

    names = [text for one in scored for text in (one.name, "")]
    table = [
        (str(r["label"]), str(r["record"]), *(text for cell in r["cells"] for text in _cell(cell)))
        for r in rows(scored)
    ]
    show_rows(("quantity", "record", *names), table)
    for one in scored:
        for note in one.notes:
            show(f"{one.name}: {note}")
        if one.left_open:
            show(f"{one.name}: could not be filled: {', '.join(one.left_open)}")


def _cell(cell: dict[str, str]) -> tuple[str, str]:
    off = cell["off"].replace("\N{NO-BREAK SPACE}", " ")
    return (f"{cell['value']} ({off})" if off else cell["value"], cell["verdict"])
