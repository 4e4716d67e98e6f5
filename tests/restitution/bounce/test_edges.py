"""An e_eff of one edge of the film as that of another, against frames, closed forms and whole trajectories."""

import math

import numpy as np
import pytest

from restitution import datasets, laws
from restitution.bounce import Closures, Release, bounce, law_at
from restitution.bounce.edges import Passage, at_edge, carried, fall_height, passage, restitution_at
from restitution.conditions import Conditions
from restitution.errors import ConventionError, InputError
from restitution.laws.source_abstract_eq4 import Eq4Exponential
from restitution.stokes import StokesNumber

GONDRET = datasets.resource("gondret2002_st152").conditions
LAW = laws.get("eq4_exponential", K=10.6)


@pytest.mark.parametrize(("edge", "read"), [(0.2, 0.796), (0.3, 0.766)])
def test_the_first_rebound_of_the_3_mm_sphere_converts_to_what_its_frames_say_at_other_edges(edge, read):
    """0.834 at 0.1 d; all three are fits to the frames (benchmarks/README.md), each with an error of 0.003."""
    e = restitution_at(GONDRET, 0.59, edge, 0.1, lambda v: 0.834)
    assert e == pytest.approx(read, abs=0.01)


@pytest.mark.parametrize("e", [0.9, 0.5, 0.2])
@pytest.mark.parametrize("v", [0.08, 0.3, 0.59])
def test_there_and_back_is_the_same(v, e):
    there = passage(GONDRET, v, 0.3, 0.1)
    assert there.narrowed(there.widened(e)) == pytest.approx(e, abs=1e-5)
    back = passage(GONDRET, there.v_narrow, 0.1, 0.3)
    assert back.v_wide == pytest.approx(v, rel=1e-6)


def test_without_a_viscous_force_all_edges_have_one_restitution():
    """A steel sphere in thin gas."""
    gas = Conditions.model_validate(
        {"fluid": {"density": 0.1, "viscosity": 1e-6}, "sphere": {"diameter": 3e-3, "density": 7800.0}}
    )
    through = passage(gas, 0.3, 0.3, 0.05)
    assert through.v_narrow == pytest.approx(0.3, rel=1e-4)
    assert [through.widened(e) for e in (0.9, 0.6, 0.2)] == pytest.approx([0.9, 0.6, 0.2], rel=1e-3)


def test_a_fall_that_begins_below_the_narrow_edge_knows_no_other():
    v = carried(GONDRET, 0.0, 0.05)
    assert fall_height(GONDRET, v) == pytest.approx(0.05, rel=1e-9)
    assert restitution_at(GONDRET, v, 0.3, 0.1, lambda speed: 0.4) == 0.4
    assert restitution_at(GONDRET, v, 0.1, 0.3, lambda speed: 0.4) == 0.4


def test_free_fall_from_the_edge_keeps_the_energy_of_sphere_and_added_mass():
    """C_M = 0.8031 at the wall and 0.5476 at 0.3 d, the series of potential flow summed by hand."""
    m = GONDRET.sphere.mass
    fluid = m * 935 / 7800
    work = (m - fluid) * GONDRET.gravity * 0.3 * 3e-3
    energy = 0.5 * (m + 0.5476 * fluid) * 0.5**2 + work
    assert carried(GONDRET, 0.5, 0.3) == pytest.approx(math.sqrt(2 * energy / (m + 0.8031 * fluid)), rel=1e-5)
    assert at_edge(GONDRET, carried(GONDRET, 0.5, 0.3), 0.3) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("edge", [0.05, 0.2, 0.3])
def test_a_converted_law_gives_the_flight_of_the_law_at_its_own_edge(edge):
    release = Release(9e-3, 0.586)
    own = bounce(GONDRET, release, Closures(rebound=LAW, film=0.1), end=0.1)
    other = bounce(GONDRET, release, Closures(rebound=law_at(LAW, edge, 0.1), film=edge), end=0.1)
    assert other.impacts[0].e != pytest.approx(own.impacts[0].e, abs=0.02)
    assert other.apexes()[0] == pytest.approx(own.apexes()[0], rel=0.01)


def test_a_law_whose_source_states_no_edge_is_taken_at_any():
    assert law_at(LAW, 0.3) is LAW
    St = StokesNumber(100.0)
    assert law_at(LAW, 0.3, 0.1)(St, 0.97, GONDRET) < LAW(St, 0.97) < law_at(LAW, 0.05, 0.1)(St, 0.97, GONDRET)
    assert law_at(LAW, 0.1, 0.1) is LAW


class _OfOneEdge(Eq4Exponential):
    """The same formula, of a source that states 0.2 d."""

    edge = 0.2


def test_closures_take_the_edge_of_their_law_and_refuse_another():
    law = _OfOneEdge()
    assert Closures(rebound=law).film == 0.2
    assert Closures(rebound=LAW).film == 0.1
    with pytest.raises(InputError, match="law_at"):
        Closures(rebound=law, film=0.1)
    assert Closures(rebound=law_at(law, 0.1), film=0.1).film == 0.1


@pytest.mark.parametrize("edge", [0.0, -0.1, 1.5, np.nan])
def test_an_edge_that_is_none_is_refused(edge):
    with pytest.raises(InputError, match="edge"):
        law_at(LAW, edge)


def test_a_conversion_needs_fluid_and_sphere():
    with pytest.raises(ConventionError, match="conditions"):
        law_at(LAW, 0.3, 0.1)(StokesNumber(100.0), 0.97)


def test_a_rebound_that_stays_within_the_wide_edge_is_told_by_its_apex():
    through = Passage(GONDRET, 0.1, 0.3, 0.1)
    e = 0.4
    speed = through.widened(e) * through.v_wide
    within = Closures(drag=laws.get("schiller_naumann_1935"), measured=(e,), film=0.1)  # of a conversion, always
    apex = bounce(GONDRET, Release(9e-4, 0.1), within, end=0.2).apexes()[0]
    assert apex < 9e-4
    assert fall_height(GONDRET, speed) * 3e-3 == pytest.approx(apex, rel=1e-3)
