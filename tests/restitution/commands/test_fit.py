"""``restitution fit``, ``compare``, ``predict`` and ``design`` as a user meets them."""

import itertools
import json
import math
import re
import subprocess
import sys
import warnings

import numpy as np
import pandas as pd
import pytest

from restitution.calibration.result.design import candidates
from restitution.calibration.result.fit_file import read_fit
from restitution.cli import main
from tests.fits import K

HEADER = "stokes,stokes_convention,speed_definition,e_dry,e_eff,e_eff_sigma\n"


@pytest.fixture
def case(tmp_path, capsys, monkeypatch):
    """A folder; ``run`` gives status, stdout and stderr of a command there."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            status = main(list(arguments))
        out = capsys.readouterr()
        return status, out.out, out.err

    run.folder = tmp_path
    return run


def rows(n=12, seed=0, sigma=0.01, K=K, scatter=0.0):
    """Rows of a table from eq4_exponential at e_dry = 0.97, with noise."""
    rng = np.random.default_rng(seed)
    St = np.geomspace(20, 400, n)
    e = 0.97 * np.exp(-K * 1.97 / St) + np.hypot(sigma, scatter) * rng.standard_normal(n)
    return [f"{s:.4f},st,far,0.97,{x:.5f},{sigma}" for s, x in zip(St, e, strict=True)]


def write(case, lines, name="my.csv", header=HEADER):
    (case.folder / name).write_text(header + "\n".join(lines) + "\n")
    return name


def test_template_filled_with_thirty_rows_fits_and_covers(case):
    assert case("fit", "--template", "start")[0] == 0
    template = pd.read_csv(case.folder / "start" / "impacts.csv")
    rng = np.random.default_rng(4)
    covered = {"68%": 0, "95%": 0}
    for trial in range(8):
        St = np.exp(rng.uniform(np.log(15), np.log(400), 30))
        e = 0.97 * np.exp(-K * 1.97 / St) + np.hypot(0.02, 0.03) * rng.standard_normal(30)
        seen = e > 0.05
        table = pd.DataFrame(
            {
                "source": "my laboratory",
                "material": "steel",
                "speed_definition": "far",
                "stokes_convention": "st",
                "stokes": (St * (1 + 0.02 * rng.standard_normal(30))).round(3),
                "stokes_sigma": (0.02 * St).round(4),
                "e_dry": 0.97,
                "e_eff": np.where(seen, e.round(4), np.nan),
                "e_eff_sigma": np.where(seen, 0.02, np.nan),
                "outcome": np.where(seen, "rebound", "no_rebound"),
                "e_eff_upper": np.where(seen, np.nan, 0.05),
                "note": "",
            }
        )[list(template.columns)]
        table.to_csv(case.folder / "filled.csv", index=False)
        status, out, _ = case("fit", "filled.csv", "--law", "eq4_exponential", "--out", f"fit{trial}.json")
        assert (status, "K" in out) == (0, True)
        (found,) = [p for p in read_fit(case.folder / f"fit{trial}.json").parameters if p.name == "K"]
        assert abs(found.value - K) < 4 * found.sigma
        for level, (low, high) in found.intervals.items():
            covered[level] += low <= K <= high
    assert covered["95%"] >= 6  # fewer has a probability of 0.6 %
    assert covered["68%"] >= 2


def test_the_template_itself_fits(case):
    case("fit", "--template", ".")
    status, out, _ = case("fit", "impacts.csv")
    assert (status, "1 without" in out) == (0, True)
    assert case("fit", "--template", ".")[0] == 2  # replaces nothing


def test_the_record_is_json_that_anyone_can_read(case):
    name = write(case, rows(scatter=0.03))
    assert case("fit", name, "--out", "fit.json")[0] == 0
    record = json.loads((case.folder / "fit.json").read_text(), parse_constant=lambda x: pytest.fail(x))
    import hashlib

    assert record["files"][name] == hashlib.sha256((case.folder / name).read_bytes()).hexdigest()
    assert record["stokes_convention"] == "st"
    assert len(record["points"]) == 12
    for point in record["points"]:
        assert point["pull"] * point["sigma"] == pytest.approx(point["e_eff"] - point["predicted"])
    result = read_fit(case.folder / "fit.json")
    assert result.to_json() == (case.folder / "fit.json").read_text()


def test_prediction_and_its_range(case):
    name = write(case, rows(sigma=0.005))
    case("fit", name, "--out", "fit.json")
    pair = ["--fluid", "density=935,viscosity=0.01", "--sphere", "diameter=0.003,density=7800,e_dry=0.97"]
    status, out, err = case("predict", "fit.json", *pair, "--speed", "0.5")
    assert status == 0
    assert "sources" in err  # one laboratory tells nothing of the next
    St, e = (float(x) for x in out.splitlines()[-1].split()[1:3])
    assert St == pytest.approx(7800 * 0.5 * 0.003 / (9 * 0.01), rel=1e-3)  # by hand
    assert e == pytest.approx(0.97 * np.exp(-K * 1.97 / St), abs=0.01)
    assert "outside the calibrated range" in case("predict", "fit.json", *pair, "--speed", "5")[2]
    assert case("predict", "fit.json")[0] == 2
    assert case("predict", name)[0] == 2


def test_design_prefers_where_the_law_is_sensitive(case):
    name = write(case, rows(sigma=0.005))
    case("fit", name, "--out", "fit.json")
    status, out, _ = case("design", "fit.json", "--rows", "1", "--plot", "gain.svg")
    assert status == 0
    # dK narrows most where |df/dK| = 1.97 f/St is greatest: St = 1.97 K, by hand
    St = float(out.splitlines()[3].split()[-5])
    assert St == pytest.approx(1.97 * K, rel=0.1)
    assert (case.folder / "gain.svg").stat().st_size > 1000
    for options in (["--parameter", "beta"], ["--at", "0"], ["--at", "1e-3"], ["--e-dry", "3"], ["--rows", "0"]):
        assert case("design", "fit.json", *options)[0] == 2, options


def test_design_lists_each_pair_once_and_each_condition_once(case):
    name = write(case, rows(sigma=0.005))
    case("fit", name, "--out", "fit.json")
    _, out, _ = case("design", "fit.json", "--rows", "999")
    pairs = [re.match(r".* mm ", line)[0].split() for line in out.splitlines()[3:]]
    assert len(pairs) == len({tuple(pair) for pair in pairs}) > 20
    for one, other in itertools.pairwise(candidates()):
        if (one.fluid, one.sphere) == (other.fluid, other.sphere):
            assert other.speed > 1.02 * one.speed


@pytest.mark.parametrize("place", ["nowhere/fit.json", "my.csv", "."])
def test_what_cannot_be_written_is_named_as_the_user_named_it(case, place):
    name = write(case, rows())
    before = (case.folder / name).read_bytes()
    laws = ["--law", "eq4_exponential", "--out", place]
    for command in ("fit", "compare"):
        status, out, error = case(command, name, *laws)
        assert (status, out) == (2, "")
        assert error.startswith(f"error: {place}: ")
        assert ".part" not in error
    assert (case.folder / name).read_bytes() == before
    assert [p.name for p in case.folder.iterdir()] == [name]


def test_compare_finds_the_law_and_says_when_it_cannot(case):
    name = write(case, rows(40, sigma=0.01))
    options = [
        "--law",
        "eq4_exponential",
        "--law",
        "eq4_linear",
        "--law",
        "e_dry*exp(-b/St)",
        "--bounds",
        "b=1:99",
    ]
    status, out, _ = case("compare", name, *options, "--out", "ranking.csv", *("--offsets", "none"))
    assert status == 0
    table = pd.read_csv(case.folder / "ranking.csv").set_index("law")
    assert table.loc["eq4_linear", "separated"] == "yes"
    # The same curve under another name: nothing can separate them.
    assert "do not separate: " in out
    assert abs(table.loc["eq4_exponential", "aic"] - table.loc["e_dry*exp(-b/St)", "aic"]) < 0.1


def test_own_formula_and_posterior(case):
    name = write(case, rows(scatter=0.02))
    law = ["--law", "e_dry*exp(-(a/St)**n)", "--bounds", "a=5:100", "--bounds", "n=0.2:4"]
    assert case("fit", name, *law, "--out", "fit.json", "--posterior", "--seed", "7")[0] == 0
    result = read_fit(case.folder / "fit.json")
    chain = result.posterior
    assert chain.seed == 7
    assert chain.steps > 50 * max(chain.autocorrelation_time)
    for p, median in zip(result.parameters[:2], chain.median, strict=False):
        assert abs(median - p.value) < p.sigma
    assert case("predict", "fit.json", "--st", "50", "--e-dry", "0.97")[0] == 0


def test_a_fit_is_the_prior_of_the_next_and_its_source_is_predicted(case):
    write(case, rows(seed=0), "a.csv")
    write(case, rows(seed=1), "b.csv")
    assert case("fit", "a.csv", "--out", "a.json")[0] == 0
    status, out, _ = case("fit", "b.csv", "--prior", "a.json", "--out", "b.json", "--start", "K=15")
    assert (status, "prior of K" in out) == (0, True)
    widths = [
        float(np.diff(read_fit(case.folder / f).parameters[0].intervals["68%"])[0]) for f in ("a.json", "b.json")
    ]
    assert widths[1] < 0.9 * widths[0]
    assert case("fit", "a.csv", "--prior", "a.json")[0] == 2
    assert case("fit", "b.csv", "--prior", "a.json", "--prior", "b.json")[0] == 2
    status, _, err = case("predict", "b.json", "--st", "50", "--e-dry", "0.97", "--source", "nobody")
    assert (status, "nobody" in err) == (2, True)


def test_tracks_and_shipped_records(case):
    case("impacts", "--template", ".")
    status, _, _ = case("fit", "track.csv", "--conditions", "conditions.toml", "--speed", "contact")
    assert status == 2  # one impact cannot determine a law and a scatter
    status, out, _ = case("fit", "gondret2002_st152", "li2012_drop5", "--speed", "contact", "--offsets", "none")
    assert (status, "7 with a rebound" in out) == (0, True)
    track = pd.read_csv(case.folder / "track.csv")
    columns = {"fluid_density_kg_m3": 935, "fluid_viscosity_Pa_s": 0.01, "sphere_diameter_m": 3e-3}
    track.assign(**columns, sphere_density_kg_m3=7800, e_dry=0.97).to_csv(case.folder / "own.csv", index=False)
    assert case("fit", "own.csv", "li2012_drop5", "--speed", "contact", "--offsets", "none")[0] == 0


def test_speeds_with_conditions_are_the_same_as_their_ratio(case):
    """St and e_eff from speeds, with the correlation that a common v_in brings."""
    v_in = np.array([0.05, 0.1, 0.2, 0.4, 0.8])
    per_speed = 7800 * 0.003 / (9 * 0.01)
    e = 0.97 * np.exp(-K * 1.97 / (v_in * per_speed))
    header = (
        "impact_speed_m_s,impact_speed_sigma_m_s,rebound_speed_m_s,rebound_speed_sigma_m_s,fluid_density_kg_m3,"
    )
    header += "fluid_viscosity_Pa_s,sphere_diameter_m,sphere_density_kg_m3,e_dry\n"
    lines = [f"{v},{0.02 * v},{v * x},{0.01 * v},935,0.01,0.003,7800,0.97" for v, x in zip(v_in, e, strict=True)]
    write(case, lines, header=header)
    status, _, error = case("fit", "my.csv")
    assert (status, "--speed" in error) == (2, True)
    assert case("fit", "my.csv", "--speed", "far", "--out", "fit.json")[0] == 0
    points = read_fit(case.folder / "fit.json").points
    for point, v, x in zip(points, v_in, e, strict=True):
        assert point.stokes == pytest.approx(v * per_speed)
        assert point.e_eff == pytest.approx(x)
        assert point.e_eff_sigma == pytest.approx(np.hypot(0.01, 0.02 * x))


def table(*lines, header=HEADER):
    return header + "\n".join(lines) + "\n"


GOOD = rows()
LIMITS = HEADER.replace("e_eff,e_eff_sigma", "outcome,e_eff_upper")
BAD = {
    "fewer points than parameters": (table(*GOOD[:1]), [], "fewer"),
    "all censored": (
        table("5,st,far,0.97,no_rebound,0.1", "6,st,far,0.97,no_rebound,0.1", header=LIMITS),
        [],
        "no impact has a rebound",
    ),
    "identical St": (table(*(r.replace(r.split(",")[0], "50") for r in GOOD)), [], "same Stokes number"),
    "e above 1": (table(*GOOD, "300,st,far,0.97,1.2,0.01"), [], "--allow-unphysical"),
    "e negative": (table(*GOOD, "30,st,far,0.97,-0.01,0.01"), [], "--allow-unphysical"),
    "sigma zero": (table(*GOOD, "30,st,far,0.97,0.3,0"), [], "must be positive"),
    "sigma negative": (table(*GOOD, "30,st,far,0.97,0.3,-0.1"), [], "must be positive"),
    "infinite likelihood at the start": (
        table(*GOOD),
        ["--law", "e_dry*sqrt(St - a)/St", "--bounds", "a=100:300"],
        "no finite value",
    ),
    "flat likelihood": (
        table(*GOOD),
        ["--law", "e_dry*exp(-a*b/St)", "--bounds", "a=1:10", "--bounds", "b=1:10"],
        "flat",
    ),
    "flat in one": (
        table(*GOOD),
        ["--law", "e_dry*exp(-a/St) + 0*b", "--bounds", "a=1:90", "--bounds", "b=0:1"],
        "flat",
    ),
    "stuck on its bound": (table(*GOOD), ["--bounds", "K=0:10"], "stuck on its upper bound"),
    "mixed conventions": (table(*GOOD, "30,st_star,far,0.97,0.3,0.01"), [], "one definition"),
    "mixed speeds": (table(*GOOD, "30,st,contact,0.97,0.3,0.01"), [], "one definition"),
    "no convention": (table(*(r.replace(",st,", ",,") for r in GOOD)), [], "--stokes"),
    "no speed": (table(*(r.replace(",far,", ",,") for r in GOOD)), [], "--speed"),
    "unknown column": (table("1,2", header="stokes,bounce\n"), [], "not a column"),
    "unknown mapped column": (table(*GOOD), ["--column", "bounce=e_eff"], "not a column"),
    "unknown parameter": (table(*GOOD), ["--fix", "beta=3"], "not a parameter"),
    "unknown law": (table(*GOOD), ["--law", "eq4_exponentail"], "eq4_exponential"),
    "a law of another convention": (table(*GOOD), ["--law", "legendre_2005"], "--conditions"),
    "e_dry nowhere": (table("30,0.3", header="stokes,e_eff\n"), ["--stokes", "st", "--speed", "far"], "e_dry"),
    "no errors and no scatter": (
        table("30,0.3", "60,0.5", "90,0.6", header="stokes,e_eff\n"),
        ["--stokes", "st", "--speed", "far", "--e-dry", "0.97", "--no-scatter"],
        "no error",
    ),
    "exact impacts without errors": (
        table(*(f"{s},{0.97 * math.exp(-19.7 / s)!r}" for s in (20, 40, 80, 160, 320)), header="stokes,e_eff\n"),
        ["--stokes", "st", "--speed", "far", "--e-dry", "0.97"],
        "--e-sigma",
    ),
    "unknown grouping": (table(*GOOD), ["--separate", "K=colour"], "colour"),
    "text": (table(*GOOD, "thirty,st,far,0.97,0.3,0.01"), [], "not a number"),
    "no e_eff": (table(*GOOD, "30,st,far,0.97,,"), [], "no_rebound"),
    "empty": ("", [], "empty"),
}  # fmt: skip


def test_an_error_for_all_that_state_none(case):
    """Exact impacts: K +- its error by sigma_e alone, sum (de/dK)^2 by hand; no law is ranked without an error."""
    St = (20.0, 40.0, 80.0, 160.0, 320.0)
    e = [0.97 * math.exp(-10 * 1.97 / s) for s in St]
    write(case, [f"{s},{x!r},0.97" for s, x in zip(St, e, strict=True)], header="stokes,e_eff,e_dry\n")
    stated = ["my.csv", "--stokes", "st", "--speed", "far"]
    assert case("compare", *stated)[0] == 2
    assert case("fit", *stated, "--e-sigma", "0")[0] == 2
    assert case("fit", *stated, "--e-sigma", "0.01", "--no-scatter", "--out", "fit.json")[0] == 0
    (K_found,) = read_fit(case.folder / "fit.json").parameters
    assert K_found.value == pytest.approx(10)
    information = sum((1.97 / s * x / 0.01) ** 2 for s, x in zip(St, e, strict=True))
    assert K_found.sigma == pytest.approx(information**-0.5, rel=1e-3)


def test_rows_filled_down_and_numbers_without_units_are_doubted(case):
    good = rows()
    write(case, [*good, *[good[3]] * 12])
    status, out, _ = case("fit", "my.csv", "--out", "fit.json")
    assert (status, "13 with St" in out) == (0, True)
    assert "13 with St" in case("compare", "my.csv", "--law", "eq4_exponential")[1]
    assert "13 with St" in case("data", "validate", "my.csv")[1]
    assert case("fit", "my.csv", "--strict")[0] == 2
    pair = ["--fluid", "density=935,viscosity=0.01", "--sphere"]
    status, out, _ = case("predict", "fit.json", *pair, "diameter=3,density=7800,e_dry=0.97")
    assert (status, "doubt: the sphere is 3 m" in out) == (0, True)
    assert "doubt" not in case("predict", "fit.json", *pair, "diameter=3 mm,density=7800,e_dry=0.97")[1]
    assert case("predict", "fit.json", *pair, "diameter=3,density=7800,e_dry=0.97", "--strict")[0] == 2


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_clear_line_and_nothing_is_written(case, kind):
    text, options, words = BAD[kind]
    (case.folder / "my.csv").write_text(text)
    status, out, error = case("fit", "my.csv", *options, "--out", "fit.json", "--report", "report")
    assert (status, out) == (2, "")
    assert words in error
    assert all(line.startswith("error: ") for line in error.splitlines())
    assert {p.name for p in case.folder.iterdir()} == {"my.csv"}


def test_all_defects_of_all_files_are_named_at_once(case):
    """By row: what the form of the table, and what the rules between its columns, have against it."""
    header = HEADER.strip() + ",outcome\n"
    wrong = [
        "30,st,far,0.97,1.3,0.01,",  # e_eff above 1
        "abc,st,far,0.97,0.3,0.01,",  # no number
        "30,st,contact,0.97,0.3,-1,",  # another speed, a negative error
        "30,st_star,far,0.97,,0.01,",  # another convention, no e_eff
        ",st,far,1.7,0.3,0.01,",  # no St, e_dry above 1
        "30,st,far,0.97,0.3,0.01,no_rebound",  # e_eff without a rebound
        "30,,far,0.97,0.3,0.01,bounced",  # no convention, no such outcome
        "30,st,far",
    ]
    write(case, ["152,st,far,0.97,0.8,0.01,", *wrong], "one.csv", header)
    write(case, ["152,st,far,0.97,-0.8,0.01"], "two.csv")
    status, _, error = case("fit", "one.csv", "two.csv", "three.csv")
    named = [re.match(r"error: (\w+).csv(?::(\d+))?(?:: (\w+))?", line).groups() for line in error.splitlines()]
    assert status == 2
    assert [(row, field) for file, row, field in named if file == "one"] == [
        ("3", "e_eff"), ("4", "stokes"), ("5", "e_eff_sigma"), ("5", "speed_definition"),
        ("6", "stokes_convention"), ("6", "e_eff"), ("7", "e_dry"), ("7", "stokes"), ("8", "e_eff"),
        ("9", "outcome"), ("9", "stokes_convention"), ("10", "has"),
    ]  # fmt: skip
    assert [file for file, _, _ in named][-2:] == ["two", "three"]


def test_a_file_counts_once(case):
    name = write(case, rows())
    status, _, error = case("fit", name, name)
    assert (status, "twice" in error) == (2, True)


def test_unphysical_restitution_with_the_flag(case):
    write(case, [*GOOD, "380,st,far,0.97,1.02,0.1"])
    assert case("fit", "my.csv", "--allow-unphysical")[0] == 0


def test_help_stays_quick():
    code = "import sys; from restitution.cli import build_parser; build_parser(); print([m for m in sys.modules "
    code += "if m in ('iminuit', 'emcee', 'numpy', 'pandas', 'scipy')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_simulated_impacts_are_fitted_apart_and_under_one_definition(tmp_path, capsys):
    """As 'simulate' and 'bounce' write them: three definitions of speed in one table."""
    head = "record,impact,kind,speed_definition,stokes_convention,stokes,stokes_sigma,e_dry,e_eff,e_eff_sigma\n"
    rows = [
        f"run,{i},simulated,{d},st,{St},1,0.97,{0.97 * math.exp(-20 * 1.97 / St) + shift:.4f},0.02\n"
        for i, St in enumerate((150, 80, 40, 25), 1)
        for d, shift in (("far", 0.0), ("contact", 0.05), ("window", -0.05))
    ]
    (tmp_path / "run.csv").write_text(head + "".join(rows))
    (tmp_path / "lab.csv").write_text(head + "".join(rows).replace("simulated", "measured").replace("run", "lab"))
    out = tmp_path / "fit.json"
    assert main(["fit", str(tmp_path / "run.csv"), "--speed", "far", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "simulated" in said
    assert "8 impacts under other definitions" in said
    fit = json.loads(out.read_text())
    K = next(p for p in fit["parameters"] if p["name"] == "K")
    assert K["value"] == pytest.approx(20, rel=0.02)
    assert main(["fit", str(tmp_path / "lab.csv"), str(tmp_path / "run.csv"), "--speed", "far"]) == 2
    assert "fit them apart" in capsys.readouterr().err
