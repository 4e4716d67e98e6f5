"""Runs that share their approach: which do, and that they end as they would have from the start, bit for bit."""

import pytest

from restitution.campaigns.design import Sweep
from restitution.campaigns.fork import forks
from restitution.campaigns.plan import planned
from restitution.errors import InputError
from restitution.runs.approach import APPROACH, run_approach
from restitution.runs.resolved import ResolvedRun
from restitution.runs.setup import set_up
from restitution.runs.simulate import simulate
from restitution.runs.validity.key import approach_key
from tests import sweeps

KINDS = """
design = "list"
"""
RUNS = """
[[runs]]
film.tension = 20000.0
[[runs]]
sphere.e_dry = 0.7
run.after_contact = 0.02
[[runs]]
film = { form = "none" }
contact = { mode = "effective", measured = [0.6, 0.4], edge_d = 0.28 }
[[runs]]
film = { form = "nguyen_ladd_2002", cut_off_cells = 0.9, floor = 1e-6 }
contact = { mode = "soft_linear", duration_steps = 12 }
[[runs]]
film = { form = "brenner_1961_difference", cut_off_cells = 0.3, floor = 1e-6, tangential = true }
[[runs]]
fluid.viscosity = 0.02
[[runs]]
run.duration = 0.02
"""


def shared(folder):
    runs = planned(Sweep(sweeps.tiny(folder, head=KINDS, rest=RUNS)).cases())
    return runs, *forks(runs, folder, "", 1)


def test_what_acts_from_the_film_on_is_shared_and_nothing_else(tmp_path):
    runs, found, alone = shared(tmp_path)
    assert [[r.run for r in fork.runs] for fork in found] == [[r.run for r in runs[:5]]]
    assert alone == runs[5:]
    assert found[0].approach.edge == pytest.approx(0.28)


def test_runs_of_one_approach_are_those_from_the_start_bit_for_bit(tmp_path):
    file = sweeps.tiny(tmp_path, head=KINDS, rest=RUNS)
    for name, more in (("forked", ()), ("whole", ("--no-forks",))):
        done = sweeps.run(file, "--out", tmp_path / name, *more)
        assert done.returncode == 0, done.stderr
        assert "cannot begin" not in done.stderr
    assert len(list((tmp_path / "forked" / "approaches").glob("*/approach.h5"))) == 1
    assert sweeps.results(tmp_path / "forked") == sweeps.results(tmp_path / "whole")


@pytest.mark.parametrize("change", [{"gap_d": 2.0}, {"kind": "rest", "gap_d": 1.0, "speed": None, "ramp": None}])
def test_an_approach_ends_where_the_narrowest_film_can_still_begin(tmp_path, change):
    case = shared(tmp_path)[0][0].case
    numerics = case.numerics.model_copy(update={"reference_speed": 0.3})
    case = case.model_copy(update={"release": case.release.model_copy(update=change), "numerics": numerics})
    edge = set_up(case).edge_d
    assert run_approach(case, edge, tmp_path / "approach")
    run = ResolvedRun(case)
    run.fork(tmp_path / "approach" / APPROACH, approach_key(case))
    assert (
        edge < run.gap_d < 0.34
    )  # half the way from there, three steps and a tenth of a cell are left to the edge


def test_an_approach_ends_above_the_film_and_is_refused_to_a_wider_one(tmp_path):
    runs, *_ = shared(tmp_path)
    case = runs[0].case
    edge = set_up(case).edge_d
    assert run_approach(case, edge, tmp_path / "approach")
    fork = tmp_path / "approach" / APPROACH
    own = ResolvedRun(case)
    own.fork(fork, approach_key(case))
    assert edge < own.gap_d < 0.34
    wider = runs[2].case.model_copy(update={"contact": runs[2].case.contact.model_copy(update={"edge_d": 0.5})})
    with pytest.raises(InputError, match="may have acted"):
        simulate(wider, tmp_path / "wider", fork=fork)
    with pytest.raises(InputError, match="shares"):
        simulate(runs[5].case, tmp_path / "other", fork=fork)


def test_a_sphere_released_within_the_film_has_no_approach(tmp_path):
    case = shared(tmp_path)[0][0].case
    assert not run_approach(case, 0.5, tmp_path / "approach")
    assert not (tmp_path / "approach" / APPROACH).exists()


def test_a_case_that_the_solver_refuses_is_set_apart(tmp_path):
    rest = "[vary]\nfluid.viscosity = [0.01, 1e-7]\nsphere.e_dry = [0.8, 0.9]\n"
    runs = planned(Sweep(sweeps.tiny(tmp_path, rest=rest)).cases())
    found, alone = forks(runs, tmp_path, "", 1)
    assert [[r.case.fluid.viscosity for r in fork.runs] for fork in found] == [[0.01, 0.01]]
    assert [r.case.fluid.viscosity for r in alone] == [1e-7, 1e-7]
