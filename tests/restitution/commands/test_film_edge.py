"""The edge of the film on the command line: stated, kept, converted, refused."""

import json

import numpy as np
import pytest

from restitution import datasets
from restitution.bounce.edges import restitution_at
from restitution.calibration.result.fit_file import read_fit
from restitution.cli import main
from restitution.export import fit_closure

PAIR = ("--fluid", "density=935,viscosity=0.01", "--sphere", "diameter=3e-3,density=7800,e_dry=0.97")


@pytest.fixture
def case(tmp_path, capsys, monkeypatch):
    """A folder; ``run`` gives status, stdout and stderr of a command there."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str):
        status = main(list(arguments))
        out = capsys.readouterr()
        return status, out.out, out.err

    run.folder = tmp_path
    return run


def table(case, name, edge="", K=11.0, speed="far"):
    """Impacts of Eq. (4); ``edge`` in every row, or no such column."""
    St = np.geomspace(25, 300, 8)
    rows = [f"{s:.4f},st,{speed},0.97,{0.97 * np.exp(-K * 1.97 / s):.5f},0.01{edge and ','}{edge}" for s in St]
    header = "stokes,stokes_convention,speed_definition,e_dry,e_eff,e_eff_sigma" + (",film_edge_d" if edge else "")
    (case.folder / name).write_text("\n".join([header, *rows]) + "\n")
    return name


def fitted(case, *arguments):
    status, _, err = case("fit", *arguments, "--law", "eq4_exponential", "--no-scatter", "--out", "fit.json")
    assert status == 0, err
    return read_fit("fit.json")


@pytest.mark.parametrize(
    ("column", "option", "edge"),
    [("0.3", (), 0.3), ("", (), 0.1), ("", ("--edge", "0.2"), 0.2), ("0.3", ("--edge", "0.3"), 0.3)],
)
def test_the_edge_of_a_table_is_kept_with_the_fit(case, column, option, edge):
    assert fitted(case, table(case, "my.csv", column), *option).edge_d == edge
    assert fit_closure("fit.json").edge == edge


@pytest.mark.parametrize("written", ["0.2d", "0.2 d", " .2", "2e-1"])
def test_an_edge_is_written_with_its_unit_or_without(case, written):
    assert fitted(case, table(case, "my.csv"), "--edge", written).edge_d == 0.2


@pytest.mark.parametrize("written", ["0.3mm", "0.3 mm", "3e-4 m", "0.1,0.2", "5%"])
def test_a_length_is_no_number_of_diameters(case, capsys, written):
    name = table(case, "my.csv")
    for command in (
        ("fit", name, "--law", "eq4_exponential", "--edge", written),
        ("impacts", "gondret2002_st152", "--film", written),
    ):
        with pytest.raises(SystemExit) as left:
            case(*command)
        err = capsys.readouterr().err
        assert left.value.code == 2
        assert "diameters" in err
        assert ("length" in err) == ("m" in written)
        assert len(err.strip().splitlines()) == 1


def test_a_length_as_the_edge_of_a_case_is_told_apart_from_diameters(case):
    text = 'base = "gondret_st152_10_measured"\n[contact]\nmode = "effective"\nedge_d = "0.3 mm"\n'
    (case.folder / "mine.toml").write_text(text)
    status, _, err = case("bounce", "mine.toml")
    assert status == 2
    assert "contact.edge_d" in err
    assert "diameters" in err


def test_speeds_that_know_no_edge_have_none(case):
    assert fitted(case, table(case, "my.csv", speed="contact")).edge_d is None
    status, _, err = case("predict", "fit.json", *PAIR, "--speed", "0.5", "--edge", "0.2")
    assert status == 2
    assert "far" in err


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--edge", "0.2"), "another: 0.3"),
        (("--edge", "3"), "--edge"),
        (("other.csv",), "film_edge_d"),
    ],
)
def test_edges_that_do_not_agree_are_refused(case, arguments, named):
    table(case, "other.csv", "0.2")
    status, _, err = case("fit", table(case, "my.csv", "0.3"), *arguments, "--law", "eq4_exponential")
    assert status == 2
    assert named in err
    assert len(err.strip().splitlines()) == 1


def test_a_prediction_at_another_edge_is_the_fit_converted(case):
    K = fitted(case, table(case, "my.csv")).values["K"]
    c = datasets.resource("gondret2002_st152").conditions
    status, out, err = case("predict", "fit.json", *PAIR, "--speed", "0.585", "--edge", "0.3")
    assert status == 0, err
    row = next(line.split() for line in out.splitlines() if line.startswith("0.585"))
    per_speed = 7800 * 3e-3 / (9 * 0.01)
    by_law = restitution_at(c, 0.585, 0.3, 0.1, lambda v: 0.97 * np.exp(-K * 1.97 / (v * per_speed)))
    assert float(row[2]) == pytest.approx(by_law, abs=6e-4)
    assert float(row[3]) < by_law < float(row[5])
    assert by_law < 0.97 * np.exp(-K * 1.97 / (0.585 * per_speed)) - 0.05


def test_a_prediction_at_another_edge_needs_fluid_and_sphere(case):
    fitted(case, table(case, "my.csv"))
    status, _, err = case("predict", "fit.json", "--st", "100", "--e-dry", "0.97", "--edge", "0.3")
    assert status == 2
    assert "--fluid" in err
    assert case("predict", "fit.json", "--st", "100", "--e-dry", "0.97", "--edge", "0.1")[0] == 0


def test_a_track_is_fitted_at_the_edge_that_is_asked_for(case):
    arguments = ("--trajectory", "li2012_drop5", "--wake", "off")
    near, wide = fitted(case, *arguments), fitted(case, *arguments, "--edge", "0.2")
    assert (near.edge_d, wide.edge_d) == (0.1, 0.2)
    assert wide.values["K"] > near.values["K"] + 1
    impacts = {point.source for point in wide.points}
    assert impacts == {"li2012_drop5"}


def test_impacts_of_a_track_state_their_edge(case):
    case("impacts", "gondret2002_st152", "--film", "0.2", "--out", "far.csv")
    case("impacts", "gondret2002_st152", "--speed", "contact", "--out", "contact.csv")
    assert fitted(case, "far.csv").edge_d == 0.2
    assert fitted(case, "contact.csv").edge_d is None
    assert json.loads((case.folder / "fit.json").read_text())["edge_d"] is None
