"""How files that are no text of columns are known: what has text in it, and texts of many small tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.foreign import programs
from restitution.foreign.file_text import lines_of, text_of
from restitution.foreign.formats import arrays, blocks, workbook, zones
from restitution.foreign.formats.spots import Read
from restitution.foreign.programs import Program
from restitution.inputs import read_bytes

BLOCKS: tuple[tuple[Callable[[list[str]], bool], Callable[[list[str], str], Read], Program], ...] = (
    (blocks.is_lammps, blocks.lammps, programs.LAMMPS),
    (blocks.is_kinovea, blocks.kinovea, programs.KINOVEA_TEXT),
    (blocks.is_mtrackj, blocks.mtrackj, programs.MTRACKJ),
    (blocks.is_lammps_log, blocks.lammps_log, programs.LAMMPS_LOG),
    (blocks.is_openfoam_log, blocks.openfoam_log, programs.OPENFOAM),
    (zones.is_tecplot, zones.tecplot, programs.TECPLOT),
    (zones.is_grace, zones.grace, programs.GRACE),
    (zones.is_fluent, zones.fluent, programs.FLUENT),
    (zones.is_labview, zones.labview, programs.LABVIEW),
)
"""How a text of many small tables is known, what it holds, whose it is."""


def text_in(data: bytes, file: str, sheet: str | None = None) -> tuple[str, str]:
    """The text in the bytes of a file, written out where they are an array or a spreadsheet, whose ``sheet`` may
    be named; how they keep it.
    """
    if workbook.is_workbook(data):
        return workbook.text_of_sheet(data, file, sheet)
    if sheet is not None:
        raise InputError(
            Defect("is no spreadsheet, so that it has no sheets", file=file, field="--sheet", value=sheet)
        )
    if arrays.is_array(data):
        return arrays.text_of_array(data, file), "an array"
    return text_of(data, file), ""


def read_lines(path: str | Path, sheet: str | None = None) -> list[str]:
    """The lines of a table without their ends; raises :class:`InputError` where it is none."""
    return lines_of(text_in(read_bytes(path), str(path), sheet)[0], str(path))
