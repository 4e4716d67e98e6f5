"""Spreadsheets: as openpyxl, XlsxWriter, xlwt, odfpy write them (``books/``), as Kinovea does; hostile ones."""

import contextlib
import io
import zipfile
from pathlib import Path

import pytest

from restitution.errors import InputError
from restitution.foreign import read_foreign

BOOKS = Path(__file__).parent / "books"
TIMES, HEIGHTS = [0.0, 0.002, 0.004, 0.006], [5.0, 4.25, 2.5, 3.125]
NAMES = ["t (s)", "y (mm)"]
ROWS = list(zip(TIMES, HEIGHTS, strict=True))
_BOOK = (
    '<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" '
    'xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships">'
    '<sheets><sheet name="Run" sheetId="1" r:id="rId1"/></sheets></workbook>'
)
_MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'


def _relation(kind, target):
    """The list of one part that a part names."""
    about = f'Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/{kind}" Target="{target}"'
    names = "http://schemas.openxmlformats.org/package/2006/relationships"
    return f'<Relationships xmlns="{names}"><Relationship Id="rId1" {about}/></Relationships>'


def zipped(parts):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return stream.getvalue()


def excel(sheet="", **parts):
    """The least that is an .xlsx; column B is left out."""
    cells = "".join(f'<c r="{c}1" t="inlineStr"><is><t>{n}</t></is></c>' for c, n in zip("AC", NAMES, strict=True))
    cells = f'<row r="1">{cells}</row>'
    for n, (t, y) in enumerate(ROWS, 2):
        cells += f'<row r="{n}"><c r="A{n}"><v>{t}</v></c><c r="C{n}"><v>{y}</v></c></row>'
    return zipped(
        {
            "_rels/.rels": _relation("officeDocument", "xl/workbook.xml"),
            "xl/workbook.xml": _BOOK,
            "xl/_rels/workbook.xml.rels": _relation("worksheet", "worksheets/sheet1.xml"),
            "xl/worksheets/sheet1.xml": f"<worksheet {_MAIN}><sheetData>{sheet or cells}</sheetData></worksheet>",
            **parts,
        }
    )


def kinovea(sheets=1):
    """The XML of Excel 2003: a title over both columns, then names."""
    rows = '<Row><Cell ss:MergeAcross="1"><Data ss:Type="String">Trajectory 1</Data></Cell></Row>'
    for pair in [NAMES, *ROWS]:
        rows += "<Row>" + "".join(f"<Cell><Data>{x}</Data></Cell>" for x in pair) + "</Row>"
    name = '"urn:schemas-microsoft-com:office:spreadsheet"'
    sheet = f"<Worksheet><Table>{rows}</Table></Worksheet>"
    kind = f"xmlns={name} xmlns:ss={name}"
    return f'<?xml version="1.0"?><Workbook {kind}>{sheets * sheet}</Workbook>'.encode()


def read(tmp_path, data):
    (tmp_path / "book").write_bytes(data)
    return read_foreign(tmp_path / "book")


def refused(tmp_path, data):
    with pytest.raises(InputError) as error:
        read(tmp_path, data)
    assert len(error.value.defects) == 1
    return error.value.defects[0].rule


def numbers(table):
    return [[float(cell) for cell in cells] for _, cells in table.rows]


@pytest.mark.parametrize("name", ["xlsxwriter.xlsx", "xlwt.xls", "odfpy.ods", "least", "kinovea"])
def test_a_spreadsheet_is_its_table(tmp_path, name):
    """Values of formulas, texts with decimal commas, all digits where fewer are shown, rows and cells repeated."""
    own = {"least": excel, "kinovea": kinovea}
    table = read(tmp_path, own[name]() if name in own else (BOOKS / name).read_bytes())
    assert (table.header, table.units) == (NAMES, {"t (s)": "s", "y (mm)": "mm"})
    assert numbers(table) == [list(row) for row in ROWS]


def test_a_sheet_of_a_laboratory(tmp_path):
    """A merged title, names and units below an empty row, an empty first column, a percentage, a clock, a larger
    sheet that is hidden. Lines are rows of the sheet, which is named.
    """
    table = read_foreign(BOOKS / "openpyxl.xlsx")
    assert table.header == ["time", "height", "filled", "clock"]
    assert {"time": "s", "height": "mm", "clock": "s"}.items() <= table.units.items()
    assert "Run 7" in table.form
    assert "of 3" in table.form
    assert [line for line, _ in table.rows] == [5, 6, 7, 8]
    found = numbers(table)
    assert [row[:2] for row in found] == [list(row) for row in ROWS]
    assert [row[2] for row in found] == pytest.approx([y / 10 for y in HEIGHTS])
    # Ten thousand frames a second; a day in days has 0.6 us.
    assert [row[3] - found[0][3] for row in found] == pytest.approx([0, 1e-4, 2e-4, 3e-4], abs=2e-6)


def _two_runs(least):
    """Two sheets with a table, the second one's heights turned over, and a third with some numbers, or none."""

    def rows(sign):
        return "".join(f"<Row><Cell>{t}</Cell><Cell>{sign * y}</Cell></Row>" for t, y in ROWS)

    name = '"urn:schemas-microsoft-com:office:spreadsheet"'
    head = "".join(f"<Cell>{name}</Cell>" for name in NAMES)
    sheets = {
        "Run 1": rows(1),
        "Run 2": rows(-1) if least else "",
        "Notes": "<Row><Cell>1</Cell><Cell>2</Cell></Row>",
    }
    body = "".join(
        f'<Worksheet ss:Name="{n}"><Table><Row>{head}</Row>{own}</Table></Worksheet>' for n, own in sheets.items()
    )
    return f'<?xml version="1.0"?><Workbook xmlns={name} xmlns:ss={name}>{body}</Workbook>'.encode()


@pytest.mark.parametrize("write", ["openpyxl", "xml"])
def test_of_several_sheets_with_a_table_one_is_asked_for(tmp_path, write):
    data = (BOOKS / "runs.xlsx").read_bytes() if write == "openpyxl" else _two_runs(True)
    rule = refused(tmp_path, data)
    assert "--sheet" in rule
    assert "Run 1 (4 rows), Run 2 (4 rows)" in rule
    for sheet, sign in (("Run 1", 1), ("Run 2", -1)):
        (tmp_path / "book").write_bytes(data)
        found = numbers(read_foreign(tmp_path / "book", sheet=sheet))
        assert found == [[t, sign * y] for t, y in ROWS]
    with pytest.raises(InputError, match="Run 3") as error:
        read_foreign(tmp_path / "book", sheet="Run 3")
    assert "Run 1" in error.value.defects[0].rule


def test_one_sheet_with_a_table_among_others_is_taken_and_named(tmp_path):
    table = read(tmp_path, _two_runs(False))
    assert numbers(table) == [list(row) for row in ROWS]
    assert "Run 1" in table.form


def test_a_sheet_of_what_has_none_is_refused(tmp_path):
    (tmp_path / "track.csv").write_text("t,y\n0,1\n1,2\n")
    with pytest.raises(InputError, match="no spreadsheet"):
        read_foreign(tmp_path / "track.csv", sheet="Run 1")


@pytest.mark.parametrize(
    ("data", "why"),
    [
        ((BOOKS / "password.xlsx").read_bytes(), "password"),
        ((BOOKS / "formulas.xlsx").read_bytes(), "formulas"),
        ((BOOKS / "xlwt.xls").read_bytes()[:3000], "whole"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(2000), "whole"),
        (excel("<row><c>"), "read as one"),
        (excel(" "), "without a table"),
        (zipped({"content.xml": "<text/>"}), "read as one"),
        (excel("<!DOCTYPE a [<!ENTITY b 'c'>]>"), ""),
        (excel()[:-30], "archive"),
        (zipped({"notes.txt": "nothing"}), "archive"),
        (kinovea()[:400], "whole"),
        (kinovea().replace(b"<Workbook", b'<!DOCTYPE a [<!ENTITY b "c">]><Workbook', 1), "read as one"),
    ],
)
def test_a_spreadsheet_that_is_none_is_one_line(tmp_path, data, why):
    assert why in refused(tmp_path, data)


def _claims_less(data):
    """The sheet's size as the archive has it in its list, made small: what is in it is as large as it was."""
    at = data.rindex(b"PK\x01\x02")
    return data[: at + 24] + (2000).to_bytes(4, "little") + data[at + 28 :]


FAR = '<row r="1"><c r="A1"><v>1</v></c></row><row r="1048576"><c r="XFD1048576"><v>2</v></c></row>'


@pytest.mark.parametrize(
    "data",
    [
        excel(FAR),
        excel(" " * (2**28 + 1)),
        _claims_less(excel("<row><c><v>1</v></c></row>" * 2**22)),
    ],
    ids=["two cells far apart", "more than is read", "more than it says"],
)
def test_a_spreadsheet_that_unfolds_beyond_memory_is_one_line(tmp_path, data):
    assert len(data) < 2**21
    assert refused(tmp_path, data)


def test_cells_beyond_all_columns_are_left_out(tmp_path):
    far = '<row r="{n}"><c r="A{n}"><v>{n}</v></c><c r="B{n}"><v>2</v></c><c r="ZZZ{n}"><v>1</v></c></row>'
    assert len(read(tmp_path, excel("".join(far.format(n=n) for n in range(1, 5)))).header) == 2


@pytest.mark.parametrize("name", ["xlsxwriter.xlsx", "xlwt.xls", "odfpy.ods", "kinovea"])
def test_damage_is_an_error_of_the_input(tmp_path, name):
    """A piece taken out anywhere: a table, or one that cannot be read, no other error."""
    data = kinovea() if name == "kinovea" else (BOOKS / name).read_bytes()
    for at in range(0, len(data) - 20, len(data) // 12):
        with contextlib.suppress(InputError):
            read(tmp_path, data[:at] + data[at + 11 :])
