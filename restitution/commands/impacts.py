"""``restitution impacts``: from a camera track to impacts, St and e_eff."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from restitution.commands import options
from restitution.commands.console import show, show_rows

if TYPE_CHECKING:
    import pandas as pd

    from restitution.conditions import Conditions
    from restitution.tracks import Track


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``impacts TRACK.csv --conditions CONDITIONS.toml``."""
    parser = commands.add_parser(
        "impacts",
        help="impact speed, St and e_eff of every bounce in a track",
        description="Print the impacts of a track (time and gap, or time and velocity), with uncertainties.",
    )
    parser.add_argument(
        "track",
        nargs="?",
        metavar="TRACK",
        help="a file of time and gap (surface to wall) or velocity (positive away from the wall, measured as "
        "such: of positions give the gaps), as a tracking program, spreadsheet or solver writes it, or the "
        "name of a shipped record",
    )
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere in TOML (see --template)")
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
        "--film", type=options.number, default=0.1, metavar="H", help="film thickness in diameters (0.1)"
    )
    parser.add_argument(
        "--stokes", default="st", metavar="CONVENTION", help="st (default), st_star, st_d, st_18, st_b"
    )
    parser.add_argument(
        "--sigma", type=options.number, metavar="S", help="noise of the track in its unit (default: estimated)"
    )
    options.add_columns(parser)
    options.add_track(parser)
    parser.add_argument("--out", metavar="FILE", help="also write the impacts, as CSV")
    parser.add_argument(
        "--template", metavar="FOLDER", help="write track.csv, conditions.toml, settings.toml to start from"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> None:
    """Print the impacts of a track, and write them where asked."""
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole
    from restitution.impacts.find import find_impacts
    from restitution.tables.writing import table_text

    if args.template:
        _write_template(Path(args.template))
        return
    if not args.track:
        raise InputError("name a track: a CSV file or a shipped record ('restitution data list')")
    for name, bad in (("--frames", args.frames < 2), ("--film", not 0 < args.film < 10)):
        if bad:
            rule = "must be at least 2" if name == "--frames" else "must be between 0 and 10 diameters"
            raise InputError(Defect(rule, field=name, value=str(getattr(args, name.removeprefix("--")))))
    if args.out is not None:
        _check_output(args)
    track, conditions, kind, said = _read(args)
    impacts = find_impacts(
        track, conditions, args.speed, args.stokes, Path(args.track).stem, kind, args.frames, args.film
    )
    table = impacts.table()
    if args.out:
        write_whole(args.out, table_text(table.assign(time_s=_times(table))))
    if said.reading:
        show(f"read: {said.reading}")
    _show(table, impacts.sigma, "m" if track.quantity == "gap" else "m/s")
    for note in (*said.notes, *impacts.notes):
        show(f"note: {note}")


def _check_output(args: argparse.Namespace) -> None:
    """Refuse an output that would replace one of the inputs, or that names no file."""
    from restitution.errors import Defect, InputError

    if not args.out:
        raise InputError(Defect("names no file", field="--out"))
    for given in (args.track, args.conditions, args.settings):
        if given and Path(given).exists() and Path(args.out).resolve() == Path(given).resolve():
            raise InputError(Defect("would replace an input", file=args.out, field="--out"))


class _Said(NamedTuple):
    """How the file was read, in one line, and notes on it."""

    reading: str = ""
    notes: tuple[str, ...] = ()


def _read(args: argparse.Namespace) -> tuple[Track, Conditions, str, _Said]:
    """The track, its conditions, its kind, and how it was read."""
    from restitution import datasets
    from restitution.conditions import read_conditions
    from restitution.datasets.checks import fitting_schemas
    from restitution.errors import Defect, InputError
    from restitution.foreign import read_foreign, read_track
    from restitution.foreign.track import columns_of

    if args.sigma is not None and not 0 < args.sigma < math.inf:
        raise InputError(Defect("must be positive and finite", field="--sigma", value=f"{args.sigma:g}"))
    if not Path(args.track).exists():
        if args.track not in datasets.names():
            raise InputError(Defect("does not exist, and no shipped record has this name", file=args.track))
        resource = datasets.resource(args.track)
        conditions = read_conditions(args.conditions) if args.conditions else resource.conditions
        return datasets.load_track(args.track, args.sigma), conditions, resource.kind, _Said()
    if not args.conditions:
        raise InputError(
            f"{args.track}: fluid and sphere are needed: --conditions FILE (--template writes an example)"
        )
    options.check_track_columns(args.column)
    settings = options.settings_of(args)
    table = read_foreign(args.track, settings.decimal)
    kinds = fitting_schemas(table.header, {})
    if columns_of(table, settings) is None and len(kinds) == 1:
        rule = f"is a {kinds[0].name} table, not a track of time and gap or velocity"
        raise InputError(Defect(rule, file=args.track))
    conditions = read_conditions(args.conditions)
    found = read_track(table, settings, conditions)
    return found.track(args.sigma), conditions, "measured", _Said(found.reading, found.notes)


_LATE = 1e2
"""Times in s from which six digits no longer tell impacts apart, as those of a computer's clock."""


def _times(table: pd.DataFrame) -> pd.Series:
    """The times to be written: of late ones all digits down to a microsecond."""
    late = not table.empty and table["time_s"].abs().max() >= _LATE
    return table["time_s"].map("{:.6f}".format) if late else table["time_s"]


def _show(table: pd.DataFrame, sigma: float, unit: str) -> None:
    """Print the impacts, one line each."""
    if table.empty:
        show(f"no impact is resolved (noise {sigma:.2g} {unit})")
        return

    def with_error(value: float, error: float, digits: int) -> str:
        return "" if math.isnan(value) else f"{value:.{digits}f} +- {error:.{digits}f}"

    rows, short = [], table["time_s"].abs().max() < _LATE
    for r in table.itertuples():
        resolved = r.outcome == "rebound"
        v_in = with_error(r.impact_speed_m_s, r.impact_speed_sigma_m_s, 4)
        v_out = with_error(r.rebound_speed_m_s, r.rebound_speed_sigma_m_s, 4)
        e = with_error(r.e_eff, r.e_eff_sigma, 3) if resolved else f"< {r.e_eff_upper:.3f}"
        St = with_error(r.stokes, r.stokes_sigma, 1)
        rows.append((str(r.impact), f"{r.time_s:.5g}" if short else f"{r.time_s:.4f}", v_in, v_out, St, e, r.note))
    first = table.iloc[0]
    show(f"speed: {first.speed_definition}, Stokes number: {first.stokes_convention}, noise: {sigma:.2g} {unit}")
    headings = ("impact", "time_s", "impact speed m/s", "rebound speed m/s", "St", "e_eff", "note")
    show_rows(headings, rows, right=("impact",))


def _write_template(folder: Path) -> None:
    from restitution import datasets
    from restitution.errors import Defect, InputError
    from restitution.files import write_folder
    from restitution.foreign.settings import TEMPLATE
    from restitution.tables.writing import table_text

    track = table_text(datasets.load("gondret2002_st152").iloc[:45], None)
    contents = {"track.csv": track, "conditions.toml": _CONDITIONS, "settings.toml": TEMPLATE}
    for name in contents:
        if (folder / name).exists():
            raise InputError(Defect("exists already; a template replaces nothing", file=str(folder / name)))
    write_folder(folder, contents)
    show(f"{folder / 'track.csv'}: a track, the first bounce of Gondret et al. 2002")
    show(f"{folder / 'conditions.toml'}: its conditions")
    show(f"{folder / 'settings.toml'}: what the numbers of your own track mean, for --settings")
    show(f"next: restitution impacts {folder / 'track.csv'} --conditions {folder / 'conditions.toml'}")


_CONDITIONS = """\
# Conditions of an experiment, in SI units, or with units: "10 mPa s", "0.935 g/cm3", "10.7 cSt", "3 mm".
source = "Gondret, Lance & Petit, Phys. Fluids 14, 643 (2002)"  # where the data come from (may be left out)
gravity = 9.81            # m/s2 (may be left out: 9.81)

[fluid]
density = 935.0           # kg/m3
viscosity = 0.010         # dynamic, Pa s

[sphere]
diameter = 3.0e-3         # m
density = 7800.0          # kg/m3
e_dry = 0.97              # restitution of the dry impact
roughness = 1.5e-7        # m (may be left out)

# [wall]                  # may be left out
# roughness = 1.0e-7      # m

# [impact]                # only for a record that begins after its first impact
# speed = 0.585           # m/s, towards the wall
# speed_sigma = 0.005     # m/s
# speed_definition = "far"
"""
