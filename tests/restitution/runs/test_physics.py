"""Kept runs hold as long as case and program would give them again: told numbers, probe cases, version."""

import json
import tomllib
import typing
from pathlib import Path

import numba
import numpy as np
import pytest
from pydantic import BaseModel

import restitution
from restitution import cases
from restitution.cases import Case, FilmModel
from restitution.laws.legendre import Legendre2005
from restitution.runs import kept as kept_runs
from restitution.runs.filmed import filmed, simulated_impacts
from restitution.runs.resolved import ResolvedRun
from restitution.runs.simulate import simulate
from restitution.runs.validity import physics, program
from restitution.runs.validity.told import departures, told

ROOT = Path(restitution.__file__).parents[1]
KEPT = ROOT / "reports" / "runs"


def literals(model, path=""):
    """(field, value) for every value of every Literal in a model and in the models within it."""
    for name, field in model.model_fields.items():
        yield from _of_type(field.annotation, f"{path}{name}")


def _of_type(annotation, path):
    if typing.get_origin(annotation) is typing.Literal:
        yield from ((path, value) for value in typing.get_args(annotation))
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield from literals(annotation, f"{path}.")
    else:
        for inner in typing.get_args(annotation):
            yield from _of_type(inner, path)


def value_at(case, path):
    for name in path.split("."):
        case = getattr(case, name, None)
    return case


BESIDE = {("numerics.rates", f"{name}-by-place") for name in ("balanced", "quiet", "dhumieres")}
"""The first is what probes have by default; no kept run has the others: tests/lbm/test_rates_by_place.py."""


@pytest.mark.parametrize(("path", "value"), sorted(set(literals(Case)) - BESIDE), ids=lambda v: str(v))
def test_every_choice_of_a_case_occurs_in_a_probe(path, value):
    assert any(value_at(case, path) == value for case in physics.probe_cases())


def test_optional_numbers_occur_in_probes_too():
    wanted = ("release.along", "film.tension", "film.tangential", "film.cut_off_cells", "contact.law",
              "contact.edge_d", "contact.law_edge_d", "contact.added_mass", "contact.duration_steps",
              "run.after_contact", "run.duration")  # fmt: skip
    for path in wanted:
        assert any(value_at(case, path) for case in physics.probe_cases()), path


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """Another text of the program, of which nothing is known yet."""

    def ask(numbers=None):
        physics.departures.cache_clear()
        monkeypatch.setattr(physics, "program_hash", lambda: "0" * 12)
        monkeypatch.setattr(kept_runs, "program_hash", lambda: "0" * 12)
        monkeypatch.setattr(physics, "kernel_folder", lambda: tmp_path)
        if numbers is not None:
            monkeypatch.setattr(physics, "probe_numbers", lambda: numbers)

    yield ask
    physics.departures.cache_clear()


@pytest.mark.parametrize("threads", [1, 2])
def test_the_program_agrees_with_the_committed_numbers(threads):
    if threads > numba.config.NUMBA_NUM_THREADS:
        pytest.skip("one thread only")
    before = numba.get_num_threads()
    numba.set_num_threads(threads)
    try:
        assert physics.compare(physics.committed()["numbers"], physics.probe_numbers()) == []
    finally:
        numba.set_num_threads(before)


def test_a_kept_run_comes_out_again(tmp_path):
    """The shortest of the kept runs, whole: 1e-3 d is a hundred times what threads and processors move it by."""
    case = cases.read_case("li_drop1")
    kept = kept_runs.read_run(case, KEPT)
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()
    motion = run.motion()
    again = np.interp(kept.trajectory.time_s, motion.time_s, motion.gap_m)
    assert np.abs(again - kept.trajectory.gap_m).max() < 1e-3 * case.sphere.diameter


def test_every_kept_run_was_told_what_its_case_says():
    kept = [path.name for path in KEPT.iterdir() if path.is_dir()]
    assert set(kept) >= {"gondret_st152_10_imposed", "gondret_st152_10", "gondret_st152_10_soft"}
    for name in kept:
        case = cases.read_case(name)
        record = json.loads((KEPT / name / "run.json").read_text())
        assert departures(record["told"], told(case)) == [], name
        assert departures(record["filmed"], filmed(case)) == [], name


# What makes runs stale


def run_now(changed_case=None):
    case = changed_case or cases.read_case("gondret_st152_10")
    return kept_runs.read_run(case, KEPT)


def test_another_text_that_computes_the_same_keeps_the_runs(fresh):
    fresh(physics.committed()["numbers"])
    assert not run_now().stale


def test_a_program_that_computes_something_else_makes_all_runs_stale(fresh):
    numbers = json.loads(json.dumps(physics.committed()["numbers"]))
    numbers["settling"]["velocity"][5] *= 1 + 1e-6
    fresh(numbers)
    assert run_now().changed == ("program",)
    assert physics.departures() == ("settling: velocity",)


def test_probes_notice_a_part_of_the_solver_that_is_dropped(fresh, monkeypatch):
    monkeypatch.setattr("lbm.spheres.spheres.refill", lambda *_: 0.0)
    fresh()
    assert run_now().stale


def test_a_verdict_is_kept_and_not_asked_for_again(fresh, tmp_path, monkeypatch):
    fresh(physics.committed()["numbers"])
    assert physics.departures() == ()
    assert len(list(tmp_path.glob("probes-*.json"))) == 1
    physics.departures.cache_clear()
    monkeypatch.setattr(physics, "probe_numbers", None)  # to be asked would fail
    assert physics.departures() == ()


def test_a_run_made_by_a_program_that_departs_is_its_own_only(fresh, tmp_path):
    """Made while the kernels were altered, kept, and the alteration taken back: it must not count as current."""
    case = cases.read_case(physics.PROBES / "dry_torn_film.toml")
    numbers = json.loads(json.dumps(physics.committed()["numbers"]))
    numbers["settling"]["gap"][0] += 1.0
    fresh(numbers)
    simulate(case, tmp_path / case.name)
    assert json.loads((tmp_path / case.name / "run.json").read_text()).get("physics") is None


@pytest.mark.parametrize("name", ["cut_off", "floor", "reference_speed"])
def test_a_changed_rule_of_a_case_makes_its_runs_stale(name, monkeypatch):
    changes = {
        "cut_off": (FilmModel, property(lambda self: 0.25)),
        "floor": (Case, property(lambda self: 3e-7)),
        "reference_speed": (Case, property(lambda self: 1.001 * self.release.speed)),
    }
    where, changed = changes[name]
    monkeypatch.setattr(where, name, changed)
    assert run_now().changed == ("case",)


def test_a_law_may_be_rewritten_but_not_change_a_number(monkeypatch):
    case = cases.read_case("gondret_st152_10_legendre")
    before, formula = told(case), Legendre2005.formula

    def with_formula(text):
        monkeypatch.setattr(Legendre2005, "formula", text)
        return told(case)

    assert departures(before, with_formula(f"0 + 1*({formula})")) == []
    assert departures(before, with_formula(f"(1 + 1e-6)*({formula})")) == ["sphere.contact.rebound"]


def test_a_note_leaves_a_run_as_it_is():
    case = cases.read_case("gondret_st152_10")
    assert not run_now(case.model_copy(update={"note": "else", "title": "else"})).stale
    assert run_now(case.model_copy(update={"gravity": 9.82})).changed == ("case",)


# Impacts are taken from the kept trajectory anew where they would come out otherwise


def test_another_camera_takes_the_impacts_anew(monkeypatch):
    kept = run_now()
    monkeypatch.setattr("restitution.runs.filmed._interval", lambda track: 1e-3)
    again = run_now()
    assert not again.stale
    fresh_impacts = simulated_impacts(kept.trajectory, kept.case)[0]
    assert again.impacts.e_eff.dropna().tolist() == fresh_impacts.e_eff.dropna().tolist()
    assert again.impacts.e_eff.dropna().tolist() != kept.impacts.e_eff.dropna().tolist()


def test_changes_of_the_sensitivity_table_are_still_where_it_looks_for_them():
    changes = tomllib.loads((ROOT / "benchmarks" / "probe_changes.toml").read_text("utf-8"))["change"]
    for change in changes:
        assert (ROOT / change["file"]).read_text("utf-8").count(change["old"]) == 1, change["what"]
        assert change["new"] != change["old"]


def test_what_no_run_depends_on_is_no_part_of_the_program(tmp_path, monkeypatch):
    for package in ("lbm", "restitution"):
        (tmp_path / package / "report").mkdir(parents=True)
        (tmp_path / package / "__init__.py").write_text("")
        (tmp_path / package / "report" / "__init__.py").write_text("x = 1\n")

    class Spec:
        def __init__(self, name):
            self.origin = str(tmp_path / name / "__init__.py")

    monkeypatch.setattr(program.importlib.util, "find_spec", Spec)
    first = program.program_hash.__wrapped__()
    (tmp_path / "restitution" / "report" / "page.py").write_text("y = 2\n")
    assert program.program_hash.__wrapped__() == first
    (tmp_path / "lbm" / "empty.py").write_text("")
    assert program.program_hash.__wrapped__() != first
