"""One black box for both models: its edge, e_eff converted to it, e_eff of a record, what is refused."""

import math
import re

import pytest

from restitution import cases
from restitution.bounce.edges import at_edge, carried, restitution_at
from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories import read_recordings
from restitution.calibration.trajectories.whole_trajectories import whole_trajectory
from restitution.errors import InputError
from restitution.runs import closures
from restitution.runs.measured import measured_restitution
from restitution.runs.point_particle import closures_of, predict
from restitution.runs.resolved import ResolvedRun
from restitution.runs.setup import check_edge, set_up
from restitution.stokes import StokesNumber

pytestmark = pytest.mark.filterwarnings("ignore:relaxation time")  # of cases that are not run
EQ4 = {"law": "eq4_exponential", "measured": None}
UNIT = 11.7
"""Of speed, m/s: 0.585 m/s are 0.05 cells a step."""


def case_of(name="gondret_st152_10_measured", speed=0.025, **contact):
    case = cases.read_case(name)
    return case.model_copy(
        update={
            "contact": case.contact.model_copy(update=contact),
            "numerics": case.numerics.model_copy(update={"lattice_speed": speed}),
        }
    )


@pytest.mark.parametrize(
    ("contact", "edge"),
    [({}, 0.1), ({"edge_d": 0.3}, 0.3), ({"law_edge_d": 0.2}, 0.2), ({"edge_d": 0.3, "law_edge_d": 0.1}, 0.3)],
)
def test_the_edge_is_that_of_the_case_or_of_its_law(contact, edge):
    case = case_of(**EQ4, **contact)
    assert closures.edge_of(case) == edge
    assert closures_of(case).film == edge
    assert set_up(case).contact.edge == pytest.approx(10 * edge)


def test_both_models_are_given_the_same_restitution_of_a_law_of_another_edge():
    case = case_of(**EQ4, edge_d=0.3, law_edge_d=0.1)
    first = predict(case).path.impacts[0]
    through = at_edge(case.conditions, first.v_in, 0.3)
    on_lattice = (through**2 + 2 * case.conditions.free_fall * 0.3 * case.sphere.diameter) ** 0.5
    e = closures.rebound(case, UNIT)(on_lattice / UNIT, 0) / (on_lattice / UNIT)
    assert e == pytest.approx(first.e, rel=1e-6)
    own = closures_of(case_of(**EQ4)).rebound
    per_speed = 7800 * 3e-3 / 0.09

    def by_own(v):
        return float(own(StokesNumber(v * per_speed), 0.97))

    assert e == pytest.approx(restitution_at(case.conditions, first.v_in, 0.3, 0.1, by_own), rel=1e-6)
    assert carried(case.conditions, through, 0.3) == pytest.approx(first.v_in)


def test_e_of_a_record_is_that_of_its_whole_trajectory_under_the_model_its_frames_prefer():
    (record,) = read_recordings(["gondret2002_st152"], Reading())
    found = whole_trajectory(record, True, 0.2)
    expected = [mean for mean, _ in found.restitutions]
    # What runs are told is of an earlier model of drag and wake; the fit's own errors are 0.01.
    assert measured_restitution("gondret2002_st152", 0.2) == pytest.approx(expected, abs=0.03)
    assert measured_restitution("gondret2002_st152", 0.2, wake=False)[0] < expected[0] - 0.05


def test_measured_values_of_an_unknown_edge_or_record_are_refused():
    with pytest.raises(InputError, match=r"0\.05, 0\.1"):
        measured_restitution("gondret2002_st152", 0.17)
    with pytest.raises(InputError, match="no rebound"):
        measured_restitution("tencate2002_e1_gap", 0.1)


@pytest.mark.parametrize(("speed", "edge"), [(0.05, 0.1), (0.1, 0.2), (0.03, 0.1)])
def test_a_film_that_is_left_before_the_fluid_has_answered_is_refused(speed, edge):
    """e is 0.83 and 0.80: 0.1 d at 0.05 last 1.4 d/c_s, 0.2 d at 0.1 as long, 0.1 d at 0.03 2.3."""
    with pytest.raises(InputError) as error:
        check_edge(set_up(case_of(speed=speed, edge_d=edge)), "mine")
    assert error.value.defects[0].field == "numerics.lattice_speed"
    assert "contact.edge_d" in str(error.value)


@pytest.mark.parametrize("speed", [0.0331, 0.0377, 0.05, 0.07])
def test_what_is_advised_in_its_place_is_taken(speed):
    law = {**EQ4, "law_edge_d": 0.1}
    with pytest.raises(InputError) as error:
        check_edge(set_up(case_of(speed=speed, **law, edge_d=0.1)), "mine")
    slower, wider = re.search(r"Take ([\d.]+), or contact.edge_d = ([\d.]+)", str(error.value)).groups()
    assert 0.02 < float(slower) < speed
    check_edge(set_up(case_of(speed=float(slower), **law, edge_d=0.1)), "mine")
    check_edge(set_up(case_of(speed=speed, **law, edge_d=float(wider))), "mine")


@pytest.mark.parametrize(("speed", "edge"), [(0.025, 0.1), (0.05, 0.2), (0.0125, 0.05)])
def test_one_that_lasts_is_not(speed, edge):
    check_edge(set_up(case_of(speed=speed, edge_d=edge)), "mine")


def test_on_the_lattice_the_sphere_falls_freely_within_the_edge(tmp_path):
    text = """base = "gondret_st152_10_measured"
[release]
kind = "drive"
gap_d = 0.8
speed = 0.585
ramp = 0.001
[numerics]
cells_per_diameter = 6
width_d = 2.5
height_d = 7.5
[contact]
mode = "effective"
measured = [0.7]
edge_d = 0.2
[run]
after_contact = 0.004
"""
    (tmp_path / "mine.toml").write_text(text)
    case = cases.read_case(tmp_path / "mine.toml")
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()
    (contact,) = run.contacts
    assert contact.speed_out_m_s == pytest.approx(0.7 * contact.speed_in_m_s, rel=1e-9)
    motion, g = run.motion(), case.conditions.free_fall
    within = motion[(motion.gap_m < 0.18 * case.sphere.diameter) & (motion.gap_m > 0.02 * case.sphere.diameter)]
    for sign, speed in ((-1, contact.speed_in_m_s), (1, contact.speed_out_m_s)):
        leg = within[sign * within.vz_m_s > 0]
        assert len(leg) > 5
        assert (leg.vz_m_s**2 + 2 * g * leg.gap_m).to_numpy() == pytest.approx(speed**2, rel=1e-6)


def short_run(name, speed, **contact):
    """Motion of a sphere that goes 1.5 d at 10 cells each and 3 ms after its contact; the case; the contact."""
    case = case_of(name, speed, **contact)
    numerics = case.numerics.model_copy(update={"width_d": 4.0, "height_d": 5.0})
    release = case.release.model_copy(update={"gap_d": 1.5})
    span = case.run.model_copy(update={"after_contact": 0.003})
    case = case.model_copy(update={"numerics": numerics, "release": release, "run": span})
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()
    return run.motion(), case, run.contacts[0]


def e_at(motion, case, edge):
    """The ratio of the speeds at an edge, both carried to the wall by free fall."""
    height = edge * case.sphere.diameter
    fallen = 2 * case.conditions.free_fall * height
    first = motion[(motion.time_s < 0) & (motion.gap_m > height)].iloc[-1]
    last = motion[(motion.time_s > 0) & (motion.gap_m > height)].iloc[0]
    return math.sqrt((last.vz_m_s**2 + fallen) / (first.vz_m_s**2 + fallen))


def test_dry_restitution_under_a_resolved_film_is_that_of_the_point_particle():
    """At 10 cells a diameter and a lattice speed of 0.025, by the speeds at 0.1 and 0.2 d."""
    motion, case, _ = short_run("gondret_st152_10", 0.025)
    path = predict(case).table().rename(columns={"velocity_m_s": "vz_m_s"})
    for edge in (0.1, 0.2):
        assert e_at(motion, case, edge) == pytest.approx(e_at(path, case, edge), abs=0.01), edge


def test_e_eff_imposed_does_not_depend_on_the_lattice_speed():
    """Gap 3 ms after the contact over the speed there: what is left of the rebound is the fluid's."""
    found = []
    for speed in (0.05, 0.025):
        motion, _, contact = short_run("gondret_st152_10_measured", speed, measured=(0.8,), edge_d=0.2)
        found.append(motion.gap_m.iloc[-1] / contact.speed_in_m_s)
    assert found[0] == pytest.approx(found[1], rel=0.01)
