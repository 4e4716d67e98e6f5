"""Times of contact and apexes alone: closed forms without drag, an independent integration with it, bad input."""

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from restitution import datasets, laws
from restitution.bounce import Closures, Release, bounce
from restitution.cli import main
from restitution.conditions import Conditions
from restitution.flights import Flights, drag, free, impacts_of
from restitution.laws.drag import STANDARD
from restitution.tables import check_table
from tests.flights import STEEL_IN_OIL

G_EFF = 9.81 * (7800 - 935) / (7800 + 935 / 2)
"""Free fall with buoyancy and half the displaced mass, m/s2."""


def test_without_drag_speeds_are_those_of_throws_and_e_the_ratio_of_times():
    """A ball leaves at 2.0, 1.5, 0.9 m/s: T = 2 v/g, h = v^2/(2 g), dropped from v^2/(2 g) of 2.5 m/s."""
    v, g = np.array([2.5, 2.0, 1.5, 0.9]), 9.81
    contacts = np.cumsum([0.0, v[0] / g, *(2 * v[1:] / g)])
    heights = v**2 / (2 * g)
    for kind, numbers, values in (("times", np.arange(5), contacts), ("apexes", np.arange(4), heights)):
        before, after = free.speeds(kind, numbers, values, g)
        np.testing.assert_allclose(before[:3], v[:3], rtol=1e-12)
        np.testing.assert_allclose(after[:3], v[1:], rtol=1e-12)
    before, after = free.speeds("times", np.arange(1, 5), contacts[1:], g)
    assert np.isnan(before[0])
    np.testing.assert_allclose(after[1:3] / before[1:3], [1.5 / 2.0, 0.9 / 1.5], rtol=1e-12)


def integrated(e, height, conditions=STEEL_IN_OIL):
    """Contacts and apexes of a fall from rest by Schiller and Naumann's drag and added mass, no more."""
    rho_f, mu = conditions.fluid.density, conditions.fluid.viscosity
    d, rho_p = conditions.sphere.diameter, conditions.sphere.density
    volume = np.pi * d**3 / 6
    inertia = (rho_p + rho_f / 2) * volume

    def motion(_, state):
        v = state[1]
        Re = rho_f * abs(v) * d / mu
        # The law of drag is the one that is stated; beyond Schiller and Naumann's range the standard one.
        drag = 1 + 0.15 * Re**0.687 if Re < 800 else Re / 24 * float(STANDARD()(Re))
        force = -3 * np.pi * mu * d * v * drag
        return [v, (force - (rho_p - rho_f) * volume * 9.81) / inertia]

    def hit(_, state):
        return state[0]

    def top(_, state):
        return state[1]

    hit.terminal, hit.direction, top.direction = True, -1, -1
    t, h, v, contacts, apexes, speeds = 0.0, height, 0.0, [0.0], [height], []
    for restitution in (*e, None):
        found = solve_ivp(motion, (t, t + 5), [h, v], events=[hit, top], rtol=1e-11, atol=1e-14)
        if len(contacts) > 1:
            apexes.append(found.y_events[1][0][0])
        t, v_in = found.t[-1], -found.y[1, -1]
        contacts.append(t)
        speeds.append(v_in)
        if restitution is not None:
            h, v = 0.0, restitution * v_in
    return np.array(contacts), np.array(apexes), np.array(speeds)


def test_with_drag_an_independent_integration_gives_back_its_restitutions():
    e = (0.8, 0.7, 0.6)
    contacts, apexes, speeds = integrated(e, 0.03)
    # Within the film no viscous force acts: so thin, it takes no part.
    steady = laws.get("schiller_naumann_1935")
    closures = Closures(drag=steady, wall=None, added_mass="free", history=None, measured=(), film=1e-4)
    before, after = drag.speeds("times", np.arange(5), contacts, STEEL_IN_OIL, closures=closures)
    np.testing.assert_allclose(before, speeds, rtol=1e-4)
    np.testing.assert_allclose((after / before)[:3], e, rtol=2e-4)
    before, after = drag.speeds("apexes", np.arange(4), apexes, STEEL_IN_OIL, closures=closures)
    np.testing.assert_allclose(after / before, e, rtol=2e-4)
    without = np.divide(*free.speeds("times", np.arange(5), contacts, G_EFF)[::-1])
    assert np.all(without[:3] < np.array(e) - 0.03)  # drag in the flights, taken for a loss at the wall


def test_the_approach_matters_little_where_it_is_not_known():
    """Of a fall in the fluid of the model, its first contact heard alone: e within the error that is stated."""
    e = (0.8, 0.7, 0.6)
    path = bounce(STEEL_IN_OIL, Release(0.02), Closures(measured=e), 1.0)
    known = {"with history": Closures(measured=())}
    contacts = np.array([impact.time_s for impact in path.impacts])
    heard = Flights("times", np.arange(1, len(contacts) + 1), contacts, np.full(len(contacts), 1e-5))
    impacts = impacts_of(heard, STEEL_IN_OIL, models=known)
    assert [row["impact"] for row in impacts.rows] == [2, 3]
    for row, truth in zip(impacts.rows, e[1:], strict=True):
        assert abs(row["e_eff"] - truth) < 2 * row["e_eff_sigma"]
        assert row["e_eff_sigma"] < 0.02
    released = Flights("times", np.arange(len(contacts) + 1), np.array([0.0, *contacts]), np.full(5, 1e-5))
    found = [row["e_eff"] for row in impacts_of(released, STEEL_IN_OIL, models=known).rows]
    np.testing.assert_allclose(found, e, rtol=1e-5)


STEEL_IN_WATER = Conditions.model_validate(
    {
        "fluid": {"density": 998.0, "viscosity": 1e-3},
        "sphere": {"diameter": 5e-3, "density": 7800.0, "e_dry": 0.96},
    }
)


@pytest.mark.parametrize(
    ("conditions", "e", "height"),
    [(STEEL_IN_OIL, (0.8, 0.7, 0.55), 0.02), (STEEL_IN_WATER, (0.92, 0.9, 0.88), 0.03)],
)
@pytest.mark.parametrize("released", [True, False])
def test_which_forces_act_is_among_the_errors(conditions, e, height, released):
    """Flights by drag and added mass alone, at St 100 and 2000: two errors hold e, in oil the speed too; steel in
    water included, where the history force alone would need more than the elastic contact.
    """
    contacts, _, speeds = integrated(e, height, conditions)
    first = 0 if released else 1
    numbers = np.arange(first, len(contacts))
    heard = Flights("times", numbers, contacts[first:], np.full(len(numbers), 1e-5))
    found = impacts_of(heard, conditions)
    rows = {row["impact"]: row for row in found.rows}
    assert list(rows) == list(range(2 - released, len(e) + 1))
    for k, row in rows.items():
        assert abs(row["e_eff"] - e[k - 1]) < 2 * row["e_eff_sigma"]
    if conditions is STEEL_IN_OIL:  # in water the added mass beside the wall, left out here, moves speeds as much
        for k, row in rows.items():
            assert abs(row["impact_speed_m_s"] - speeds[k - 1]) < 2 * row["impact_speed_sigma_m_s"]
        assert all(low - 0.01 < e[k - 1] < high for k, (low, high) in zip(rows, found.forces, strict=True))


def test_errors_of_e_are_what_errors_of_the_times_make():
    sigma, e = 2e-4, 0.8
    T = 0.3 * e ** np.arange(5)
    true = np.cumsum([0.1, *T])
    rng = np.random.default_rng(1)

    def at(times):
        return impacts_of(Flights("times", np.arange(1, 7), times, np.full(6, sigma)), None).rows

    stated = np.array([row["e_eff_sigma"] for row in at(true)])
    drawn = np.array([[row["e_eff"] for row in at(true + sigma * rng.standard_normal(6))] for _ in range(400)])
    np.testing.assert_allclose(drawn.std(axis=0), stated, rtol=0.15)
    v, e_values = (np.array([row[name] for row in at(true)]) for name in ("impact_speed_m_s", "e_eff"))
    assert len(v) == len(e_values) == 4
    assert all(row["e_stokes_correlation"] < 0 for row in at(true))  # a longer flight before: faster, and less e


@pytest.fixture
def impacts(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.toml").write_text(
        "[fluid]\ndensity = 935.0\nviscosity = 0.01\n[sphere]\ndiameter = 3e-3\ndensity = 7800.0\ne_dry = 0.97\n"
    )
    (tmp_path / "t.csv").write_text("bounce,time_s\n0,0\n1,0.0756\n2,0.1512\n3,0.1976\n4,0.2243\n")
    (tmp_path / "ms.csv").write_text("impact;t (ms)\n0;0,0\n1;75,6\n2;151,2\n3;197,6\n4;224,3\n")
    (tmp_path / "a.csv").write_text("n,apex [mm]\n0,20\n1,5.5\n2,2.1\n3,0.7\n")

    def run(*arguments):
        status = main(["impacts", *arguments])
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


@pytest.mark.parametrize("more", [(), ("--no-drag",)])
@pytest.mark.parametrize("name", ["t.csv", "a.csv"])
def test_rows_are_impacts_that_a_fit_takes(impacts, tmp_path, name, more):
    sigma = "1e-4" if name == "t.csv" else "0.05"
    arguments = (name, "--conditions", "c.toml", "--sigma", sigma, "--out", "o.csv", *more)
    assert impacts(*arguments)[0] == 0
    assert check_table(tmp_path / "o.csv", datasets.schema("impact")) == []
    assert len(pd.read_csv("o.csv")) == 3
    assert main(["fit", "o.csv", "--law", "eq4_exponential"]) == 0


def test_other_units_names_and_decimal_commas_are_the_same_times(impacts):
    (status, plain, _), (_, milli, _) = (
        impacts(name, "--conditions", "c.toml", "--no-drag") for name in ("t.csv", "ms.csv")
    )
    assert status == 0
    assert plain.splitlines()[1:] == milli.splitlines()[1:]


@pytest.mark.parametrize(
    ("names", "cells"),
    [
        (["Start (s)", "Stop 1 (s)", "Stop 2 (s)", "Stop 3 (s)", "Stop 4 (s)"], "{0},{1},{2},{3},NaN"),
        (["Bounce 0 (s)", "Height 0 (m)", "Bounce 1 (s)", "Energy 1", "Bounce 2 (s)", "Bounce 3 (s)"],
         "{0},0.3,{1},0.5,{2},{3}"),
    ],
)  # fmt: skip
def test_a_stopwatch_writes_its_times_side_by_side(impacts, tmp_path, names, cells):
    times = ("0.1000", "0.3000", "0.4200", "0.4920")
    (tmp_path / "rows.csv").write_text("bounce,time_s\n" + "".join(f"{n},{t}\n" for n, t in enumerate(times, 1)))
    (tmp_path / "side.csv").write_text(
        ",".join(f'"{name}"' for name in names) + "\n" + cells.format(*times) + "\n"
    )
    (status, rows, _), (_, side, _) = (impacts(name, "--no-drag") for name in ("rows.csv", "side.csv"))
    assert status == 0
    assert rows.splitlines()[1:] == side.splitlines()[1:]


@pytest.mark.parametrize(
    ("text", "row"),
    [
        ("bounce,time_s\n1,0.1\n2,0.3\n3,0.25\n4,0.5\n", 4),
        ("bounce,time_s\n1,0.1\n1,0.3\n3,0.45\n", 3),
        ("bounce,apex_m\n1,0.1\n2,-0.05\n3,0.02\n", 3),
        ("bounce,time_s\n1,0.1\n2,abc\n3,0.45\n", 3),
    ],
)
def test_what_is_no_succession_of_bounces_is_refused_by_its_row(impacts, tmp_path, text, row):
    (tmp_path / "bad.csv").write_text(text)
    status, out, error = impacts("bad.csv", "--conditions", "c.toml")
    assert (status, out) == (2, "")
    assert error.startswith(f"error: bad.csv:{row}:")
    assert len(error.splitlines()) == 1


def test_a_unit_that_is_not_stated_is_asked_for_and_two_contacts_are_too_few(impacts, tmp_path):
    (tmp_path / "u.csv").write_text("bounce,time\n1,100\n2,300\n3,400\n")
    assert "--time-unit" in impacts("u.csv")[2]
    assert impacts("u.csv", "--time-unit", "ms")[0] == 0
    (tmp_path / "two.csv").write_text("bounce,time_s\n1,0.1\n2,0.3\n")
    assert impacts("two.csv")[0] == 2


def test_a_flight_longer_than_the_one_before_and_a_wrong_unit_are_doubted(impacts, tmp_path):
    (tmp_path / "up.csv").write_text("bounce,time_s\n1,0.1\n2,0.2\n3,0.35\n4,0.45\n")
    status, out, _ = impacts("up.csv")
    assert status == 0
    assert "doubt" in out
    assert "doubt" not in impacts("t.csv")[1]
    assert "--time-unit" in impacts("ms.csv", "--conditions", "c.toml", "--no-drag", "--time-unit", "0.1s")[1]


def test_a_missing_bounce_costs_the_flights_beside_it_alone(impacts, tmp_path):
    (tmp_path / "m.csv").write_text("bounce,time_s\n1,0.1\n2,0.2\n4,0.35\n5,0.38\n6,0.40\n")
    found = impacts("m.csv")[1]
    assert [line.split()[0] for line in found.splitlines() if line[:6].strip().isdigit()] == ["5"]
