"""Digitised plots as programs write them: European locales, names with commas, older projects, error bars."""

import io
import json
import tarfile

import numpy as np
import pytest

from restitution.calibration import read
from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track


def exported(tmp_path, name, content):
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read(path, stokes="st", speed="far")


ST, E = (10.0, 50.0, 200.0), (0.25, 0.6125, 0.9)
EUROPEAN = {
    "semicolons": "10; 0,25\n50; 0,6125\n200; 0,9\n",
    "tabs": "10\t0,25\n50\t0,6125\n200\t0,9\n",
    "quotes": '"10", "0,25"\n"50", "0,6125"\n"200", "0,9"\n',
}


@pytest.mark.parametrize("kind", EUROPEAN)
def test_exports_with_decimal_commas(tmp_path, kind):
    impacts = exported(tmp_path, "plot.csv", EUROPEAN[kind])
    np.testing.assert_allclose(impacts.St, ST)
    np.testing.assert_allclose(impacts.e, E)


def test_a_curve_of_another_digitizer_with_mapped_columns(tmp_path):
    (tmp_path / "plot.csv").write_text('x, Curve1\n"10", "0,25"\n"50", "0,6125"\n"200", "0,9"\n')
    impacts = read(tmp_path / "plot.csv", stokes="st", speed="far", columns={"stokes": "x", "e_eff": "Curve1"})
    np.testing.assert_allclose(impacts.e, E)


def test_names_of_data_sets_may_have_commas(tmp_path):
    content = "steel, 4 mm,,glass, in oil, 6 mm,\nX,Y,X,Y\n10,0.25,20,0.3\n50,0.6125,,\n"
    impacts = exported(tmp_path, "plot.csv", content)
    assert list(impacts.labels["source"]) == ["steel, 4 mm", "glass, in oil, 6 mm", "steel, 4 mm"]


CALIBRATION = [
    {"px": 0, "py": 100, "dx": "0", "dy": "0"},
    {"px": 100, "py": 100, "dx": "1000", "dy": "0"},
    {"px": 0, "py": 100, "dx": "0", "dy": "0"},
    {"px": 0, "py": 0, "dx": "0", "dy": "1"},
]
POINTS = [{"x": st / 10, "y": 100 * (1 - e)} for st, e in zip(ST, E, strict=True)]


def test_a_project_of_version_3(tmp_path):
    project = {"wpd": {
        "version": [3, 8], "axesType": "XYAxes", "axesParameters": {"isLogX": False, "isLogY": False},
        "calibration": CALIBRATION, "dataSeries": [{"name": "glass", "data": POINTS}],
    }}  # fmt: skip
    impacts = exported(tmp_path, "plot.json", project)
    np.testing.assert_allclose(impacts.St, ST)
    np.testing.assert_allclose(impacts.e, E)


def test_ends_of_error_bars_are_no_impacts_and_unused_axes_no_obstacle(tmp_path):
    points = [{**p, "tuple": i, "group": 0} for i, p in enumerate(POINTS)]
    points += [{**p, "y": p["y"] - 8, "tuple": i, "group": 1} for i, p in enumerate(POINTS)]
    project = {
        "axesColl": [
            {"name": "XY", "type": "XYAxes", "isLogX": False, "isLogY": False, "calibrationPoints": CALIBRATION},
            {"name": "bars", "type": "BarAxes", "calibrationPoints": []},
        ],
        "datasetColl": [{"name": "glass", "axesName": "XY", "groupNames": ["mean", "top"], "data": points}],
    }
    impacts = exported(tmp_path, "plot.json", project)
    np.testing.assert_allclose(impacts.e, E)
    assert any("3 ends of error bars" in note for note in impacts.notes)


@pytest.mark.parametrize("content", ["10,0.3\n50,0.6\n60\n70,0.7\n", "D,\nX,Y\n30,0.3,1\n60,0.6,2\n90,0.7,3\n"])
def test_rows_that_are_no_pairs_are_refused_by_their_row(tmp_path, content):
    with pytest.raises(InputError) as error:
        exported(tmp_path, "plot.csv", content)
    assert error.value.defects[0].row == 3


BELOW = {
    "simple": "x,steel\n10,0.25\n50,0.6125\n\nx,glass\n200,0.9\n",
    "gnuplot": "#x\tsteel\n10\t0.25\n50\t0.6125\n\n\n#x\tglass\n200\t0.9\n",
    "european": "x;steel\n10;0,25\n50;0,6125\n\nx;glass\n200;0,9\n",
}


@pytest.mark.parametrize("kind", BELOW)
def test_curves_one_below_another_are_sources_of_their_own(tmp_path, kind):
    impacts = exported(tmp_path, "plot.csv", BELOW[kind])
    assert list(impacts.labels["source"]) == ["steel", "steel", "glass"]
    np.testing.assert_allclose(impacts.St, ST)
    np.testing.assert_allclose(impacts.e, E)


def test_tables_of_impacts_joined_with_their_names_are_one(tmp_path):
    head = "source,impact,stokes,e_eff\n"
    impacts = exported(tmp_path, "all.csv", head + "a,1,10,0.25\na,2,50,0.6125\n" + head + "b,1,200,0.9\n")
    assert list(impacts.labels["source"]) == ["a", "a", "b"]
    np.testing.assert_allclose(impacts.e, E)


def packed(path, content, name="fig/wpd.json"):
    with tarfile.open(path, "w") as archive:
        for member, data in (("fig/info.json", b"{}"), (name, json.dumps(content).encode())):
            about = tarfile.TarInfo(member)
            about.size = len(data)
            archive.addfile(about, io.BytesIO(data))
    return path


def of_version_4(*names):
    axes = {"name": "XY", "type": "XYAxes", "isLogX": False, "isLogY": False, "calibrationPoints": CALIBRATION}
    sets = [{"name": name, "axesName": "XY", "data": [*POINTS[::-1], {"x": 25, "y": 40}]} for name in names]
    return {"axesColl": [axes], "datasetColl": sets}


def test_a_project_in_its_archive(tmp_path):
    path = packed(tmp_path / "fig.tar", of_version_4("glass"))
    impacts = read(path, stokes="st", speed="far")
    np.testing.assert_allclose(sorted(impacts.St), [*ST, 250])
    assert all(impacts.e_sigma > 0)  # of a click
    with pytest.raises(InputError, match=r"wpd\.json"):
        read(packed(tmp_path / "other.tar", {}, "fig/notes.json"), stokes="st", speed="far")


@pytest.mark.parametrize("sign", [",", ";"])
def test_curves_side_by_side_over_one_x(tmp_path, sign):
    """Engauge's table of the points of all curves: a curve has none at the x of another."""
    rows = ["x,steel,glass", "10,0.25,", "50,0.6125,", "20,,0.3", "200,0.9,"]
    text = "\n".join(row if sign == "," else row.replace(",", ";").replace(".", ",") for row in rows)
    impacts = exported(tmp_path, "plot.csv", text + "\n")
    assert sorted(zip(impacts.labels["source"], impacts.St, strict=True)) == [
        ("glass", 20.0), ("steel", 10.0), ("steel", 50.0), ("steel", 200.0),
    ]  # fmt: skip
    np.testing.assert_allclose(sorted(impacts.e), [0.25, 0.3, 0.6125, 0.9])


def test_x_and_y_alone(tmp_path):
    impacts = exported(tmp_path, "plot.csv", "x,y\n10,0.25\n50,0.6125\n200,0.9\n")
    np.testing.assert_allclose(impacts.e, E)
    assert set(impacts.labels["source"]) == {"plot"}


@pytest.mark.parametrize("archived", [False, True])
def test_a_height_against_time_is_a_track(tmp_path, archived):
    """Its clicks in any order; its unit and whose height it is are asked for."""
    content, path = of_version_4("steel", "brass"), tmp_path / "height.json"
    if archived:
        packed(path := tmp_path / "height.tar", content)
    else:
        path.write_text(json.dumps(content))
    table = read_foreign(path)
    assert table.particles() == {"steel": 4, "brass": 4}
    stated = {"particle": "brass", "time_unit": "ms", "unit": "mm", "point": "lowest"}
    track = read_track(table, Settings(**stated), None).table
    np.testing.assert_allclose(track.time_s, np.array([*ST, 250]) / 1e3)
    np.testing.assert_allclose(track.gap_m, np.array([*E, 0.6]) / 1e3)
    with pytest.raises(InputError, match=r"--time-unit.*--unit.*--point"):
        read_track(table, Settings(particle="brass"), None)


def test_impacts_in_a_spreadsheet_and_tracks_in_markup_are_no_plots(tmp_path):
    rows = [["stokes", "e_eff"], *zip(ST, E, strict=True)]
    cells = "".join("<Row>" + "".join(f"<Cell><Data>{x}</Data></Cell>" for x in row) + "</Row>" for row in rows)
    kind = 'xmlns="urn:schemas-microsoft-com:office:spreadsheet"'
    impacts = exported(tmp_path, "impacts.xml", f"<Workbook {kind}><Table>{cells}</Table></Workbook>")
    np.testing.assert_allclose(impacts.e, E)
    (tmp_path / "track.xml").write_text(
        '<Tracks><particle><detection t="0" x="1" y="2" z="0"/></particle></Tracks>'
    )
    with pytest.raises(InputError, match="is a track"):
        read(tmp_path / "track.xml")


def test_impacts_in_json(tmp_path):
    impacts = exported(tmp_path, "impacts.json", {"stokes": list(ST), "e_eff": list(E)})
    np.testing.assert_allclose(impacts.e, E)
