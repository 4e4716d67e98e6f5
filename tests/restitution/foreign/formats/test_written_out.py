"""What is written out as text before it is read: spreadsheets of three kinds, arrays of NumPy, MATLAB and JSON."""

import contextlib
import io
import json
import zipfile

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from restitution.errors import InputError
from restitution.foreign import read_foreign

TIMES, HEIGHTS = [0.0, 0.002, 0.004, 0.006], [5.0, 4.25, 2.5, 3.125]
NAMES = ["t (s)", "y (mm)"]
ROWS = list(zip(TIMES, HEIGHTS, strict=True))


def zipped(**parts):
    """A zip archive of parts, whose names have __ for / and _xml for .xml."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name.replace("__", "/").replace("_xml", ".xml"), text)
    return stream.getvalue()


def excel(sheet=""):
    """Names among the shared texts, one of them in two runs; numbers as they are; a column left out between."""
    shared = "<sst><si><t>t (s)</t></si><si><r><t>y </t></r><r><t>(mm)</t></r></si></sst>"
    cells = '<row r="1"><c r="A1" t="s"><v>0</v></c><c r="C1" t="s"><v>1</v></c></row>'
    for n, (t, y) in enumerate(ROWS, 2):
        cells += f'<row r="{n}"><c r="A{n}"><v>{t}</v></c><c r="C{n}"><v>{y}</v></c></row>'
    return zipped(
        xl__sharedStrings_xml=shared,
        xl__worksheets__sheet1_xml=f"<worksheet><sheetData>{sheet or cells}</sheetData></worksheet>",
        xl__worksheets__sheet2_xml="<worksheet><sheetData/></worksheet>",
    )


def libre_office():
    """As many empty cells as there are columns at the end of a row; shown with fewer digits than there are."""
    rows = "".join(f"<table:table-cell><text:p>{name}</text:p></table:table-cell>" for name in NAMES)
    rows = f"<table:table-row>{rows}</table:table-row>"
    for pair in ROWS:
        cells = "".join(
            f'<table:table-cell office:value="{x}"><text:p>{x:.1f}</text:p></table:table-cell>' for x in pair
        )
        empty = '<table:table-cell table:number-columns-repeated="16382"/>'
        rows += f"<table:table-row>{cells}{empty}</table:table-row>"
    table = f'<table:table table:name="Run">{rows}</table:table>'
    spaces = 'xmlns:office="o" xmlns:table="t" xmlns:text="x"'
    return zipped(mimetype="x", content_xml=f"<office:d {spaces}>{table}</office:d>")


def kinovea():
    """The XML of Excel 2003: a title over both columns, then names."""
    rows = '<Row><Cell ss:MergeAcross="1"><Data ss:Type="String">Trajectory 1</Data></Cell></Row>'
    for pair in [NAMES, *ROWS]:
        rows += "<Row>" + "".join(f"<Cell><Data>{x}</Data></Cell>" for x in pair) + "</Row>"
    name = '"urn:schemas-microsoft-com:office:spreadsheet"'
    kind = f"xmlns={name} xmlns:ss={name}"
    return (
        f'<?xml version="1.0"?><Workbook {kind}><Worksheet><Table>{rows}</Table></Worksheet></Workbook>'.encode()
    )


@pytest.mark.parametrize("write", [excel, libre_office, kinovea])
def test_a_spreadsheet_is_its_table(tmp_path, write):
    (tmp_path / "book").write_bytes(write())
    table = read_foreign(tmp_path / "book")
    assert (table.header, table.units) == (NAMES, {"t (s)": "s", "y (mm)": "mm"})
    assert [[float(cell) for cell in cells] for _, cells in table.rows] == [list(row) for row in ROWS]


@pytest.mark.parametrize(
    "data",
    [
        excel()[:-30],
        excel("<row><c>"),
        excel('<row r="1"><c r="A1" t="s"><v>99</v></c></row>'),
        zipped(content_xml='<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'),
        zipped(notes_txt="nothing"),
        kinovea()[:400],
    ],
)
def test_a_spreadsheet_that_is_none_is_one_line(tmp_path, data):
    (tmp_path / "book.xlsx").write_bytes(data)
    with pytest.raises(InputError) as refused:
        read_foreign(tmp_path / "book.xlsx")
    assert len(refused.value.defects) == 1


def test_a_table_of_a_laboratory_with_title_units_and_remarks(tmp_path):
    def cell(place, text):
        return f'<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>'

    sheet = f'<row r="1">{cell("B1", "Drop 7, oil")}</row><row r="3">{cell("B3", "time")}{cell("C3", "height")}'
    sheet += f'{cell("E3", "remark")}</row><row r="4">{cell("B4", "s")}{cell("C4", "mm")}</row>'
    for n, (t, y) in enumerate(4 * ROWS, 5):
        remark = cell(f"E{n}", "let go") if n == 5 else ""
        sheet += f'<row r="{n}"><c r="B{n}"><v>{t}</v></c><c r="C{n}"><v>{y}</v></c>{remark}</row>'
    (tmp_path / "book.xlsx").write_bytes(excel(sheet))
    table = read_foreign(tmp_path / "book.xlsx")
    assert table.header == ["time", "height", "remark"]
    assert {"time": "s", "height": "mm"}.items() <= table.units.items()


@pytest.mark.parametrize("words", [0, 512])
def test_arrays_in_hdf5(tmp_path, words):
    """MATLAB 7.3 keeps a row as a column and begins with words of its own."""
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=words) as file:
        file["t"], file["y"], file["fps"] = [TIMES], [HEIGHTS], [[500.0]]
    if words:
        with (tmp_path / "a.mat").open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file")
    table = read_foreign(tmp_path / "a.mat")
    assert table.header == ["t", "y"]
    assert [[float(cell) for cell in cells] for _, cells in table.rows] == [list(row) for row in ROWS]


def test_cells_beyond_all_columns_are_left_out(tmp_path):
    far = '<row r="1"><c r="ZZZ1"><v>1</v></c><c r="A1"><v>1</v></c><c r="B1"><v>2</v></c></row>'
    (tmp_path / "book.xlsx").write_bytes(excel(4 * far))
    assert len(read_foreign(tmp_path / "book.xlsx").header) == 2


def test_an_array_of_numpy(tmp_path):
    np.save(tmp_path / "rows.npy", np.array(ROWS))
    np.save(tmp_path / "columns.npy", np.array([*ROWS, *ROWS]).T)
    for name, frames in (("rows.npy", 4), ("columns.npy", 8)):
        table = read_foreign(tmp_path / name)
        assert (table.header, len(table.rows), table.named) == (["1", "2"], frames, False)
    np.save(tmp_path / "one.npy", np.arange(3.0))
    with pytest.raises(InputError, match="array of 3"):
        read_foreign(tmp_path / "one.npy")


def test_a_workspace_of_matlab(tmp_path):
    savemat(tmp_path / "a.mat", {"t": TIMES, "xy": np.array([[1.0] * 4, HEIGHTS]), "fps": 500.0, "note": "x"})
    table = read_foreign(tmp_path / "a.mat")
    assert table.header == ["t", "xy_1", "xy_2"]
    assert [float(cells[2]) for _, cells in table.rows] == HEIGHTS
    savemat(tmp_path / "b.mat", {"fps": 500.0})
    with pytest.raises(InputError, match="fps"):
        read_foreign(tmp_path / "b.mat")
    (tmp_path / "c.mat").write_bytes((tmp_path / "a.mat").read_bytes()[:200])
    with pytest.raises(InputError, match="MATLAB"):
        read_foreign(tmp_path / "c.mat")


def test_tracks_of_u_track(tmp_path):
    """Eight numbers a frame; the track begins in the third frame and has a gap."""
    numbers = np.zeros((1, 32))
    numbers[0, 1::8] = [5.0, np.nan, 2.5, 3.125]
    kind = [("tracksCoordAmpCG", "O"), ("seqOfEvents", "O")]
    events = np.array([[3.0, 1, 1, np.nan], [6.0, 2, 1, np.nan]])
    savemat(tmp_path / "u.mat", {"tracksFinal": np.array([(numbers, events)], dtype=kind)})
    table = read_foreign(tmp_path / "u.mat")
    assert table.header == ["track", "frame", "x", "y"]
    assert [cells[1] for _, cells in table.rows] == ["3", "4", "5", "6"]
    assert [cells[3] for _, cells in table.rows] == ["5.0", "nan", "2.5", "3.125"]


@pytest.mark.parametrize(
    "content",
    [
        {"t": TIMES, "y": HEIGHTS, "fps": 500, "sizes": [1, 2]},
        [{"t": t, "y": y, "box": [1, 2]} for t, y in ROWS],
    ],
)
def test_lists_and_records_in_json(tmp_path, content):
    (tmp_path / "track.json").write_text(json.dumps(content))
    table = read_foreign(tmp_path / "track.json")
    assert table.header == ["t", "y"]
    assert [[float(cell) for cell in cells] for _, cells in table.rows] == [list(row) for row in ROWS]


def test_json_that_is_no_table(tmp_path):
    (tmp_path / "track.json").write_text('{"a": {"b": 1}}')
    with pytest.raises(InputError, match="JSON, no table"):
        read_foreign(tmp_path / "track.json")


def test_units_in_brackets_are_no_json(tmp_path):
    (tmp_path / "track.csv").write_text("[s],[mm]\n" + "".join(f"{t},{y}\n" for t, y in ROWS))
    assert len(read_foreign(tmp_path / "track.csv").rows) == len(ROWS)


@pytest.mark.parametrize("write", [excel, libre_office, kinovea])
def test_damage_is_an_error_of_the_input(tmp_path, write):
    """A piece taken out anywhere: a table, or one that cannot be read, no other error."""
    data = write()
    for at in range(0, len(data) - 20, max(len(data) // 60, 1)):
        (tmp_path / "book").write_bytes(data[:at] + data[at + 11 :])
        with contextlib.suppress(InputError):
            read_foreign(tmp_path / "book")


def test_a_damaged_array_is_an_error_of_the_input(tmp_path):
    np.save(tmp_path / "a.npy", np.array(ROWS))
    data = (tmp_path / "a.npy").read_bytes()
    for at in range(6, 100):
        (tmp_path / "a.npy").write_bytes(data[:at] + b"(" + data[at + 1 :])
        with contextlib.suppress(InputError):
            read_foreign(tmp_path / "a.npy")
