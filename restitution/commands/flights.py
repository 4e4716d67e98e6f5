"""``restitution impacts`` of a table of bounces: times of contact, or apexes, in place of a track."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import options, tracked
from restitution.commands.console import show, show_doubts, show_rows

if TYPE_CHECKING:
    from restitution.flights import FlightImpacts, Flights
    from restitution.foreign import ForeignTable

_COLUMNS = ("bounce", "time_s", "apex_m", "sigma")


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of such a table alone."""
    parser.add_argument(
        "--no-drag",
        action="store_true",
        help="of a table of bounces (bounce and time_s, or bounce and apex_m): take flights without drag, "
        "e = T(n+1)/T(n)",
    )


def read(args: argparse.Namespace, table: ForeignTable | None) -> Flights | None:
    """The bounces in the file, which is read as ``table``; None where it is no table of them."""
    from restitution.conditions import read_conditions
    from restitution.errors import Defect, InputError
    from restitution.flights.table import is_flights, read_flights

    names = {name: own for name, own in args.column if name in _COLUMNS}
    if table is None:
        return None
    settings = options.settings_of(args)
    if not is_flights(table, names):
        if names.keys() & {"bounce", "apex_m"}:
            rule = f"is no table of bounces by these names: the header names {', '.join(table.header)}"
            raise InputError(Defect(rule, file=args.track, field="--column"))
        return None
    if args.sigma is not None and not 0 < args.sigma < math.inf:
        raise InputError(Defect("must be positive and finite", field="--sigma", value=f"{args.sigma:g}"))
    conditions = read_conditions(args.conditions) if args.conditions else None
    if table.sections:
        table = table.of_particle(None if settings.particle is None else str(settings.particle))
    return read_flights(table, names, settings, conditions, args.sigma)


def run(args: argparse.Namespace, flights: Flights) -> None:
    """Print the impacts between the flights, and write them where asked."""
    from restitution.conditions import read_conditions
    from restitution.doubts import refuse
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole
    from restitution.flights import impacts_of
    from restitution.tables.writing import table_text

    conditions = read_conditions(args.conditions) if args.conditions else None
    if args.out and conditions is None:
        rule = "St and e_dry are needed in a table of impacts: --conditions FILE"
        raise InputError(Defect(rule, file=args.out, field="--out"))
    name = Path(args.track).stem
    impacts = impacts_of(flights, conditions, not args.no_drag, args.stokes, name, tracked.edge(args))
    if args.strict:
        refuse(replace(doubt, where=args.track) for doubt in impacts.doubts)
    if args.out:
        write_whole(args.out, table_text(impacts.table()))
    show(f"read: {flights.reading}")
    by_drag = conditions is not None and not args.no_drag
    _show(impacts, by_drag)
    if conditions is None:
        show("note: fluid and sphere are not stated (--conditions FILE): no drag, no buoyancy, no St")
    for note in impacts.notes:
        show(f"note: {note}")
    show_doubts(impacts.doubts)


def _show(impacts: FlightImpacts, by_drag: bool) -> None:
    """Print the impacts, one line each; beside those with drag what flights without it say."""

    def with_error(value: float, error: float, digits: int) -> str:
        if math.isnan(value):
            return ""
        return f"{value:.{digits}f}" + ("" if math.isnan(error) else f" +- {error:.{digits}f}")

    rows = []
    for r, e_free, (low, high) in zip(impacts.rows, impacts.free, impacts.forces, strict=True):
        rows.append(
            (
                str(r["impact"]),
                with_error(r["impact_speed_m_s"], r["impact_speed_sigma_m_s"], 4),
                with_error(r["rebound_speed_m_s"], r["rebound_speed_sigma_m_s"], 4),
                with_error(r.get("stokes", math.nan), r.get("stokes_sigma", math.nan), 1),
                with_error(r["e_eff"], r["e_eff_sigma"], 3),
                *([f"{low:.3f} to {high:.3f}", f"{e_free:.3f}"] if by_drag else []),
            )
        )
    how = (
        "point particle with drag and added mass, with and without history force, wake and the wall's resistance"
        if by_drag
        else "in the limit of no drag"
    )
    show(f"speed: far, {how}")
    headings = ("impact", "impact speed m/s", "rebound speed m/s", "St", "e_eff")
    show_rows((*headings, *(["e by forces", "e without drag"] if by_drag else [])), rows, right=("impact",))
