import signal

import numpy as np
import pytest

from lbm import Body, DivergenceError, Inlet, InputError, NoSlip, Rates, Simulation
from lbm.fluid import kernels
from lbm.io.vtkhdf import write_image
from lbm.observers import Average, Checkpoint, DivergenceGuard, FieldOutput, Probe, Sums
from lbm.scales import Scales

RATES = Rates.two_relaxation_times(0.02)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"shape": (3, 8, 8)}, "at least 4"),
        ({"shape": (8, 8)}, "shape"),
        ({"shape": (8, 8, 8.5)}, "shape"),
        ({"shape": (10**20, 8, 8)}, "GiB"),
        ({"shape": (10**5, 10**5, 10**3)}, "GiB"),
        ({"rates": 0.1}, "rates"),
        ({"rates": None}, "rates"),
        ({"rates": Rates.bgk}, "Rates.bgk"),
        ({"viscosity": 0.1}, "one of the two"),
        ({"rates": None, "viscosity": -1.0}, "viscosity"),
        ({"dtype": "abc"}, "dtype"),
        ({"dtype": 3}, "dtype"),
        ({"dtype": None}, "dtype"),
        ({"dtype": "float16"}, "float16"),
        ({"threads": 0}, "threads"),
        ({"threads": 10_000}, "threads"),
        ({"force": (1.0, 2.0)}, "force"),
        ({"force": (np.nan, 0, 0)}, "force"),
    ],
)
def test_bad_arguments_are_refused(arguments, named):
    with pytest.raises(InputError, match=named):
        Simulation(**{"shape": (8, 8, 8), "rates": RATES, **arguments})


@pytest.mark.parametrize(
    ("density", "velocity", "named"),
    [
        (np.ones((8, 8, 7)), 0.0, "density: shape"),
        (1.0, np.zeros((8, 8, 8, 3)), "velocity: shape"),
        (1.0, np.full((3, 8, 8, 8), np.nan), r"velocity: not finite"),
        (np.full((8, 8, 8), np.inf), (0.0, 0.0, 0.0), "density: not finite"),
        (-1.0, (0.0, 0.0, 0.0), "positive"),
        (10.0, (0.0, 0.0, 0.0), "density: 10"),
        (1.0, (0.0, 1.1, 0.0), "speed 1.1"),
        (1.0, "abc", "velocity"),
        (1.0, (0.0, 1j, 0.0), "velocity"),
        (1.0, ((0.0, 1.0), (0.0,), 0.0), "velocity"),
        (None, (0.0, 0.0, 0.0), "density"),
    ],
)
def test_bad_initial_fields_are_refused(density, velocity, named):
    with pytest.raises(InputError, match=named):
        Simulation((8, 8, 8), RATES).set_flow(density, velocity)


@pytest.mark.parametrize("force", [None, (1e-4, 2e-4, -1e-4)], ids=["no force", "force"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_fields_are_those_set(dtype, force):
    rng = np.random.default_rng(2)
    rho, u = 1 + 0.01 * rng.standard_normal((5, 6, 7)), 0.02 * rng.standard_normal((3, 5, 6, 7))
    flow = Simulation((5, 6, 7), RATES, dtype=dtype, force=force)
    flow.set_flow(rho, u)
    tolerance = 1e-15 if dtype == np.float64 else 1e-6
    assert np.abs(flow.density - rho).max() < tolerance
    assert np.abs(flow.velocity - u).max() < tolerance


def test_observers_see_what_the_fields_say():
    flow = Simulation((8, 8, 8), RATES)
    flow.set_flow(1.0, 0.02 * np.random.default_rng(5).standard_normal((3, 8, 8, 8)))
    probe, sums, average = Probe(5, (0, 7, 3)), Sums(5), Average(5)
    flow.run(15, [probe, sums, average])
    rho, u = flow.fields()
    assert probe.steps == sums.steps == [0, 5, 10, 15]
    assert probe.rows[-1] == pytest.approx((rho[0, 7, 3], *u[:, 0, 7, 3]))
    mass, px, py, pz, energy = sums.rows[-1]
    assert mass == pytest.approx((rho - 1).sum(), abs=1e-12)
    assert (px, py, pz) == pytest.approx(tuple((rho * u).sum(axis=(1, 2, 3))))
    assert energy == pytest.approx((rho * (u * u).sum(axis=0)).sum() / 2)
    assert average.count == 4


@pytest.mark.filterwarnings("ignore:grid Reynolds number")  # it diverges for that reason
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_divergence_is_stopped_and_named(tmp_path, dtype):
    # far too fast for so little viscosity
    flow = Simulation((16, 16, 4), Rates.bgk(1e-5), dtype=dtype)
    x = 2 * np.pi * (np.arange(16) + 0.5) / 16
    u = np.zeros((3, 16, 16, 4))
    u[0] = 0.45 * np.sin(x)[None, :, None] + 0.05 * np.cos(3 * x)[:, None, None]
    u[1] = 0.2 * np.sin(2 * x)[:, None, None]
    flow.set_flow(1.0, u)
    path = tmp_path / "last.h5"
    with pytest.raises(DivergenceError) as caught:
        flow.run(
            50_000,
            [Checkpoint(10, path, DivergenceGuard(10, top_speed=0.6))],
            guard=DivergenceGuard(10, top_speed=0.6),
        )
    error = caught.value
    assert error.step <= 50_000
    assert all(0 <= i < n for i, n in zip(error.cell, flow.shape, strict=True))
    assert not error.value <= 0.6
    restored = Simulation((16, 16, 4), Rates.bgk(1e-5), dtype=dtype)
    restored.restore(path)
    assert error.step - 10 <= restored.steps < error.step
    assert np.isfinite(restored.velocity).all()


def test_guard_finds_nan_in_any_cell():
    flow = Simulation((6, 5, 7), RATES)
    flow.lattice.slots()[4, 6, 0, 3] = np.nan
    with pytest.raises(DivergenceError) as caught:
        DivergenceGuard()(flow)
    assert caught.value.cell == (3, 0, 6)


def test_fields_are_read_by_vtk(tmp_path):
    vtk_io = pytest.importorskip("vtkmodules.vtkIOHDF", reason="needs the vtk wheel")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    scales = Scales(1e-4, 2e-6, 950.0)
    flow = Simulation((5, 6, 7), RATES)
    flow.set_flow(1.0, 0.02 * np.random.default_rng(5).standard_normal((3, 5, 6, 7)))
    output = FieldOutput(2, tmp_path, scales=scales)
    flow.run(2, [output])
    reader = vtk_io.vtkHDFReader()
    reader.SetFileName(str(output.written[-1]))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (6, 7, 8)  # points of 5 x 6 x 7 cells
    velocity = vtk_to_numpy(image.GetCellData().GetArray("velocity"))
    density = vtk_to_numpy(image.GetCellData().GetArray("density"))
    pressure = vtk_to_numpy(image.GetCellData().GetArray("pressure"))
    assert velocity.reshape(7, 6, 5, 3) == pytest.approx(50 * flow.velocity.transpose(3, 2, 1, 0))
    assert density.reshape(7, 6, 5) == pytest.approx(950 * flow.density.T)
    assert pressure.reshape(7, 6, 5) == pytest.approx(950 * 50**2 / 3 * (flow.density.T - 1))
    facts = {name: image.GetFieldData().GetArray(name).GetValue(0) for name in ("step", "TimeValue")}
    assert facts == {"step": 2, "TimeValue": pytest.approx(4e-6)}


def test_negative_steps_are_refused():
    with pytest.raises(InputError, match="steps"):
        Simulation((8, 8, 8), RATES).run(-1)


def test_a_new_simulation_is_at_rest():
    flow = Simulation((4, 4, 4), RATES, force=(1e-3, 0, -2e-3))
    assert np.abs(flow.velocity).max() < 1e-18
    assert np.abs(flow.density - 1).max() < 1e-15


def test_momentum_gains_the_trapezoidal_sum_of_the_force():
    """d(rho u)/dt = F(t) in a uniform fluid, whose only error is that of the rule of integration."""

    def force(t):
        return np.array([1e-4 * np.cos(2 * np.pi * t / 40), 2e-7 * t, 0.0])

    flow = Simulation((4, 4, 4), Rates.bgk(0.1), force=force)
    expected = np.zeros(3)
    for n in range(25):
        flow.run(1)
        expected += (force(n) + force(n + 1)) / 2
        assert np.abs(flow.velocity - expected.reshape(3, 1, 1, 1)).max() < 1e-16


def _random_flow(**arguments):
    flow = Simulation((8, 8, 8), RATES, **arguments)
    flow.set_flow(1.0, 0.02 * np.random.default_rng(5).standard_normal((3, 8, 8, 8)))
    return flow


@pytest.mark.parametrize(("sweep", "stopped"), [("sweep_two", 6), ("sweep", 3)])
def test_an_interrupted_run_can_be_continued(monkeypatch, sweep, stopped):
    """Ctrl-C while a kernel works leaves whole steps, the usual handler, and the flow of an undisturbed run."""
    faces = None if sweep == "sweep_two" else {"x-": NoSlip((0, 0.01, 0)), "x+": "no-slip"}
    whole, flow = _random_flow(faces=faces), _random_flow(faces=faces)
    whole.run(9)
    kernel, calls = getattr(kernels, sweep), []

    def interrupted(*arguments):
        kernel(*arguments)
        calls.append(sweep)
        if len(calls) == 4:  # the first one compiles
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(kernels, sweep, interrupted)
    handler = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        flow.run(9)
    assert flow.steps == stopped
    assert signal.getsignal(signal.SIGINT) is handler
    flow.run(9 - stopped)
    assert (flow.velocity == whole.velocity).all()


class _Failing(Body):
    """Fails after the sweep of step number 3."""

    def __call__(self, lattice, step, force):
        if step == 3:
            raise ZeroDivisionError

    def describe(self):
        return {}


def test_a_step_that_fails_half_way_is_not_used(tmp_path):
    flow = _random_flow()
    flow.add(_Failing())
    flow.run(2)
    flow.save(tmp_path / "sound.h5")
    with pytest.raises(ZeroDivisionError):
        flow.run(5)
    for use in (lambda: flow.run(1), flow.fields, lambda: flow.save(tmp_path / "broken.h5")):
        with pytest.raises(InputError, match="set_flow or restore"):
            use()
    assert not (tmp_path / "broken.h5").exists()
    flow.restore(tmp_path / "sound.h5")
    flow.run(1)
    with pytest.raises(ZeroDivisionError):
        flow.run(1)
    flow.set_flow()
    assert flow.steps == 0
    flow.run(3)


@pytest.mark.parametrize("bad", [(1.0, 2.0), "up", (np.nan, 0, 0), None, np.ones((5, 5, 3)), (0, 5.0, 0), 1 / 3])
@pytest.mark.parametrize("face", [NoSlip, Inlet])
def test_a_face_that_goes_bad_leaves_the_last_whole_step(tmp_path, face, bad):
    """As for the force: what was made can be read, saved, and continued where the function is mended."""
    good, mended = (0, 0.01, 0), []

    def velocity(t):
        return good if t < 3 or mended else bad

    flow = _random_flow(faces={"x-": face(velocity), "x+": "outlet"})
    with pytest.raises(InputError, match=r"face x-: velocity.*at time 3\.5"):
        flow.run(5)
    assert flow.steps == 3
    flow.save(tmp_path / "three.h5")
    mended.append(True)
    whole = _random_flow(faces={"x-": face(velocity), "x+": "outlet"})
    whole.run(5)
    flow.run(2)
    assert (flow.velocity == whole.velocity).all()
    again = _random_flow(faces={"x-": face(velocity), "x+": "outlet"})
    again.restore(tmp_path / "three.h5")
    again.run(2)
    assert (again.velocity == whole.velocity).all()


def test_a_face_function_that_raises_leaves_the_last_whole_step():
    def wall(t):
        if t > 3:
            raise ZeroDivisionError
        return 0.0, 0.01, 0.0

    flow = _random_flow(faces={"x-": NoSlip(wall), "x+": "no-slip"})
    with pytest.raises(ZeroDivisionError):
        flow.run(5)
    assert flow.steps == 3
    assert np.isfinite(flow.velocity).all()


@pytest.mark.parametrize("bad", [(1.0, 2.0), "up", (np.nan, 0, 0), None])
def test_a_force_that_goes_bad_leaves_the_last_whole_step(bad):
    flow = _random_flow(force=lambda t: (1e-5, 0, 0) if t < 3 else bad)
    with pytest.raises(InputError, match=r"force at time 3"):
        flow.run(5)
    assert flow.steps == 3
    flow.given_force = (1e-5, 0, 0)
    flow.run(2)
    whole = _random_flow(force=(1e-5, 0, 0))
    whole.run(5)
    assert (flow.velocity == whole.velocity).all()


@pytest.mark.parametrize(
    "act",
    [lambda flow: flow.set_flow(), lambda flow: flow.run(1), lambda flow: flow.restore("any.h5")],
    ids=["set_flow", "run", "restore"],
)
def test_an_observer_may_only_look(act):
    class Meddler:
        every = 2

        def __call__(self, flow):
            if flow.steps:
                act(flow)

    flow = _random_flow()
    with pytest.raises(InputError, match="during a run"):
        flow.run(5, [Meddler()])
    assert flow.steps == 2
    flow.run(1)


def test_the_start_is_observed_once():
    flow, early, late = _random_flow(), Probe(5, (0, 0, 0)), Probe(5, (0, 0, 0))
    flow.run(0, [early])
    flow.run(7, [early, late])
    flow.run(3, [early, late])
    assert early.steps == late.steps == [0, 5, 10]
    flow.set_flow()
    flow.run(0, [early])
    assert early.steps[3:] == [0]


@pytest.mark.parametrize("observers", [Probe(1, (0, 0, 0)), [print], [Probe], 3, [None]])
def test_what_cannot_observe_is_refused(observers):
    with pytest.raises(InputError, match="observer"):
        Simulation((4, 4, 4), RATES).run(1, observers)


@pytest.mark.parametrize("every", [0, 2.5, "2"])
def test_observers_need_a_whole_number_of_steps(every):
    with pytest.raises(InputError, match="every"):
        Sums(every)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Probe(1, (0, 0.5, 0)),
        lambda: Probe(1, (0, 0)),
        lambda: Probe(1, "abc"),
        lambda: Probe(1, 3),
        lambda: Probe(1, (0, -1, 0)),
        lambda: DivergenceGuard(density=5),
        lambda: DivergenceGuard(density=("a", 2)),
        lambda: DivergenceGuard(density=(2, 1)),
        lambda: DivergenceGuard(top_speed="x"),
        lambda: DivergenceGuard(top_speed=-1),
        lambda: DivergenceGuard(top_speed=np.nan),
        lambda: FieldOutput(1, "here", scales="x"),
        lambda: FieldOutput(1, None),
        lambda: FieldOutput(1, "here", stem=None),
        lambda: FieldOutput(1, "here", stem="a/b"),
        lambda: Checkpoint(1, None),
        lambda: Checkpoint(1, "here", guard="x"),
        lambda: Rates.two_relaxation_times(1e-30),
        lambda: Rates.bgk(10**400),
    ],
)
def test_bad_settings_are_refused_at_once(make):
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize(
    ("make", "advice"),
    [
        (lambda: Rates.two_relaxation_times(1e30), "lower the viscosity"),
        (lambda: Rates(0, 1, 1, 1, 1, 1), "lower the viscosity"),
        (lambda: Rates.bgk(1e-30), "raise the viscosity"),
        (lambda: Rates(2, 1, 1, 1, 1, 1), "raise the viscosity"),
    ],
)
def test_advice_on_the_viscosity_points_the_right_way(make, advice):
    with pytest.raises(InputError, match=advice):
        make()


@pytest.mark.parametrize("name", ["steps", "shape", "dtype", "faces", "bodies"])
def test_what_a_simulation_is_cannot_be_assigned(name):
    with pytest.raises(AttributeError):
        setattr(Simulation((4, 4, 4), RATES), name, 3)


def test_a_checkpoint_without_guard_saves_anything_finite(tmp_path):
    flow = _random_flow()
    flow.run(1, [Checkpoint(1, tmp_path / "a.h5", guard=None)], guard=None)
    assert (tmp_path / "a.h5").is_file()


@pytest.mark.parametrize(
    ("fields", "options"),
    [
        ({}, {}),
        (3, {}),
        ({"a": np.zeros(3)}, {}),
        ({"a": "text"}, {}),
        ({"a": np.zeros((2, 4, 4, 4))}, {}),
        ({"a/b": np.zeros((4, 4, 4))}, {}),
        ({3: np.zeros((4, 4, 4))}, {}),
        ({"a": np.zeros((4, 4, 4)), "b": np.zeros((4, 4, 5))}, {}),
        ({"a": np.zeros((4, 4, 4))}, {"spacing": 0}),
        ({"a": np.zeros((4, 4, 4))}, {"spacing": "x"}),
        ({"a": np.zeros((4, 4, 4))}, {"origin": (0, 0)}),
    ],
)
def test_bad_images_are_refused_and_leave_no_file(tmp_path, fields, options):
    with pytest.raises(InputError):
        write_image(tmp_path / "a.vtkhdf", fields, **options)
    assert not list(tmp_path.iterdir())


def test_progress_in_a_log_is_lines(capsys, monkeypatch):
    monkeypatch.setattr("lbm.io.progress._SECONDS_PER_LINE", 0.0)
    monkeypatch.setattr("lbm.io.progress._UPDATES_PER_REFRESH", 2 * 8**3)
    flow = _random_flow()
    flow.run(6, progress=True)
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("lbm")]
    assert [line.split()[1] for line in lines] == ["2/6", "4/6", "6/6"]


@pytest.mark.parametrize(("fails_at", "said"), [(0, []), (4, ["4/9"])])
def test_progress_of_a_failed_run_says_how_far_it_came(capsys, fails_at, said):
    class Failing:
        every = 4

        def __call__(self, flow):
            if flow.steps == fails_at:
                raise RuntimeError

    with pytest.raises(RuntimeError):
        _random_flow().run(9, [Failing()], progress=True)
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("lbm")]
    assert [line.split()[1] for line in lines] == said


def test_rates_are_fixed():
    flow = Simulation((4, 4, 4), RATES)
    with pytest.raises(AttributeError):
        flow.rates = Rates.bgk(0.1)
    assert flow.rates == RATES


@pytest.mark.parametrize("velocity", [0.05, np.zeros((8, 8, 8)), np.zeros((3, 1, 1, 1))])
def test_a_velocity_of_another_shape_is_refused(velocity):
    flow = Simulation((8, 8, 8), Rates.two_relaxation_times(0.1))
    with pytest.raises(InputError, match="shape"):
        flow.set_flow(velocity=velocity)
