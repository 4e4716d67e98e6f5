"""An example to start from: a table of impacts with every column explained."""

from __future__ import annotations

from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.files import write_folder

NAMES = ("impacts.csv", "columns.txt")
_COLUMNS = (
    "source",
    "material",
    "speed_definition",
    "stokes_convention",
    "stokes",
    "stokes_sigma",
    "e_dry",
    "e_eff",
    "e_eff_sigma",
    "outcome",
    "e_eff_upper",
    "note",
)
# Values as a table of measurements would have them; made up, as the note of each row says.
_ROWS = (
    ("lab A", "steel", "far", "st", "152", "3", "0.97", "0.78", "0.02", "rebound", "", "made up"),
    ("lab A", "steel", "far", "st", "80", "2", "0.97", "0.63", "0.02", "rebound", "", "made up"),
    ("lab A", "steel", "far", "st", "45", "1", "0.97", "0.47", "0.03", "rebound", "", "made up"),
    ("lab B", "steel", "far", "st", "27", "1", "0.97", "0.29", "0.02", "rebound", "", "made up"),
    ("lab B", "steel", "far", "st", "300", "6", "0.97", "0.86", "0.01", "rebound", "", "made up"),
    ("lab B", "steel", "far", "st", "9", "0.5", "0.97", "", "", "no_rebound", "0.05", "made up: less than 0.05"),
)


def template() -> dict[str, str]:
    """The files by name: the table, and what each column means."""
    from restitution.calibration.reading.impact_table import SCHEMA
    from restitution.tables.schema import read_schema

    table = "\n".join(",".join(row) for row in (_COLUMNS, *_ROWS)) + "\n"
    lines = [
        "Columns of a table of impacts for 'restitution fit'. Replace the rows of impacts.csv by your own.",
        "Leave out what you do not have: needed are e_eff (or both speeds, or an outcome without rebound), and",
        "stokes (or the impact speed with fluid and sphere), with their conventions stated once or in columns.",
        "",
    ]
    for f in read_schema(SCHEMA).fields:
        unit = f" [{f.unit}]" if f.unit not in ("", "1") else ""
        values = f" One of: {', '.join(f.constraints.enum)}." if f.constraints.enum else ""
        lines.append(f"{f.name}{unit}: {f.description}{values}")
    return {"impacts.csv": table, "columns.txt": "\n".join(lines) + "\n"}


def write_template(folder: Path) -> list[str]:
    """Write the example; refuses to replace a file. Returns what to tell the user."""
    for name in NAMES:
        if (folder / name).exists():
            raise InputError(Defect("exists already; a template replaces nothing", file=str(folder / name)))
    write_folder(folder, template())
    return [
        f"{folder / 'impacts.csv'}: a table of impacts to replace by your own",
        f"{folder / 'columns.txt'}: what each column means",
        f"next: restitution fit {folder / 'impacts.csv'} --law eq4_exponential --out {folder / 'fit.json'}",
    ]
