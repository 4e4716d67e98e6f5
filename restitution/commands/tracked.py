"""A track as ``impacts`` and ``look`` take it: their options, and how the file is read."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import options

if TYPE_CHECKING:
    from restitution.conditions import Conditions
    from restitution.foreign import ForeignTable, ForeignTrack, Settings
    from restitution.impacts import Impacts
    from restitution.tracks import Track


def add_options(parser: argparse.ArgumentParser) -> None:
    """What the numbers of a track mean, and how speeds are taken from it."""
    parser.add_argument(
        "--conditions", metavar="FILE", help="fluid and sphere in TOML (impacts --template writes one)"
    )
    parser.add_argument(
        "--speed",
        choices=("far", "contact", "window"),
        default="far",
        help="which speed of approach and rebound: of the motion outside the film (default), extrapolated to "
        "contact from all frames, or the slope over a window of frames",
    )
    parser.add_argument(
        "--frames", type=options.whole, default=2, metavar="N", help="frames of the window on each side (2)"
    )
    parser.add_argument(
        "--film", type=options.diameters, default=0.1, metavar="H", help="film thickness in diameters (0.1)"
    )
    parser.add_argument(
        "--stokes", default="st", metavar="CONVENTION", help="st (default), st_star, st_d, st_18, st_b"
    )
    parser.add_argument(
        "--sigma", type=options.number, metavar="S", help="noise of the track in its unit (default: estimated)"
    )
    options.add_columns(parser)
    options.add_track(parser)


@dataclass(frozen=True)
class Tracked:
    """A track, its conditions (None: not stated), its kind, how it was read in one line, and notes on that."""

    track: Track
    conditions: Conditions | None
    kind: str
    reading: str = ""
    notes: tuple[str, ...] = ()

    def impacts(self, args: argparse.Namespace) -> Impacts:
        """The impacts by the options; the conditions must be known."""
        from dataclasses import replace

        from restitution.doubts import of_gain, of_impacts
        from restitution.impacts import find_impacts
        from restitution.stokes import convention

        name = Path(args.track).stem
        found = find_impacts(
            self.track, self.conditions, args.speed, args.stokes, name, self.kind, args.frames, args.film
        )
        rows = found.table()
        St = rows.impact_speed_m_s * convention("st").per_speed(self.conditions)
        e_dry = self.conditions.sphere.e_dry
        doubts = of_gain(list(rows.impact), rows.e_eff, rows.e_eff_sigma, e_dry, name)
        doubts = [*found.doubts, *doubts]
        # Where St or e is doubtful already an unusual K is a consequence, and its questions lead astray.
        explained = any(doubt.name not in _OF_NEITHER for doubt in doubts)
        if self.kind == "measured" and e_dry is not None and not explained:
            sigma = None if doubts else rows.e_eff_sigma
            doubts += of_impacts(St, rows.e_eff, e_dry, [name], computed=True, sigma=sigma)
        if _DOWN in self.reading:  # then it is the other way that mends it
            doubts = [replace(d, message=d.message.replace("--direction down", "--direction up")) for d in doubts]
        return replace(found, doubts=doubts)


_OF_NEITHER = ("mistracked", "minimum", "centre", "hole")
"""Doubts that leave St and e of the impacts as they are."""
_DOWN = "growing towards the wall"
"""In the line that says how a track was read."""


def edge(args: argparse.Namespace) -> float:
    """The edge of the film in diameters."""
    from restitution.errors import Defect, InputError

    if not 0 < args.film < 10:
        raise InputError(Defect("must be between 0 and 10 diameters", field="--film", value=f"{args.film}"))
    return args.film


@dataclass(frozen=True)
class Opened:
    """What the options name, read once: a long track in plain numbers, any other ``table``, or a shipped record,
    of which neither is there.
    """

    settings: Settings
    long: ForeignTrack | None = None
    table: ForeignTable | None = None


def opened(args: argparse.Namespace) -> Opened:
    """The file that the options name; a track or a table of bounces."""
    from restitution.foreign import read_foreign
    from restitution.foreign.long_track import read_long_track

    settings = options.settings_of(args)
    if not Path(args.track).exists():
        return Opened(settings)
    if (long := read_long_track(args.track, settings)) is not None:
        return Opened(settings, long)
    return Opened(settings, table=read_foreign(args.track, settings.decimal, settings.sheet))


def read(args: argparse.Namespace, file: Opened, without_conditions: bool = False) -> Tracked:
    """The track that the options name; ``without_conditions``: they need not be stated."""
    import math

    from restitution import datasets
    from restitution.conditions import read_conditions
    from restitution.datasets.checks import fitting_schemas
    from restitution.errors import Defect, InputError
    from restitution.foreign import read_track
    from restitution.foreign.track import is_track

    edge(args)
    if args.frames < 2:
        raise InputError(Defect("must be at least 2", field="--frames", value=f"{args.frames}"))
    if args.sigma is not None and not 0 < args.sigma < math.inf:
        raise InputError(Defect("must be positive and finite", field="--sigma", value=f"{args.sigma:g}"))
    if file.long is None and file.table is None:
        if args.track not in datasets.names():
            raise InputError(Defect("does not exist, and no shipped record has this name", file=args.track))
        resource = datasets.resource(args.track)
        conditions = read_conditions(args.conditions) if args.conditions else resource.conditions
        return Tracked(datasets.load_track(args.track, args.sigma), conditions, resource.kind)
    if not args.conditions and not without_conditions:
        raise InputError(
            f"{args.track}: fluid and sphere are needed: --conditions FILE (impacts --template writes an example)"
        )
    options.check_track_columns(args.column)
    if file.table is not None and not is_track(file.table, file.settings):
        kinds = fitting_schemas(file.table.header, {})
        if len(kinds) == 1:
            rule = f"is a {kinds[0].name} table, not a track of time and gap or velocity"
            raise InputError(Defect(rule, file=args.track))
    conditions = read_conditions(args.conditions) if args.conditions else None
    found = file.long if file.table is None else read_track(file.table, file.settings, conditions)
    assert found is not None
    return Tracked(found.track(args.sigma), conditions, "measured", found.reading, found.notes)
