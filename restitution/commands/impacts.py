"""``restitution impacts``: from a camera track to impacts, St and e_eff."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import flights, options, tracked
from restitution.commands.console import show, show_doubts, show_rows

if TYPE_CHECKING:
    import pandas as pd


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
        "name of a shipped record; or a table of bounces and their times, or apexes, alone",
    )
    tracked.add_options(parser)
    options.add_strict(parser)
    flights.add_options(parser)
    parser.add_argument("--out", metavar="FILE", help="also write the impacts, as CSV")
    parser.add_argument(
        "--template", metavar="FOLDER", help="write track.csv, conditions.toml, settings.toml to start from"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> None:
    """Print the impacts of a track, and write them where asked."""
    from restitution.doubts import refuse
    from restitution.errors import InputError
    from restitution.files import write_whole
    from restitution.tables.writing import table_text

    if args.template:
        _write_template(Path(args.template))
        return
    if not args.track:
        raise InputError("name a track: a CSV file, - for a pipe, or a shipped record ('restitution data list')")
    if args.track == "-":
        args.track = "/dev/stdin"
    options.check_output("--out", args.out, filter(None, (args.track, args.conditions, args.settings)))
    opened = tracked.opened(args)
    if (bounces := flights.read(args, opened.table)) is not None:
        flights.run(args, bounces)
        return
    read = tracked.read(args, opened)
    impacts = read.impacts(args)
    if args.strict:
        refuse(replace(doubt, where=args.track) for doubt in impacts.doubts)
    table = impacts.table()
    if args.out:
        names = [f"doubt: {doubt.name}" for doubt in impacts.doubts]
        notes = table.note.map(lambda note: "; ".join(filter(None, [note, *names])))
        write_whole(args.out, table_text(table.assign(time_s=_times(table), note=notes)))
    if read.reading:
        show(f"read: {read.reading}")
    show_impacts(table, impacts.sigma, "m" if read.track.quantity == "gap" else "m/s")
    for note in (*read.notes, *impacts.notes):
        show(f"note: {note}")
    show_doubts(impacts.doubts)


_LATE = 1e2
"""Times in s from which six digits no longer tell impacts apart, as those of a computer's clock."""


def _times(table: pd.DataFrame) -> pd.Series:
    """The times to be written: of late ones all digits down to a microsecond."""
    late = not table.empty and table["time_s"].abs().max() >= _LATE
    return table["time_s"].map("{:.6f}".format) if late else table["time_s"]


def show_impacts(table: pd.DataFrame, sigma: float, unit: str) -> None:
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
        St = with_error(r.stokes, r.stokes_sigma, 1 if r.stokes > 3 else 3)
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
