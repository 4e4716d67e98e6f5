"""The Fig. 1 report: complete, self-contained, the same twice, and also from an installed wheel elsewhere."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from restitution import datasets, laws
from restitution.report.fig1 import report as fig1_report
from restitution.report.fig1 import scores as comparison
from restitution.stokes import Speed

FILES = {
    "figure.svg",
    "figure.png",
    "impacts.csv",
    "impacts_by_speed.csv",
    "laws.csv",
    "readings.csv",
    "trajectories.csv",
    "trajectory_readings.csv",
    "trajectory_left_out.csv",
    "index.html",
}


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fig1")
    fig1_report.write(folder)
    return folder


def test_all_files_and_nothing_else(report):
    assert {p.name for p in report.iterdir()} == FILES


def test_whole_trajectories_meet_the_frames_and_agree_with_slopes(report):
    records = pd.read_csv(report / "trajectories.csv").set_index(["model", "record"])
    assert len(records) == 14
    waked = records.loc["with the wake of the approach"]
    assert waked.rms_d["gondret2002_st152"] < 0.06
    assert waked.rms_law_d["gondret2002_st152"] < 0.06
    assert (waked.rms_d.drop("gondret2002_st152") < 0.01).all()
    # e_eff of the first three bounces by slopes and their errors, as the impacts command prints them.
    for n, e, sigma in ((1, 0.807, 0.022), (2, 0.707, 0.020), (3, 0.529, 0.053)):
        assert waked[f"e_{n}"]["gondret2002_st152"] == pytest.approx(e, abs=2 * sigma)
    forms = pd.read_csv(report / "trajectory_readings.csv")
    slopes = pd.read_csv(report / "readings.csv")
    far = slopes[(slopes.speed_definition == "far") & (slopes.parameters == "K fitted")].set_index("law")
    for row in forms.itertuples():  # one definition of speed, so the intervals must overlap
        assert row.K_low_95 < far.K_high_95[row.law]
        assert row.K_high_95 > far.K_low_95[row.law]


def test_second_run_gives_the_same_bytes(report, tmp_path):
    fig1_report.write(tmp_path)
    for name in FILES:
        assert (tmp_path / name).read_bytes() == (report / name).read_bytes(), name


def test_page_loads_nothing(report):
    page = (report / "index.html").read_text()
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert "<script" not in page
    for resource in map(datasets.resource, datasets.names()):
        if resource.table == "trajectory" and resource.conditions.sphere.e_dry:
            assert resource.hash.removeprefix("sha256:") in page


def test_impacts_carry_their_provenance(report):
    table = pd.read_csv(report / "impacts.csv")
    assert set(table.record[table.kind == "simulated"]) == {"biegert2017_st152", "biegert2017_st27"}
    assert table[["experiment", "doi", "sha256"]].notna().all(axis=None)
    used = table[table.used_in_simulation & (table.outcome == "rebound")]
    assert list(used.impact) == [1, 2, 3, 4]


def test_simulated_impacts_enter_no_score(report):
    scores = pd.read_csv(report / "laws.csv")
    assert not scores.record.str.contains("biegert").any()
    impacts = pd.read_csv(report / "impacts.csv")
    measured = ((impacts.kind == "measured") & (impacts.outcome == "rebound")).sum()
    overall = scores[(scores.record == "all") & (scores.speed_definition == "contact")]
    assert set(overall.impacts) == {measured}


def test_the_data_reject_the_linear_readings(report):
    """The sphere rebounds at St = 27, where the linear readings with K = 18 have none."""
    scores = pd.read_csv(report / "laws.csv")
    for name in ("eq4_linear", "eq4_linear_relative"):
        rows = scores[(scores.law == name) & (scores.record == "gondret2002_st27")]
        assert (rows["bias"] > 0.4).all()


@pytest.mark.parametrize("speed", ["far", "window"])
def test_the_page_of_another_speed_says_so(speed, tmp_path):
    fig1_report.write(tmp_path, Speed(speed))
    page = (tmp_path / "index.html").read_text()
    impacts = pd.read_csv(tmp_path / "impacts.csv")
    assert set(impacts.speed_definition) == {speed}
    assert f"--speed {speed}" in page
    first = impacts.iloc[0]
    assert f"{first.stokes:.1f} ± {first.stokes_sigma:.1f}" in page


@pytest.mark.parametrize("correlated", [False, True])
def test_residual_variance_against_monte_carlo(correlated):
    """r = v_out/v_in - f(St(v_in)), v_in and v_out drawn a million times, with and without a common error."""
    law = laws.get("eq4_exponential")
    v_in, s_in, v_out, s_out, per_speed = 0.3, 0.004, 0.2, 0.003, 260.0
    rng = np.random.default_rng(5)
    a, b = rng.normal(v_in, s_in, 10**6), rng.normal(v_out, s_out, 10**6)
    if correlated:
        b = b + 0.8 * (a - v_in)
    drawn = b / a - 0.97 * np.exp(-18 * 1.97 / (a * per_speed))
    impacts = pd.DataFrame(
        {
            "record": ["x"],
            "speed_definition": ["contact"],
            "stokes": [v_in * per_speed],
            "stokes_sigma": [s_in * per_speed],
            "stokes_convention": ["st"],
            "e_dry": [0.97],
            "e_eff": [v_out / v_in],
            "e_eff_sigma": [np.std(b / a)],
            "e_stokes_correlation": [np.corrcoef(b / a, a)[0, 1] if correlated else np.nan],
        }
    )
    residual, sigma = comparison.residuals(law, impacts, {"x": None})
    assert residual[0] == pytest.approx(drawn.mean(), abs=2e-4)
    assert sigma[0] == pytest.approx(drawn.std(), rel=0.01)


def test_from_an_installed_wheel_elsewhere(report, installed, tmp_path):
    """Run where it is unpacked: the data come along, the figures are the same."""
    environment = os.environ | {"PYTHONPATH": str(installed)}
    code = (
        "import sys, restitution; from restitution.cli import main; print(restitution.__file__); sys.exit(main())"
    )
    command = [sys.executable, "-c", code, "report", "fig1", "--out", "out"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True)
    assert Path(done.stdout.splitlines()[0]).is_relative_to(installed)
    for name in FILES - {"index.html"}:  # the page names the installed version
        assert (tmp_path / "out" / name).read_bytes() == (report / name).read_bytes(), name
