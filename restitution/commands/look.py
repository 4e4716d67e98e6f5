"""``restitution look``: a picture of a track, its contacts, and what was read of them."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from restitution.commands import flights, options, tracked
from restitution.commands.console import show, show_doubts
from restitution.commands.impacts import show_impacts


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``look TRACK``."""
    parser = commands.add_parser(
        "look",
        help="a picture of a track with its contacts, flights and what was read of them",
        description="Draw a track as it is read, with its contacts, the flights between them, and what approach "
        "and rebound were read as; open it in the browser where there is one.",
    )
    parser.add_argument("track", metavar="TRACK", help="a track as impacts takes it, or a shipped record")
    tracked.add_options(parser)
    parser.add_argument(
        "--out",
        metavar="PLACE",
        help="where to write: a file .svg, .png or .html (a page with impacts, flights and notes), or a folder "
        "for all of them; by default a page in a new temporary folder",
    )
    parser.add_argument("--no-open", action="store_true", help="do not open it in the browser")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> None:
    """Say how the track was read, write its picture, and open it."""
    import tempfile

    from restitution.doubts import of_record
    from restitution.errors import Defect, InputError
    from restitution.files import check_folder, write_folder, write_whole
    from restitution.report.look import Told, pages, view_of

    suffix = Path(args.out).suffix.lower() if args.out else ""
    if suffix in _FILES or args.out == "":
        options.check_output("--out", args.out, filter(None, (args.track, args.conditions, args.settings)))
    elif args.out:
        check_folder(args.out)
    file = tracked.opened(args)
    if flights.read(args, file.table) is not None:
        rule = "has bounces alone, no track to look at: restitution impacts takes it"
        raise InputError(Defect(rule, file=args.track))
    read = tracked.read(args, file, without_conditions=True)
    impacts, notes, doubts = None, [*read.notes], of_record(read.track, None)
    if read.conditions is None:
        notes.append("fluid and sphere are not stated (--conditions FILE): no speeds, no St, no e_eff")
    else:
        try:
            impacts = read.impacts(args)
            notes += impacts.notes
            doubts = impacts.doubts
        except InputError as error:  # a look is wanted most where impacts cannot be had
            notes += [str(defect) for defect in error.defects]
    view = view_of(read.track, read.conditions, impacts)
    table = None if impacts is None else impacts.table()
    told = Told(Path(args.track).name, read.reading, notes, [doubt.message for doubt in doubts])
    contents = pages(view, told, table)
    if read.reading:
        show(f"read: {read.reading}")
    if table is not None:
        show_impacts(table, impacts.sigma, "m" if read.track.quantity == "gap" else "m/s")
    for note in notes:
        show(f"note: {note}")
    show_doubts(doubts)
    if suffix in _FILES:
        place = Path(args.out)
        write_whole(place, contents[_FILES[suffix]])
        written = [place]
    else:
        folder = Path(args.out or tempfile.mkdtemp(prefix="restitution-look-"))
        write_folder(folder, contents)
        written = [folder / name for name in contents]
    for place in written:
        show(str(place))
    if not args.no_open and _has_browser():
        import webbrowser

        webbrowser.open(written[-1].resolve().as_uri())


_FILES = {".svg": "figure.svg", ".png": "figure.png", ".html": "index.html"}
"""What is written into a file of that ending; anything else is a folder."""


def _has_browser() -> bool:
    """Whether somebody sits before a screen: the output is a terminal, and there is a display."""
    if sys.stdout is None or not sys.stdout.isatty():
        return False
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(display) or sys.platform in ("darwin", "win32")
