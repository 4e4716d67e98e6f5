"""A resolved run from case to tables: closures as the solver takes them, contacts, checkpoints, what is kept."""

import json
import math

import h5py
import numpy as np
import pandas as pd
import pytest

from lbm.scales import FlowScales
from restitution import cases, datasets
from restitution.cli import main
from restitution.errors import InputError
from restitution.runs import closures, resolved, simulate
from restitution.runs.kept import ensure, read_run
from restitution.runs.setup import film_forces
from restitution.runs.validity.key import checkpoint_key
from restitution.tables import check_table

TINY = """
base = "gondret_st152_10"
[release]
kind = "drive"
gap_d = 1.0
speed = 0.3
ramp = 0.0005
[numerics]
cells_per_diameter = 6
lattice_speed = 0.1
width_d = 2.5
height_d = 4.5
[run]
after_contact = 0.012
"""


def tiny(folder, extra="", name="tiny"):
    path = folder / f"{name}.toml"
    path.write_text(TINY + extra)
    return cases.read_case(path)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The tiny case and the folder of its results."""
    folder = tmp_path_factory.mktemp("tiny")
    case = tiny(folder)
    simulate.simulate(case, folder / "out")
    return case, folder / "out"


def test_tables_have_the_schemas_of_the_measured_ones(run):
    _, out = run
    for name, schema in (("trajectory", "trajectory"), ("velocity", "settling"), ("impacts", "impact")):
        assert check_table(out / f"{name}.csv", datasets.schema(schema)) == []
    assert set(pd.read_csv(out / "impacts.csv").kind) == {"simulated"}


def test_time_is_zero_at_the_first_contact(run):
    case, out = run
    table = pd.read_csv(out / "motion.csv")
    lowest = table.time_s[table.gap_m.idxmin()]
    assert abs(lowest) <= table.time_s.diff().median()
    assert table.gap_m.min() >= 0.99 * case.floor


def test_dry_contact_rebounds_with_the_dry_restitution(run):
    case, out = run
    first = json.loads((out / "run.json").read_text())["contacts"][0]
    assert first["speed_out_m_s"] / first["speed_in_m_s"] == pytest.approx(case.sphere.e_dry, rel=1e-4)


def test_velocity_is_the_rate_of_the_gap(run):
    _, out = run
    table = pd.read_csv(out / "motion.csv")
    flight = table[table.time_s > 0.002]
    rate = np.gradient(flight.gap_m, flight.time_s)
    np.testing.assert_allclose(rate[2:-2], flight.vz_m_s.iloc[2:-2], atol=2e-3)


def test_the_release_follows_the_drive(run):
    case, out = run
    table = pd.read_csv(out / "motion.csv")
    t = table.time_s - table.time_s.iloc[0]
    step = t.iloc[1]
    driven = table.gap_m > case.release.free_below_d * case.sphere.diameter
    driven &= table.time_s < 0
    wanted = case.release.speed * np.expm1(-(t + step) / case.release.ramp)
    np.testing.assert_allclose(table.vz_m_s[driven], wanted[driven], rtol=1e-4)


def test_nothing_of_the_run_is_left_but_its_results(run):
    _, out = run
    assert {p.name for p in out.iterdir()} == {*simulate.KEPT, "motion.csv"}


def test_measured_restitution_is_what_the_solver_applies(tmp_path):
    extra = '[film]\nform = "none"\n[contact]\nmode = "effective"\nmeasured = [0.7, 0.4]\nedge_d = 0.4\n'
    simulate.simulate(tiny(tmp_path, extra), tmp_path / "out")
    contacts = json.loads((tmp_path / "out" / "run.json").read_text())["contacts"]
    assert contacts[0]["speed_out_m_s"] / contacts[0]["speed_in_m_s"] == pytest.approx(0.7, rel=1e-4)


def stop_after(steps):
    """An observer's stand-in: Ctrl-C once ``steps`` have been made."""
    advance = resolved.ResolvedRun.advance

    def stopped(self, observers=()):
        if self.simulation.steps >= steps:
            raise KeyboardInterrupt
        advance(self, observers)

    return stopped


def test_a_stopped_run_goes_on_as_if_it_had_not_been_stopped(run, tmp_path, monkeypatch):
    case, whole = run
    with monkeypatch.context() as patch:
        patch.setattr(resolved.ResolvedRun, "advance", stop_after(60))
        with pytest.raises(KeyboardInterrupt):
            simulate.simulate(case, tmp_path)
    assert (tmp_path / simulate.SO_FAR).exists()
    assert not (tmp_path / "trajectory.csv").exists()
    simulate.simulate(case, tmp_path, resume=True)
    for name in ("trajectory.csv", "velocity.csv", "motion.csv"):
        assert (tmp_path / name).read_bytes() == (whole / name).read_bytes(), name


def test_the_checkpoint_of_another_case_is_refused(run, tmp_path, monkeypatch):
    case, _ = run
    with monkeypatch.context() as patch:
        patch.setattr(resolved.ResolvedRun, "advance", stop_after(60))
        with pytest.raises(KeyboardInterrupt):
            simulate.simulate(case, tmp_path)
    other = tiny(tmp_path, "snapshot_interval = 1.0\n", "other")
    with pytest.raises(InputError, match="another case"):
        simulate.simulate(other, tmp_path, resume=True)


def test_a_run_that_diverges_leaves_its_trajectory(tmp_path, capsys, monkeypatch):
    case = tiny(tmp_path)
    advance = resolved.ResolvedRun.advance

    def spoilt(self, observers=()):
        advance(self, observers)
        if self.simulation.steps > 30:
            self.simulation.lattice.populations[:] = np.nan

    monkeypatch.setattr(resolved.ResolvedRun, "advance", spoilt)
    assert main(["simulate", str(tmp_path / "tiny.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "diverged" in capsys.readouterr().err.splitlines()[-1]
    assert check_table(tmp_path / "out" / simulate.SO_FAR, datasets.schema("trajectory")) == []
    assert case.name == "tiny"


# Closures


def scales(case):
    return FlowScales.from_conditions(
        length_m=case.sphere.diameter, speed_m_s=case.reference_speed, cells=case.numerics.cells_per_diameter,
        viscosity_m2_s=case.fluid.viscosity / case.fluid.density, density_kg_m3=case.fluid.density,
        lattice_speed=case.numerics.lattice_speed,
    )  # fmt: skip


def film_case(tmp_path, film, sphere=""):
    """The 3 mm sphere at 10 cells with another film, at a lattice speed without warnings."""
    path = tmp_path / "case.toml"
    path.write_text(
        f'base = "gondret_st152_10"\n[numerics]\nlattice_speed = 0.05\n[film]\n{film}\n[sphere]\n{sphere}'
    )
    case = cases.read_case(path)
    flow = scales(case)
    return case, flow, film_forces(case, flow)[0]


@pytest.mark.parametrize("form", ["nguyen_ladd_2002", "brenner_1961_difference", "source_abstract_eq3"])
def test_film_force_in_lattice_units(form, tmp_path):
    """6 pi mu r v times a difference of Brenner's tabulated values at h/r = 0.1 and 0.2; 1/eps is within 8 %."""
    _, flow, force = film_case(tmp_path, f'form = "{form}"\ncut_off_cells = 1.0')
    stokes = 6 * math.pi * flow.viscosity * 5 * 0.02
    tolerance = 1e-4 if form.startswith("brenner") else 0.08
    assert force(0.5, -0.02, -0.02) / stokes == pytest.approx(11.4592 - 6.34089, rel=tolerance)
    assert force(0.5, 0.02, math.nan) < 0


def test_a_torn_film_holds_the_tension_of_the_liquid_only(tmp_path):
    """At contact 4 pi r p_c H_c, H_c = sqrt(3 mu r v/p_c), less the grid's 6 pi mu r^2 v 2/(3c), c half a cell."""
    _, flow, force = film_case(tmp_path, 'form = "lost_to_grid"\ntension = 101325.0', "roughness = 1e-9\n")
    mu, r, v, tension, half_cell = 0.01, 1.5e-3, 0.5, 101325, 1.5e-4
    edge = math.sqrt(3 * mu * r * v / tension)
    by_hand = 4 * math.pi * r * tension * edge - 6 * math.pi * mu * r**2 * v * 2 / (3 * half_cell)
    contact, out = flow.scales.lattice(1e-9, "length"), flow.scales.lattice(v, "velocity")
    assert flow.scales.si(-force(contact, out, math.nan), "force") == pytest.approx(by_hand, rel=1e-3)
    assert force(contact, -out, -out) > 100 * abs(force(contact, out, math.nan))  # on the way in it holds


def test_rebound_by_a_law_takes_speeds_of_the_lattice():
    """Legendre: e exp(-35/St*), St* = (7800 + 935/2) v 0.003/(9 x 0.01).

    The lattice carries v from the edge, 0.1 d, with the added mass 1/2; the law's speed is carried with that of
    potential flow, 0.6250 there and 0.8031 at the wall.
    """
    case = cases.read_case("gondret_st152_10_legendre")
    out = closures.rebound(case, unit=11.7)(0.05, 0)
    work = 2 * 9.81 * (7800 - 935) * 0.1 * 0.003
    square = 0.585**2 - work / (7800 + 0.5 * 935)
    v = math.sqrt(((7800 + 0.6250 * 935) * square + work) / (7800 + 0.8031 * 935))
    assert out / 0.05 == pytest.approx(0.97 * math.exp(-35 / ((7800 + 935 / 2) * v * 0.003 / 0.09)), rel=1e-4)


def test_after_the_last_measured_bounce_the_sphere_stays():
    case = cases.read_case("gondret_st152_10_measured")
    speeds = [closures.rebound(case, 11.7)(0.05, k) for k in range(8)]
    assert speeds[0] > 0
    assert speeds[-1] == 0


# Kept results


def test_an_unchanged_run_is_not_repeated(run, tmp_path, monkeypatch):
    case, out = run
    (tmp_path / case.name).mkdir()
    for name in simulate.KEPT:
        (tmp_path / case.name / name).write_bytes((out / name).read_bytes())
    monkeypatch.setattr("restitution.runs.kept.simulate", None)  # a run would fail
    kept = ensure(case, tmp_path)
    assert not kept.stale
    assert set(kept.flow.frames) == {"before", "at"}


def test_a_run_of_other_code_is_stale(run, tmp_path):
    case, out = run
    (tmp_path / case.name).mkdir()
    for name in simulate.KEPT:
        (tmp_path / case.name / name).write_bytes((out / name).read_bytes())
    about = json.loads((out / "run.json").read_text())
    about |= {"physics": None, "code_hash": "0" * 12, "files": {}}  # as records were before they were sealed
    del about["seal"]
    about["case_as_run"]["numerics"]["cells_per_diameter"] = 7.0
    (tmp_path / case.name / "run.json").write_text(json.dumps(about))
    kept = read_run(case, tmp_path)
    assert kept.stale
    assert "0" * 12 in kept.made_with
    assert kept.case.numerics.cells_per_diameter == 7.0  # as it was run, not as the case is now


def test_a_damaged_result_is_named(run, tmp_path):
    case, _ = run
    (tmp_path / case.name).mkdir()
    (tmp_path / case.name / "run.json").write_text("{")
    with pytest.raises(InputError, match="damaged"):
        read_run(case, tmp_path)


def test_a_checkpoint_belongs_to_the_very_case_but_not_to_its_title(tmp_path):
    first, renamed, moved = (
        tiny(tmp_path), tiny(tmp_path, 'snapshot_interval = 1.0\n'), tiny(tmp_path, "[sphere]\ne_dry = 0.9\n")
    )  # fmt: skip
    assert checkpoint_key(first.model_copy(update={"title": "else"})) == checkpoint_key(first)
    assert len({checkpoint_key(c) for c in (first, renamed, moved)}) == 3


def test_a_checkpoint_belongs_to_what_the_contact_takes():
    names = ("", "_legendre", "_imposed", "_measured")
    assert len({checkpoint_key(cases.read_case(f"gondret_st152_10{n}")) for n in names}) == 4


def test_a_checkpoint_belongs_to_the_text_of_the_program(tmp_path, monkeypatch):
    before = checkpoint_key(tiny(tmp_path))
    monkeypatch.setattr("restitution.runs.validity.key.program_hash", lambda: "0" * 12)
    assert checkpoint_key(tiny(tmp_path)) != before


def test_a_quarter_of_the_box_shows_the_flow_of_the_whole(tmp_path):
    """Track, vorticity and ParaView's field; x and y of the quarter count from the axis."""
    shown = []
    for symmetry in ("none", "quarter"):
        more = f'width_d = 3\nprecision = "float64"\nsymmetry = "{symmetry}"'
        path = tmp_path / f"{symmetry}.toml"
        path.write_text(TINY.replace("width_d = 2.5", more))
        run = resolved.ResolvedRun(cases.read_case(path))
        run.simulation.run(60)
        output = run.snapshots(tmp_path)
        output(run.simulation)
        with h5py.File(output.written[0]) as file:
            root = file["VTKHDF"]
            shown.append((run, run.vorticity(), root["CellData/velocity"][...], root.attrs["Origin"]))
    (whole, curl, velocity, _), (quarter, its_curl, its_velocity, origin) = shown
    assert whole.cells == 4 * quarter.cells
    assert quarter.gap_d == pytest.approx(whole.gap_d, rel=1e-9)
    assert its_curl == pytest.approx(curl, abs=1e-9 * np.abs(curl).max())
    assert its_velocity == pytest.approx(velocity, abs=1e-9 * np.abs(velocity).max())
    assert origin[:2] == pytest.approx([-1.5 * whole.case.sphere.diameter] * 2)
