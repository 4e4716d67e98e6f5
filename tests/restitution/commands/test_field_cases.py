"""Files as users have them, from the command line: the right value, or the doubt that names the mistake."""

import re
import shutil
from pathlib import Path

import pandas as pd
import pytest

from restitution.cli import main

CASES = Path(__file__).parents[2] / "field_cases"
CONDITIONS = ("--conditions", "conditions.toml")
DIGITISED = (
    "--stokes",
    "st",
    "--speed",
    "unstated",
    "--e-dry",
    "0.97",
    "--column",
    "stokes=St",
    "--column",
    "e_eff=e",
)


@pytest.fixture
def field(tmp_path, monkeypatch, capsys):
    """Run a command beside the cases: status, output without and with errors, and the table of impacts if any."""
    for file in CASES.iterdir():
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        status = main(list(arguments))
        out = capsys.readouterr()
        table = pd.read_csv("out.csv") if Path("out.csv").exists() else None
        return status, out.out, out.err, table

    return run


def doubts(out):
    return re.findall(r"(?m)^doubt:? +(.*)$", out)


TRUTH = [(0.2029, 0.3891, 0.74), (0.3167, 0.2223, 0.63)]


def as_the_truth(table, truth=TRUTH, sigmas=2.5):
    """Whether the first impacts are those that the track was made with, within their errors."""
    for row, (time, v_in, e) in zip(table.itertuples(), truth, strict=False):
        assert row.time_s == pytest.approx(time, abs=5e-4)
        assert abs(row.impact_speed_m_s - v_in) < sigmas * row.impact_speed_sigma_m_s
        assert abs(row.e_eff - e) < sigmas * row.e_eff_sigma
        assert row.e_eff_sigma < 0.1


def test_the_ordinary_record_is_not_doubted(field):
    status, out, _, table = field("impacts", "ordinary.csv", *CONDITIONS, "--strict", "--out", "out.csv")
    assert (status, doubts(out)) == (0, [])
    as_the_truth(table)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("slow_motion_8x.csv", *CONDITIONS), "times are 8"),
        (("ordinary.csv", "--conditions", "conditions_cP.toml"), '"6.2 mPa s"'),
        (("two_rebounds.csv", "--conditions", "conditions_radius.toml"), "radius"),
        (("mistracked_frames.csv", *CONDITIONS), "0.11, 0.112, 0.262"),
        (("distance_fallen.csv", *CONDITIONS), "--direction down"),
        (("velocity_down.csv", *CONDITIONS), "--direction down"),
        (
            ("dimensionless.csv", *CONDITIONS, "--column", "time_s=t_star", "--column", "gap_m=gap_over_d",
            "--unit", "m", "--time-unit", "s"), "--unit d",
        ),
    ],
)  # fmt: skip
def test_a_mistake_is_named_and_refused_where_asked(field, arguments, words):
    status, out, _, _ = field("impacts", *arguments)
    assert status == 0
    (doubt,) = doubts(out)
    assert words in doubt
    status, out, err, table = field("impacts", *arguments, "--strict", "--out", "out.csv")
    assert (status, out, table) == (2, "", None)
    assert words in err


@pytest.mark.parametrize(
    "arguments",
    [
        ("mistracked_frames.csv", *CONDITIONS),
        ("distance_fallen.csv", *CONDITIONS, "--direction", "down", "--wall", "rest"),
        ("velocity_down.csv", *CONDITIONS, "--direction", "down"),
        ("slow_motion_8x.csv", *CONDITIONS, "--time-unit", "0.125s"),
        ("dimensionless.csv", *CONDITIONS, "--column", "time_s=t_star", "--column", "gap_m=gap_over_d",
        "--unit", "d", "--time-unit", "15.420ms"),
    ],
)  # fmt: skip
def test_what_the_doubt_says_mends_it(field, arguments):
    status, out, _, table = field("impacts", *arguments, "--out", "out.csv")
    assert status == 0
    assert all("left out" in doubt for doubt in doubts(out))
    as_the_truth(table, sigmas=4 if "dimensionless" in arguments[0] else 2.5)


def test_doubts_stand_in_the_table_that_is_written(field):
    *_, table = field("impacts", "slow_motion_8x.csv", *CONDITIONS, "--out", "out.csv")
    assert table.note.str.contains("doubt: clock").all()


def test_pixel_steps_give_a_value(field):
    status, _, _, table = field("impacts", "pixel_steps_10kHz.csv", *CONDITIONS, "--out", "out.csv")
    assert status == 0
    as_the_truth(table, [(0.0793, 0.2700, 0.74)])
    assert table.stokes[0] == pytest.approx(72.3, abs=2)


def test_a_faster_camera_is_no_worse(field):
    *_, fast = field("impacts", "fast_camera_10kHz.csv", *CONDITIONS, "--out", "out.csv")
    *_, slow = field("impacts", "fast_camera_every_20th.csv", *CONDITIONS, "--out", "out.csv")
    assert fast.e_eff_sigma[0] <= slow.e_eff_sigma[0]
    for table in (fast, slow):
        assert abs(table.e_eff[0] - 0.74) < 2 * table.e_eff_sigma[0]


def test_a_contact_that_lasts_is_left_out(field):
    _, out, _, table = field("impacts", "soft_contact_velocity.csv", *CONDITIONS, "--out", "out.csv")
    assert "contact lasts" in out
    for row, (v_in, e) in zip(table.itertuples(), ((0.3891, 0.678), (0.2094, 0.676)), strict=False):
        assert row.impact_speed_m_s == pytest.approx(v_in, rel=0.01)
        assert abs(row.e_eff - e) < 2 * row.e_eff_sigma


def test_measuring_e_dry_needs_no_e_dry(field):
    arguments = ("dry_drop_in_air.csv", "--conditions", "conditions_air_no_e_dry.toml")
    status, _, _, table = field("impacts", *arguments, "--out", "out.csv")
    assert status == 0
    assert table.e_dry.isna().all()
    for row, v_in in zip(table.itertuples(), (0.989, 0.938, 0.890), strict=True):
        assert row.impact_speed_m_s == pytest.approx(v_in, abs=0.004)
        assert abs(row.e_eff - 0.95) < 2 * row.e_eff_sigma


def test_times_keep_what_tells_impacts_apart(field):
    *_, table = field("impacts", "unix_time.csv", *CONDITIONS, "--out", "out.csv")
    assert (table.time_s - 1718000000.0).tolist()[:3] == pytest.approx([0.2028, 0.3165, 0.3765], abs=3e-4)


@pytest.mark.parametrize(
    ("track", "e"), [("two_rebounds.csv", (0.713, 0.512)), ("held_before_release.csv", (0.713, 0.512))]
)
def test_two_rebounds_suffice_for_e_of_whole_trajectories(field, track, e):
    status, out, err, _ = field("fit", "--trajectory", track, *CONDITIONS, "--wake", "off")
    assert (status, err) == (0, "")
    assert out.count("not ranked") == 1
    found = [
        float(x) for x in re.findall(r"(0\.\d{3}) \+- 0\.\d{3}", next(x for x in out.splitlines() if track in x))
    ]
    assert found[:2] == pytest.approx(e, abs=0.006)


def test_other_forces_than_the_models_are_doubted_without_a_law(field):
    status, out, _, _ = field("fit", "--trajectory", "drag_without_history.csv", *CONDITIONS, "--wake", "off")
    assert status == 0
    assert any("no history force" in doubt for doubt in doubts(out))
    assert (
        field("fit", "--trajectory", "drag_without_history.csv", *CONDITIONS, "--wake", "off", "--strict")[0] == 2
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("ordinary.csv", "--conditions", "conditions_cP.toml"), "mPa s"),
        (("two_rebounds.csv", "--conditions", "conditions_radius.toml"), "radius"),
        (("slow_motion_8x.csv", *CONDITIONS), "times are 8"),
        (("distance_fallen.csv", *CONDITIONS), "--direction down"),
    ],
)
def test_what_no_model_follows_is_refused_with_the_mistake(field, arguments, words):
    status, _, err, _ = field("fit", "--trajectory", *arguments)
    assert (status, words in err, len(err.splitlines())) == (2, True, 1)


def test_mistracked_frames_do_not_move_a_fit(field):
    _, out, _, _ = field("fit", "mistracked_frames.csv", *CONDITIONS, "--speed", "far")
    K = float(re.search(r"(?m)^K +([\d.]+)", out)[1])
    assert pytest.approx(14.1, abs=1.1) == K
    assert len(doubts(out)) == 1


def test_a_stokes_number_without_its_nine_is_doubted(field):
    status, out, _, _ = field("fit", "stokes_without_the_nine.csv", *DIGITISED, "--out", "fit.json")
    (doubt,) = doubts(out)
    assert (status, "--stokes st_d" in doubt) == (0, True)
    assert "--stokes st_d" in Path("fit.json").read_text()
    assert (
        len(doubts(field("compare", "stokes_without_the_nine.csv", *DIGITISED, "--law", "eq4_exponential")[1]))
        == 1
    )
    for command in (("fit",), ("compare", "--law", "eq4_exponential")):
        assert field(command[0], "stokes_without_the_nine.csv", *DIGITISED, *command[1:], "--strict")[0] == 2
    mended = [x if x != "st" else "st_d" for x in DIGITISED]
    _, out, _, _ = field("fit", "stokes_without_the_nine.csv", *mended)
    assert doubts(out) == []
    assert float(re.search(r"(?m)^K +([\d.]+)", out)[1]) == pytest.approx(12.12, abs=0.1)


def test_two_definitions_of_the_stokes_number_are_converted(field):
    status, out, _, _ = field("fit", "group_a_st.csv", "group_b_st_d.csv")
    assert (status, doubts(out)) == (0, [])
    assert "16 with a rebound" in out
    assert float(re.search(r"(?m)^K +([\d.]+)", out)[1]) == pytest.approx(12.01, abs=0.16)
