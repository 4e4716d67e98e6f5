"""The Fig. 2 report: complete and self-contained from kept runs, which say when they are not of this code."""

import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest

from restitution import cases, datasets
from restitution.cli import main
from restitution.commands.simulate import show_result
from restitution.report.fig1 import content as fig1
from restitution.report.fig1 import plot as fig1_plot
from restitution.report.fig2 import content as fig2
from restitution.report.fig2 import point_lines
from restitution.report.fig2 import report as fig2_report
from restitution.report.fig2.findings import in_words
from restitution.report.fig2.sensitivity import sensitivity
from restitution.report.fig2.studies import groups
from restitution.report.page import percent
from restitution.runs.filmed import filmed, simulated_impacts
from restitution.runs.flow_pictures import FlowFrames, Frame
from restitution.runs.validity import physics
from restitution.runs.validity.program import program_hash
from restitution.runs.validity.told import departures, told
from restitution.stokes import Speed
from restitution.tables.writing import table_text

FALL = 8.146
"""Free fall of the 3 mm sphere in oil, m/s2: 9.81 (7800 - 935)/(7800 + 935/2)."""


def keep(folder, name, e, current=True, case=None):
    """A ballistic trajectory in the place of a run: rebounds by ``e`` from 0.585 m/s, without drag."""
    case = cases.read_case(name) if case is None else case
    speeds = [0.585 * e**k for k in range(1, 5)]
    starts = np.cumsum([0.0, *(2 * v / FALL for v in speeds)])
    time = np.arange(-0.02, starts[-1], 2e-4)
    gap, velocity = np.where(time < 0, -0.585 * time, 0.0), np.where(time < 0, -0.585, 0.0)
    for v, start, end in zip(speeds, starts[:-1], starts[1:], strict=True):
        t, here = time - start, (time >= start) & (time < end)
        gap = np.where(here, v * t - FALL / 2 * t**2, gap)
        velocity = np.where(here, v - FALL * t, velocity)
    trajectory = pd.DataFrame({"time_s": time, "gap_m": gap})
    about = {
        "physics": physics.version() if current else None, "code_hash": program_hash() if current else "0",
        "told": told(case), "filmed": filmed(case),
        "case": name, "date": "2001-02-03", "finished": True, "seconds": 1.0, "threads": 1, "steps": 10,
        "shape": [8, 8, 8], "step_s": 1e-5,
        "case_as_run": case.model_dump(mode="json", exclude_none=True),
        "numbers": dict.fromkeys(("Re", "Ma", "relaxation time", "grid Re"), 1.0),
        "contacts": [
            {"time_s": starts[k], "speed_in_m_s": v / e, "speed_out_m_s": v} for k, v in enumerate(speeds)
        ],
    }  # fmt: skip
    x = np.linspace(-1.5, 1.5, 12)
    flow = FlowFrames({m: Frame(np.outer(x, x), x, x + 1.5, 0.1, 0.0) for m in ("before", "at", "after")})
    (folder / name).mkdir(parents=True)
    files = {
        "trajectory.csv": table_text(trajectory),
        "velocity.csv": table_text(pd.DataFrame({"time_s": time, "velocity_m_s": velocity})),
        "impacts.csv": table_text(simulated_impacts(trajectory, case)[0]),
        "run.json": json.dumps(about),
    }
    for file, text in files.items():
        (folder / name / file).write_text(text)
    (folder / name / "flow.npz").write_bytes(flow.as_bytes())


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fig2")
    for name, e in zip(fig2.SHORT, (0.8, 0.75, 0.7), strict=True):
        keep(folder / "runs", name, e)
    keep(folder / "runs", "gondret_st152_16", 0.76, current=False)
    checks = [{"name": "drag", "measured": 1.01, "reference": 1.0, "error": 0.01, "source": "Somebody 1982"}]
    (folder / "sphere.json").write_text(json.dumps(checks))
    files, failed = fig2_report.write(folder / "out", folder / "runs", folder / "sphere.json")
    assert not failed
    assert {p.name for p in (folder / "out").iterdir()} == set(files)
    return folder


def test_a_run_that_is_shown_has_the_apexes_of_the_report(tmp_path, capsys):
    """Rows so far apart that the highest of them is not the apex; the last flight counts, seen to come down."""
    keep(tmp_path, fig2.DRY, 0.75)
    table = pd.read_csv(tmp_path / fig2.DRY / "trajectory.csv").iloc[::30]
    (tmp_path / fig2.DRY / "trajectory.csv").write_text(table_text(table))
    show_result(tmp_path / fig2.DRY, cases.read_case(fig2.DRY))
    shown = [line.split()[-1] for line in capsys.readouterr().out.splitlines()[1:5]]
    by_hand = [1e3 * (0.75**k * 0.585) ** 2 / 2 / FALL for k in range(1, 5)]
    assert [float(apex) for apex in shown] == pytest.approx(by_hand, abs=1e-3)


def test_scores_of_ballistic_rebounds(report):
    """Apexes (e^k v)^2 / 2g' and intervals 2 e^k v / g', by hand."""
    scores = pd.read_csv(report / "out" / "scores.csv").set_index("case")
    row = scores.loc["gondret_st152_10"]
    assert row.apex_1_m == pytest.approx((0.75 * 0.585) ** 2 / 2 / FALL, rel=1e-3)
    assert row.interval_2_s == pytest.approx(2 * 0.75**2 * 0.585 / FALL, rel=1e-3)
    assert row.apex_1_error == pytest.approx(row.apex_1_m / 7.469e-3 - 1, rel=1e-3)
    assert row.approach_speed_m_s == pytest.approx(0.585, rel=1e-3)
    assert row.rms_gap_d > 0


def test_page_loads_nothing_and_shows_all(report):
    page = (report / "out" / "index.html").read_text()
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert "<script" not in page
    for name in (*fig2.SHORT, "gondret_st152_16", "Somebody 1982", "2001-02-03, code 0"):
        assert name in page


def test_stale_runs_are_shown_as_such(report):
    scores = pd.read_csv(report / "out" / "scores.csv").set_index("case")
    assert scores.stale.to_dict() == dict.fromkeys(
        (*fig2.SHORT, *point_lines.closures(), point_lines.FITTED), False
    ) | {"gondret_st152_16": True}


def test_point_particle_is_scored_by_the_measure_of_the_runs(report):
    """Apex errors against the apexes stated with the record; frames do not see all of the wall's brake."""
    scores = pd.read_csv(report / "out" / "scores.csv").set_index("case")
    for line in point_lines.lines(fig2.RECORD):
        row = scores.loc[line.name]
        assert row.apex_1_error == pytest.approx(line.path.apexes()[0] / 7.469e-3 - 1, abs=1e-4)
        assert line.path.impacts[0].v_in < row.approach_speed_m_s < -line.path.velocity_m_s.min()
    assert scores.rms_gap_d[point_lines.DRY_WAKE] < scores.rms_gap_d[point_lines.DRY]


def test_the_record_says_that_history_matters(report):
    off = pd.read_csv(report / "out" / "physics.csv").set_index("off")
    assert off.rms_d["history"] > 2 * off.rms_d["nothing"]
    assert (off.rms_d >= off.rms_d["nothing"]).all()
    page = (report / "out" / "index.html").read_text()
    assert all(name in page for name in (*off.index, *point_lines.closures()))


def test_second_report_gives_the_same_bytes(report, tmp_path):
    fig2_report.write(tmp_path, report / "runs", report / "sphere.json")
    for path in (report / "out").iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_page_without_verification_says_so(report, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = tmp_path / fig2.VERIFICATION  # which a function does not read because it stands where one stands
    place.parent.mkdir()
    shutil.copy(report / "sphere.json", place)
    fig2_report.write(tmp_path, report / "runs")
    assert "No figures are kept" in (tmp_path / "index.html").read_text()


def test_verification_that_is_none_is_refused(report, tmp_path, capsys):
    (tmp_path / "bad.json").write_text('{"name": 1}')
    places = {"--runs": report / "runs", "--checks": tmp_path / "bad.json", "--out": tmp_path / "out"}
    assert main(["report", "fig2", *(str(word) for pair in places.items() for word in pair)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_predicted_rebounds_join_figure_1_without_a_score(report):
    alone, joined = fig1.gather(), fig1.gather(runs=report / "runs")
    own = joined.impacts[joined.impacts.record == "gondret_st152_10"]
    assert len(own) >= 3
    assert set(own.kind) == {"simulated"}
    assert "gondret_st152_10_imposed" not in set(joined.impacts.record)
    pd.testing.assert_frame_equal(alone.scores, joined.scores)
    assert set(datasets.names()).isdisjoint(joined.simulated)


def refused(runs, tmp_path, capsys, **options):
    """The lines of a report that is refused before anything is simulated or written."""
    places = {"runs": runs, "out": tmp_path / "out", **options}
    words = [str(word) for name, place in places.items() for word in (f"--{name}", place)]
    assert main(["report", "fig2", *words]) == 2
    assert not (tmp_path / "out").exists()
    return capsys.readouterr().err.splitlines()


@pytest.fixture
def runs(report, tmp_path):
    """A copy of the kept runs, to be spoilt."""
    return shutil.copytree(report / "runs", tmp_path / "runs")


def test_all_that_is_damaged_is_named_at_once(runs, tmp_path, capsys):
    (runs / "gondret_st152_10" / "run.json").write_text("{")
    about = json.loads((runs / "gondret_st152_16" / "run.json").read_text())
    (runs / "gondret_st152_16" / "run.json").write_text(json.dumps(about | {"finished": False}))
    (runs / "gondret_st152_10_soft" / "velocity.csv").write_text("time_s\n0\n")
    (runs / "gondret_st152_10_imposed" / "impacts.csv").unlink()
    lines = refused(runs, tmp_path, capsys)
    for name in (
        "gondret_st152_10/run.json", "gondret_st152_16/run.json", "gondret_st152_10_soft/velocity.csv",
        "gondret_st152_10_imposed/impacts.csv",
    ):  # fmt: skip
        assert any(name in line for line in lines)


def test_a_table_that_was_cut_is_refused(runs, tmp_path, capsys):
    place = runs / "gondret_st152_10"
    table = (place / "trajectory.csv").read_text().splitlines()
    about = json.loads((place / "run.json").read_text())
    about |= {"steps": len(table) - 2, "step_s": 2e-4}
    (place / "run.json").write_text(json.dumps(about))
    assert set(fig2.SHORT) <= fig2.gather(runs).scores.keys()
    (place / "trajectory.csv").write_text("\n".join(table[: len(table) // 2]) + "\n")
    assert any("trajectory.csv" in line and "ends before" in line for line in refused(runs, tmp_path, capsys))


def test_places_that_cannot_be_are_refused_before_anything_is_run(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert len(refused(tmp_path / "file", tmp_path, capsys)) == 1
    for checks in ("file", "no.json"):
        assert len(refused(tmp_path / "none", tmp_path, capsys, checks=tmp_path / checks)) == 1
    assert main(["report", "fig2", "--runs", str(tmp_path / "none"), "--out", str(tmp_path / "file")]) == 2
    assert not (tmp_path / "none").exists()


def test_a_run_of_ones_own_case_is_scored(runs, tmp_path):
    shutil.copytree(runs / "gondret_st152_10", runs / "mine")
    found = fig2.gather(runs)
    assert found.own == ["mine"]
    assert found.scores["mine"].bounces == found.scores["gondret_st152_10"].bounces
    fig2_report.write(tmp_path / "out", runs)
    assert "mine" in (tmp_path / "out" / "index.html").read_text()


def test_a_case_of_ones_own_joins_what_its_study_names(runs, tmp_path):
    """A group with its reference, a finer grid among the findings, and a series of Fig. 1: all from one file."""
    (tmp_path / "mine.toml").write_text(
        'base = "gondret_st152_10"\n[numerics]\ncells_per_diameter = 12\nwidth_d = 7\nheight_d = 19\n'
        '[study]\nvaries = "cells, my box"\nagainst = "gondret_st152_10_small"\nseries = "my spheres"\n'
    )
    mine = cases.read_case(tmp_path / "mine.toml")
    keep(runs, "mine", 0.74, case=mine)
    keep(runs, "gondret_st152_10_small", 0.75)
    found = fig2.gather(runs)
    group = found.groups[-1]  # no order is stated
    assert (group.varies, group.names) == ("cells, my box", ("gondret_st152_10_small", "mine"))
    rows = {row["name"]: row for row in sensitivity(found) if row["what"] == "cells, my box"}
    assert rows["mine"]["changes"][0] == percent((0.74 / 0.75) ** 2 - 1)
    assert any("10, 12 cells per diameter" in words for words in in_words(found))
    joined = fig1.gather(runs=runs)
    assert joined.simulated["mine"].series == "my spheres"
    assert "this package, simulation of my spheres" in [look[0] for look in fig1_plot.looks(joined).values()]
    fig1_plot.draw(joined, Speed.CONTACT)


def test_groups_of_shipped_cases_differ_in_what_reaches_the_solver():
    """No case is in a group twice, and each is told something else than the one it stands against."""
    shipped = {name: cases.read_case(name) for name in cases.names()}
    found = groups(shipped, fig2.RECORD)
    assert len(found) == len({group.varies for group in found})
    for group in found:
        for case in group.cases[1:]:
            assert departures(told(group.against), told(case)), case.name
