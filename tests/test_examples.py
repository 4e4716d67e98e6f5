"""Every example runs, and what it finds is so by physics or by numbers that others published."""

import ast
import math
import runpy
from pathlib import Path

import numpy as np
import pytest

from restitution import datasets
from restitution.stokes import convention

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
MOST_LINES = 40

# Gondret's 3 mm sphere as read from the record by others (data/datapackage.json, `quoted`): m, s, m/s.
APEXES, FLIGHTS, APPROACH = (7.469e-3, 2.234e-3, 0.529e-3), (0.084, 0.046, 0.022), 0.586
FREE_FALL = 9.81 * (7800 - 935) / (7800 + 935 / 2)
"""Acceleration in m/s2 of that sphere with its added mass in free fall, drag apart."""


def legendre(St, beta=35.0):
    """Published correlation of e_eff for the 3 mm sphere at the plain Stokes number."""
    return 0.97 * np.exp(-beta / (np.asarray(St) * (1 + 0.5 * 935 / 7800)))


def impacts_of_a_track(found):
    # The quoted approach speed is a mean; frames of 2 ms place a contact to about half a frame.
    assert found["impact_speed_m_s"][0] == pytest.approx(APPROACH, rel=0.02)
    assert found["stokes"][0] == pytest.approx(152, rel=0.02)
    np.testing.assert_allclose(np.diff(found["time_s"]), FLIGHTS[:2], atol=1e-3)
    # A sphere comes down no faster than it rose.
    assert np.all(found["e_eff"] * found["impact_speed_m_s"] > np.append(found["impact_speed_m_s"][1:], 0))
    # Rebounds of different materials and laboratories scatter by about 0.1 around the published correlation.
    np.testing.assert_allclose(found["e_eff"], legendre(found["stokes"]), atol=0.1)


def fit_a_law_to_impacts(found):
    """The slope of ln(e/e_dry) over 1/St*, by least squares in closed form; without errors of St and limits."""
    seen = found["impacts"].query("outcome == 'rebound'")
    x = -1 / seen.stokes.to_numpy(float)
    y = np.log((seen.e_eff / seen.e_dry).to_numpy(float))
    weight = (seen.e_eff / seen.e_eff_sigma).to_numpy(float) ** 2
    by_hand = np.sum(weight * x * y) / np.sum(weight * x**2)
    assert found["beta"] == pytest.approx(by_hand, rel=0.1)
    (low, high), (lowest, highest) = found["intervals"]["68%"], found["intervals"]["95%"]
    assert lowest < low < by_hand < high < highest


def fit_a_law_to_a_track(found):
    e, v = found["e"], APPROACH
    for k, apex in enumerate(APEXES[:3]):
        assert e[k] * v > math.sqrt(2 * FREE_FALL * apex)  # at the least, what the rise takes without drag
        v = math.sqrt(2 * FREE_FALL * apex)  # and at the most, what the fall gives
    assert np.all(np.diff(e) < 0)
    low, high = found["intervals"]["95%"]
    assert low < found["K"] < high
    assert found["apex"] == pytest.approx(APEXES[0], rel=0.05)
    assert found["rms_d"] < 0.1


def predict_another_pair(found):
    assert found["stokes"] == pytest.approx(27, abs=0.5)  # as quoted of that experiment
    law, impact = found["law"], found["one_impact"]
    assert impact[0] < law[0] < found["e_eff"] < law[1] < impact[1]
    assert law[0] < found["measured"] < law[1]
    assert impact[0] > 0
    assert impact[1] < 0.97


def a_law_of_your_own(found):
    likelihood = found["log_likelihood"]
    # Eq. (4) is the formula with n = 1: a parameter more cannot fit worse, and by Wilks tells nothing below 1.92.
    gain = likelihood["my own"] - likelihood["eq4_exponential"]
    assert -1e-3 < gain < 1.92
    assert found["interval"][0] < 1 < found["interval"][1]
    # With one ratio of densities (8.3) and others near 6.5, St* is St by a factor of 1.06 to 1.08: one curve.
    assert likelihood["eq4_exponential"] == pytest.approx(likelihood["legendre_2005"], abs=0.5)
    assert found["told_apart"] == []


def bounce_of_a_point_particle(found):
    for model in found.values():
        assert model["imbalance"] < 1e-4
        assert np.all(np.diff(model["apexes"]) < 0)
    literature, alone, wake = found["Legendre"], found["Eq. (4)"], found["Eq. (4), wake"]
    assert literature["apexes"][0] == pytest.approx(APEXES[0], rel=0.05)
    # Nothing is chosen on this record: too high without the wake, less too low with it.
    assert wake["apexes"][0] < APEXES[0] < alone["apexes"][0]
    assert wake["rms_d"] < 0.5 * alone["rms_d"]


def bounce_with_the_flow_resolved(found):
    first = found["contacts"][0]
    assert first.speed_out_m_s / first.speed_in_m_s == pytest.approx(0.97, rel=1e-4)  # dry, as measured in air
    simulated, measured = found["simulated"], found["measured"]
    assert measured.apexes_m[0] == pytest.approx(APEXES[0], rel=0.005)
    # Six cells a diameter and a short way: the lattice's compressibility takes a sixth of the first apex.
    assert 0.8 < simulated.apexes_m[0] / APEXES[0] < 1.05
    assert simulated.apexes_m[0] < first.speed_out_m_s**2 / (2 * FREE_FALL)
    # A parabola's time of flight; drag shortens the rise and draws out the fall.
    for flown in (simulated, measured):
        assert flown.intervals_s[0] == pytest.approx(math.sqrt(8 * flown.apexes_m[0] / FREE_FALL), rel=0.05)
    # Newton's second law in flight: gravity less buoyancy and the fluid's force make the change of momentum.
    flight = found["motion"].query("0.02 < time_s < 0.06")
    volume, time = math.pi * 3e-3**3 / 6, flight.time_s.to_numpy()
    impulse = np.sum(flight.force_z_N[1:]) * (time[1] - time[0])
    impulse -= (7800 - 935) * volume * 9.81 * (time[-1] - time[0])
    assert impulse == pytest.approx(7800 * volume * (flight.vz_m_s.iloc[-1] - flight.vz_m_s.iloc[0]), rel=1e-3)


def drag_of_a_held_sphere(found):
    # The force balance of a steady flow; the rest is that the sphere's cells are not quite its volume.
    assert found["drag_over_push"] == pytest.approx(1, abs=5e-3)
    # Eight cells a diameter: the place of the surface is good to some hundredths of a cell, the drag to 2 %.
    assert found["drag"] == pytest.approx(found["hasimoto"], rel=0.025)
    # Zick & Homsy, J. Fluid Mech. 115 (1982) 13, simple cubic: K = 2.008 at 0.027 and 2.810 at 0.064 solid.
    assert 2.008 < found["drag"] < 2.810


def settling_sphere(found):
    # The measured speed is good to 2 or 3 %, by the reading of the figure.
    assert found["greatest_speed"] == pytest.approx(0.0873, rel=0.03)
    assert found["greatest_speed"] < 0.091  # the walls of the tank hold it back
    assert 0.015 < found["fallen"] < 0.12


def score_a_trajectory(found):
    measured, simulated = found["measured"], found["simulated"]
    conditions = datasets.resource("gondret2002_st152").conditions
    apexes, flights = (
        [measured[label.format(n)] for n in (1, 2, 3)] for label in ("apex {}, mm", "flight {}, ms")
    )
    np.testing.assert_allclose(apexes, 1e3 * np.array(APEXES[:3]), rtol=0.01)
    np.testing.assert_allclose(flights, 1e3 * np.array(FLIGHTS[:3]), atol=1)
    # Biegert et al. state the impact speed 0.585 m/s, and show the first two apexes on the symbols.
    assert simulated["approach, m/s"] == pytest.approx(0.585, rel=0.02)
    np.testing.assert_allclose([simulated[f"apex {n}, mm"] for n in (1, 2)], apexes[:2], rtol=0.07)
    for values in (measured, simulated):
        for n in (1, 2):
            flight = 1e3 * np.sqrt(8e-3 * values[f"apex {n}, mm"] / FREE_FALL)
            assert values[f"flight {n}, ms"] == pytest.approx(flight, rel=0.05)
    St = simulated["approach, m/s"] * convention("st").per_speed(conditions)
    assert simulated["e 1"] == pytest.approx(float(legendre(np.array([St]))[0]), abs=0.1)
    apart = abs(measured["apex 1, mm"] - simulated["apex 1, mm"]) / 3
    assert apart / 3 < simulated["rms, d"] < 3 * apart  # an rms over flights that differ by so much at their tops


def calibrate_another_solver(found):
    """The record was made with known numbers; the height and the time of a flight tell both of them."""
    for low, high, true in found.values():
        assert low < true < high
    assert found["e"][1] - found["e"][0] < 0.02


CHECKS = {
    "01": impacts_of_a_track, "02": fit_a_law_to_impacts, "03": fit_a_law_to_a_track, "04": predict_another_pair,
    "05": a_law_of_your_own, "06": bounce_of_a_point_particle, "07": bounce_with_the_flow_resolved,
    "08": drag_of_a_held_sphere, "09": settling_sphere, "10": score_a_trajectory,
    "11": calibrate_another_solver,
}  # fmt: skip


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_what_an_example_finds_is_so(example, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = runpy.run_path(str(example))["main"]()
    assert capsys.readouterr().out
    CHECKS[example.stem[:2]](found)
    assert list(tmp_path.iterdir()) == []  # nothing is left behind


def test_every_example_is_checked():
    assert [path.stem[:2] for path in EXAMPLES] == list(CHECKS)


def lines_of_code(path):
    """Lines that are neither blank nor comment nor within a docstring."""
    text = path.read_text("utf-8")
    docstrings = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.FunctionDef) and ast.get_docstring(node):
            docstrings |= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    lines = enumerate(text.splitlines(), 1)
    return sum(n not in docstrings and not line.lstrip().startswith("#") for n, line in lines if line.strip())


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_fits_on_a_screen(example):
    assert lines_of_code(example) <= MOST_LINES


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_says_its_task_and_its_source(example):
    docstring = ast.get_docstring(ast.parse(example.read_text("utf-8")))
    assert docstring.startswith("Task:")
    assert "Printed" in docstring
    assert "Source:" in docstring


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_needs_nothing_but_the_faces(example):
    """No import lies deeper than a package or a module that stands in it, but for the fits to whole tracks."""
    tree = ast.walk(ast.parse(example.read_text("utf-8")))
    own = [
        n.module
        for n in tree
        if isinstance(n, ast.ImportFrom) and n.module.split(".")[0] in ("restitution", "lbm")
    ]
    assert {m for m in own if m.count(".") > 1} <= {"restitution.calibration.trajectories"}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_the_readme_names_it(example):
    assert f"examples/{example.name}" in (ROOT / "README.md").read_text("utf-8")
