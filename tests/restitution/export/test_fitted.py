"""Fits as exported: parameters, range and identity go along; edited and newer files are refused."""

import hashlib
import json
import re
from io import StringIO

import numpy as np
import pandas as pd
import pytest

from restitution.calibration import Plan, estimate, model_of, read, result_of
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.export import fit_closure
from restitution.export.languages import source_code
from restitution.export.tables import csv_table, json_record

GONDRET = Conditions.model_validate(
    {
        "fluid": {"density": 935.0, "viscosity": 0.01},
        "sphere": {"diameter": 0.003, "density": 7800.0, "e_dry": 0.97},
    }
)
OWN = "e_dry*exp(-(a/St)**n)"


@pytest.fixture(scope="module")
def fits(tmp_path_factory):
    """Fits of a law, of a law with e_dry free, of a formula of the user's own; by name, path and result."""
    folder = tmp_path_factory.mktemp("fits")
    impacts = read(["gondret2002_st152", "li2012_drop3", "li2012_drop5"], speed="contact")
    plans = {
        "law": Plan(model_of("eq4_exponential")),
        "free": Plan(model_of("legendre_2005"), e_dry="free"),
        "own": Plan(model_of(OWN, {"a": (1, 200), "n": (0.3, 3)}), e_dry="free"),
    }
    made = {}
    for name, plan in plans.items():
        result = result_of(estimate(plan, impacts))
        (folder / f"{name}.json").write_text(result.to_json())
        made[name] = folder / f"{name}.json", result
    return made


def generated(path) -> dict:
    space: dict = {"__name__": "generated"}
    exec(compile(source_code(fit_closure(path), "python"), "generated", "exec"), space)
    return space


def test_fitted_law_with_e_dry_as_argument(fits):
    path, result = fits["law"]
    space, K = generated(path), result.values["K"]
    for St in (25.0, 60.0, 150.0, 900.0):
        expected = 0.9 * np.exp(-K * 1.9 / St)
        assert space["eq4_exponential_fit"](St, 0.9) == pytest.approx(expected, rel=1e-13)
    assert space["self_check"]() == 0
    assert [space["eq4_exponential_fit_in_range"](St) for St in (20, 100, 200)] == [0, 1, 0]


def test_fitted_dry_restitution_is_a_constant(fits):
    path, result = fits["free"]
    beta, e_dry = result.values["beta"], result.values["e_dry"]
    assert generated(path)["legendre_2005_fit"](80.0) == pytest.approx(e_dry * np.exp(-beta / 80), rel=1e-13)


def test_formula_of_the_users_own(fits):
    path, result = fits["own"]
    v = result.values
    space = generated(path)
    expected = v["e_dry"] * np.exp(-((v["a"] / 40) ** v["n"]))
    assert space["own_formula_fit"](40.0) == pytest.approx(expected, rel=1e-13)
    assert space["own_formula_fit"](1e-300) == 0.0  # (a/St)^n overflows there
    assert space["self_check"]() == 0


def test_identity_goes_along(fits):
    path, result = fits["law"]
    text = source_code(fit_closure(path), "c").replace("\n//     ", " ")
    assert hashlib.sha256(path.read_bytes()).hexdigest() in text
    assert all(digest in text for digest in result.files.values())
    low, high = result.parameters[0].intervals["95%"]
    assert re.search(rf"K = [\d.]+ \(fitted\); 95 %: {low:.5g}.* to {high:.5g}", text)
    assert "reconstructed" in text


def test_table_has_the_interval_of_the_prediction(fits):
    from restitution.calibration import predict

    path, result = fits["law"]
    rows = pd.read_csv(StringIO(csv_table(fit_closure(path), GONDRET)), comment="#")
    speed = 7800 * 0.003 / (9 * 0.01)  # St over speed
    np.testing.assert_allclose(rows["stokes"], rows["impact_speed_m_s"] * speed, rtol=1e-8)
    np.testing.assert_allclose(
        rows["e_eff"], 0.97 * np.exp(-result.values["K"] * 1.97 / rows["stokes"]), rtol=1e-8
    )
    ends = predict(result, rows["stokes"].to_numpy(), e_dry=0.97).law["95%"]
    np.testing.assert_allclose(rows["e_eff_low_95"], np.clip(ends[:, 0], 0, 1), atol=1e-6)
    bare = csv_table(fit_closure(path), GONDRET, bare=True)
    assert "#" not in bare
    assert len(bare.splitlines()) == len(rows) + 1


def test_json_has_all(fits):
    record = json.loads(json_record(fit_closure(fits["own"][0])))
    assert record["formula"] == OWN
    assert {p["name"] for p in record["parameters"]} == {"a", "n", "e_dry"}
    assert len(record["self_check"]["values"]) >= 12


@pytest.mark.parametrize(
    ("edit", "named"),
    [
        (lambda fit: fit["parameters"][0].update(value=1.01 * fit["parameters"][0]["value"]), "edited by hand"),
        (lambda fit: fit["parameters"][0].update(value=150.0), "not about the estimate"),
        (lambda fit: fit["points"][2].update(predicted=0.5), "edited by hand"),
        (lambda fit: fit.update(format="restitution-fit/2"), "newer version"),
        (lambda fit: fit.update(remark="mine"), "remark"),
        (lambda fit: fit["law"].update(text="e_dry*exp(-2*K*(1 + e_dry)/St)"), r"law\.text"),
        (lambda fit: fit["law"].update(convention="st_star"), r"law\.convention"),
        (lambda fit: fit.update(stokes_convention="st_d"), "law_stokes_ratio"),
    ],
)
def test_edited_and_newer_files_are_refused(fits, tmp_path, edit, named):
    fit = json.loads(fits["law"][0].read_text())
    edit(fit)
    (tmp_path / "fit.json").write_text(json.dumps(fit))
    with pytest.raises(InputError, match=named):
        fit_closure(tmp_path / "fit.json")


@pytest.mark.parametrize("name", ["eq4_exponential", "e_dry*exp(-K*(1 + e_dry)/St)", None])
def test_a_fit_file_is_never_run(fits, tmp_path, monkeypatch, name):
    """The text of a formula comes to sympy, which evaluates it as Python: it has to be that of the law."""
    monkeypatch.chdir(tmp_path)
    fit = json.loads(fits["law"][0].read_text())
    bounds = {"K": [0, 200]} if name != "eq4_exponential" else {}
    fit["law"].update(name=name, bounds=bounds, text="__import__('pathlib').Path('run').touch()")
    (tmp_path / "fit.json").write_text(json.dumps(fit))
    with pytest.raises(InputError, match="law"):
        source_code(fit_closure("fit.json"), "c")
    assert not (tmp_path / "run").exists()


def test_rows_are_close_enough_to_interpolate_between():
    from restitution import laws
    from restitution.export import law_closure

    closure = law_closure(laws.get("legendre_2005"))
    rows = pd.read_csv(StringIO(csv_table(closure, GONDRET, bare=True)))
    St = np.geomspace(10, 1000, 5000)
    between = np.interp(St, rows["stokes"], rows["e_eff"])
    np.testing.assert_allclose(between, 0.97 * np.exp(-35 / St), atol=1e-3)


def test_separate_parameters_are_exported_one_level_at_a_time(tmp_path):
    impacts = read(["gondret2002_st152", "li2012_drop3"], speed="contact")
    plan = Plan(model_of("eq4_exponential"), separate={"K": "source"}, offsets=False)
    result = result_of(estimate(plan, impacts))
    (tmp_path / "fit.json").write_text(result.to_json())
    by_level = {
        p.name.partition("[")[2].rstrip("]"): p.value for p in result.parameters if p.name.startswith("K[")
    }
    assert len(by_level) == 2
    for level, K in by_level.items():
        closure = fit_closure(tmp_path / "fit.json", {"source": level})
        assert closure.value(60.0, 0.97) == pytest.approx(0.97 * np.exp(-K * 1.97 / 60), rel=1e-12)
    with pytest.raises(InputError, match="--of source="):
        fit_closure(tmp_path / "fit.json")
