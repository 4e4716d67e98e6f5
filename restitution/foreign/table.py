"""Any table of numbers as the strict reader takes it: names, plain cells by line, what the file says of itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.foreign import programs
from restitution.foreign.file_text import lines_of, mistaken
from restitution.foreign.formats import digitised, hdf5, json_table, kinds, markup, openptv, stopwatch
from restitution.foreign.formats.spots import Read, Spots
from restitution.foreign.heading import Heading, data_rows, heading_of, unit_in, without_unit
from restitution.foreign.layout import SEPARATORS, Layout, Row, layout_of, vectors_apart
from restitution.foreign.number_text import Decimal, decimal_of, is_lost, plain, seconds
from restitution.foreign.programs import Program
from restitution.foreign.sections import Section, sections
from restitution.inputs import lists_only, read_bytes
from restitution.tables.csv_text import CsvText

ROW = "row"
"""A column that every table has, unless the file has its own: which row of data it is, from 0."""
_MOST_NAMED = 20
"""Particles that a message names."""


@dataclass
class ForeignTable:
    """Cells of a file by line, numbers in them plain; ``units`` are those that the file states, by name."""

    file: str
    header: list[str]
    rows: list[tuple[int, list[str]]]
    units: dict[str, str] = field(default_factory=dict)
    program: Program | None = None
    named: bool = True
    """Whether the file names its columns; else they are called by their number."""
    form: str = ""
    """How it is written, in words, where that is not names and commas."""
    sections: dict[str, Callable[[], ForeignTable]] = field(default_factory=dict)
    """The tables that stand one below another in the file, by name; what is above is then the first."""
    section_rows: dict[str, int] = field(default_factory=dict)

    def text(self) -> CsvText:
        """For the strict reader."""
        return CsvText(self.file, self.header, self.rows)

    def column(self, name: str) -> str | None:
        """The column of that name, in whatever case, of the only track, or of that number; None if none is."""
        exact, lower, bare, last = self._names
        joined = () if self.program is None else (self.program.renamed(name),)  # as the file itself has it
        for known in (name, *joined, *mistaken(name)):
            low = known.lower()
            for fits in (exact.get(known, ()), lower.get(low, ()), bare.get(low, ()), last.get(low, ())):
                if len(fits) == 1:
                    return fits[0]
        return self.header[int(name) - 1] if name.isdecimal() and 0 < int(name) <= len(self.header) else None

    @cached_property
    def _names(self) -> tuple[dict[str, list[str]], ...]:
        """The columns by their names: as they are, in lower case, without unit, and without the track besides.

        Hundreds of names are looked up, and a hostile file has as many columns as it likes.
        """
        found: tuple[dict[str, list[str]], ...] = ({}, {}, {}, {})
        for own in self.header:
            bare = without_unit(own).lower()
            for names, name in zip(found, (own, own.lower(), bare, bare.rpartition("/")[2]), strict=True):
                names.setdefault(name, []).append(own)
        return found

    @property
    def particle_column(self) -> str | None:
        """The column that tells particles apart, if there is one."""
        if self.program is not None and self.program.particle:
            return self.column(self.program.particle)
        for name in programs.PARTICLES:
            own = self.column(name)
            if own is not None and "/" not in own:
                cells = [cells[self.header.index(own)] for _, cells in self.rows]
                if len(set(cells)) <= len(cells) / 4:
                    return own
        return None

    def particles(self) -> dict[str, int]:
        """Particles or tracks by name, with the number of their rows."""
        if self.sections:
            return self.section_rows
        own = self.particle_column
        if own is not None:
            k, count = self.header.index(own), dict[str, int]()
            for _, cells in self.rows:
                if name := _bare(cells[k]):  # what is linked to no track is none
                    count[name] = count.get(name, 0) + 1
            return count
        tracks = [
            name.rpartition("/")[0] for name in self.header if name.rpartition("/")[2].lower() in ("x", "y", "z")
        ]
        return {track: len(self.rows) for track in dict.fromkeys(tracks) if track}

    def with_rows(self) -> ForeignTable:
        """The same with the column of that name."""
        rows = [(line, [f"{n}", *cells]) for n, (line, cells) in enumerate(self.rows)]
        return ForeignTable(
            self.file, [ROW, *self.header], rows, {ROW: "frame", **self.units}, self.program, self.named, self.form
        )

    def of_particle(self, particle: str | None) -> ForeignTable:
        """One of them; raises :class:`InputError` with the list of what there is where it is not clear which."""
        known = self.particles()
        if particle is None and len(known) <= 1:
            own = self.particle_column
            if own is None or self.sections or not known:
                return self
            k, (only,) = self.header.index(own), known
            return replace(self, rows=[row for row in self.rows if _bare(row[1][k]) == only])
        if particle not in known:
            names = [f"{name} ({n} rows)" for name, n in list(known.items())[:_MOST_NAMED]]
            more = f" and {len(known) - _MOST_NAMED} more" if len(known) > _MOST_NAMED else ""
            which = "has several particles, tracks or curves" if known else "names no particles"
            rule = f"{which}; --particle takes one of: {', '.join(names)}{more}" if known else which
            raise InputError(
                Defect(rule, file=self.file, field="--particle" if particle else None, value=particle)
            )
        if self.sections:
            return self.sections[particle]()
        own = self.particle_column
        if own is None:
            keep = [i for i, name in enumerate(self.header) if name.rpartition("/")[0] in ("", particle)]
            header = [self.header[i] for i in keep]
            rows = [(line, [cells[i] for i in keep]) for line, cells in self.rows]
            return ForeignTable(self.file, header, rows, self.units, self.program, self.named, self.form)
        k = self.header.index(own)
        rows = [(line, cells) for line, cells in self.rows if _bare(cells[k]) == particle]
        return ForeignTable(self.file, self.header, rows, self.units, self.program, self.named, self.form)

    def whole(self) -> ForeignTable:
        """All rows of tables one below another under the same names, as of a table of impacts."""
        tables = [table() for table in self.sections.values()] or [self]
        if any(table.header != self.header for table in tables):
            return self.of_particle(None)
        return replace(self, rows=[row for table in tables for row in table.rows], sections={})


@lists_only()
def read_foreign(path: str | Path, decimal: Decimal | None = None, sheet: str | None = None) -> ForeignTable:
    """The table of numbers in a file, however it is written.

    Parameters
    ----------
    path : a table of text: commas, semicolons, tabs or spaces between columns; dumps, logs and XML of programs.
    decimal : the decimal sign, where the numbers leave it open.
    sheet : the name of the sheet of a spreadsheet, where several have a table.

    Raises
    ------
    InputError : where it is no such table, or what its numbers are is not clear, with the row and what would help.
    """
    file = str(path)
    if openptv.is_frame(path):
        return _of_blocks(file, openptv.trajectories(path), programs.OPENPTV)
    if hdf5.is_hdf5(data := read_bytes(path)):
        return _of_spots(file, hdf5.spots(data, file))
    if digitised.is_project(path):
        return _of_curves(path)
    text, kept = kinds.text_in(data, file, sheet)
    if (stripped := text.strip())[:1] == "{" or (
        stripped[:1] == "[" and stripped[-1:] == "]"
    ):  # a unit may begin it
        text, kept = json_table.text_of_json(text.encode(), file), "JSON"
    if markup.is_markup(text):
        return _of_spots(file, markup.spots(text, file))
    lines = lines_of(text, file)
    for known, read, program in kinds.BLOCKS:
        if known(lines):
            return _of_blocks(file, read(lines, file), program)
    layout = layout_of(lines, file, decimal, kept=kept)
    parts = sections(layout)
    if len(parts) < 2:
        return _of_layout(parts[0].layout(layout) if parts else layout)
    apart = {part.name: partial(_of_section, part, layout) for part in parts}
    return replace(apart[parts[0].name](), sections=apart, section_rows={part.name: part.rows for part in parts})


def _of_section(part: Section, layout: Layout) -> ForeignTable:
    return _of_layout(part.layout(layout))


def _of_layout(layout: Layout) -> ForeignTable:
    """The table in lines that are cut into rows."""
    file, heading = layout.file, heading_of(layout)
    program = _program(layout, heading)
    if program is not None:
        heading.names = {i: program.renamed(name) for i, name in heading.names.items()}
    names = list(heading.names.values())
    rows = _rows(data_rows(layout, heading), list(heading.names), layout, file)
    names, rows = vectors_apart(names, rows)
    units = {heading.names[i]: unit for i, unit in heading.units.items() if i in heading.names}
    clocks = [
        i for i in heading.names if (first := data_rows(layout, heading)[:1]) and seconds(_cell(first[0], i))
    ]
    units |= {heading.names[i]: "s" for i in clocks}
    if stopwatch.is_stopwatch(names):
        names, rows = stopwatch.bounces(names, rows, file)
        return ForeignTable(file, names, rows, {names[1]: "s"}, form="phyphox")
    if program is not None and program.counted and program.time is not None:
        names, rows = [program.time, *names], [(line, [f"{n}", *cells]) for n, (line, cells) in enumerate(rows)]
    return ForeignTable(file, names, rows, units, program, heading.line is not None, _form(layout, heading))


def _cell(row: Row, column: int) -> str:
    return row.cells[column] if column < len(row.cells) else ""


def _program(layout: Layout, heading: Heading) -> Program | None:
    """The program that wrote the file, by the names of the columns or what stands above them."""
    names = list(heading.names.values())
    if (program := programs.program_of(names)) is not None:
        return program
    titles = [row.cells for row in layout.rows[: heading.first_row] if row.line < (heading.line or 0)]
    if programs.is_tracker(names, titles, [text for _, text in layout.comments]):
        return programs.TRACKER
    if layout.lines[0].startswith("Vernier Format"):
        return programs.VERNIER_TEXT
    return programs.OPENFOAM if layout.vectors else None


def _of_spots(file: str, found: Spots) -> ForeignTable:
    rows = [(row.line, row.cells) for row in found.rows]
    form = found.program.name if found.program is not None else "HDF5"
    units = {name: unit for name in found.names if (unit := unit_in(name))} | found.units
    return ForeignTable(file, found.names, rows, units, found.program, form=form)


def _of_curves(path: str | Path) -> ForeignTable:
    """The curves of a digitised plot, each by x, for clicks come in any order."""

    def table(curve: digitised.Curve) -> ForeignTable:
        pairs = sorted(zip(curve.x.tolist(), curve.y.tolist(), strict=True))
        rows = [(n, [repr(x), repr(y)]) for n, (x, y) in enumerate(pairs, 1)]
        program = programs.WEBPLOTDIGITIZER
        return ForeignTable(str(path), ["x", "y"], rows, program=program, form=program.name)

    curves = {curve.name: curve for curve in digitised.curves(path) if len(curve.x)}
    tables = {name: partial(table, curve) for name, curve in curves.items()}
    first = next(iter(tables.values()))()
    if len(tables) == 1:
        return first
    return replace(first, sections=dict(tables), section_rows={name: len(c.x) for name, c in curves.items()})


def _of_blocks(file: str, read: Read, program: Program) -> ForeignTable:
    names, rows, units = read
    decimal = decimal_of(cell for row in rows for cell in row.cells[1:])[0] or "."
    cut = [row for row in rows if len(row.cells) != len(names)]
    if cut:
        rule = f"has {len(cut[0].cells)} values where {len(names)} are named"
        raise InputError(Defect(rule, file=file, row=cut[0].line))
    plain_rows = [(row.line, [plain(cell, decimal) for cell in row.cells]) for row in rows]
    units = {name: unit for name in names if (unit := unit_in(name))} | units
    return ForeignTable(file, names, plain_rows, units, program, form=program.name)


def _rows(rows: list[Row], columns: list[int], layout: Layout, file: str) -> list[tuple[int, list[str]]]:
    """The cells of the named columns; rows of another width are left for the strict reader to name."""
    end = len(rows)
    while end and not any(rows[end - 1].cells):
        end -= 1
    every = columns == list(range(layout.width))
    result = []
    for line, cells in rows[:end]:
        if len(cells) > layout.width and not any(cells[layout.width :]):
            cells = cells[: layout.width]
        if len(cells) < layout.width and all(map(is_lost, cells)):
            cells = [""] * layout.width  # a frame in which nothing was found
        if len(cells) == layout.width and not every:
            cells = [cells[i] for i in columns]
        result.append((line, cells))
    changed = {cell: text for cell in layout.odd if (text := plain(cell, layout.decimal)) != cell}
    if not changed:
        return result
    return [(line, [changed.get(cell, cell) for cell in cells]) for line, cells in result]


def _form(layout: Layout, heading: Heading) -> str:
    """How the file is written, where it is not as the project's own tables are."""
    words = []
    if layout.kept:
        words.append(layout.kept)
    elif layout.separator != ",":
        words.append("columns separated by " + SEPARATORS[layout.separator])
    if layout.decimal == ",":
        words.append("decimal commas")
    if heading.line is not None and (heading.line > 1 or heading.commented):
        words.append(f"names in line {heading.line}")
    return ", ".join(words)


def _bare(cell: str) -> str:
    """A particle's name: 3.0 is 3."""
    text = cell.strip()
    return text.removesuffix(".0") if text.removesuffix(".0").isdigit() else text
