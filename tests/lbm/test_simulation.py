import numpy as np
import pytest

from lbm import DivergenceError, InputError, Rates, Simulation
from lbm.observers import Average, Checkpoint, DivergenceGuard, FieldOutput, Probe, Sums

RATES = Rates.two_relaxation_times(0.02)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"shape": (3, 8, 8)}, "at least 4"),
        ({"shape": (8, 8)}, "shape"),
        ({"shape": (8, 8, 8.5)}, "shape"),
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
        (np.full((8, 8, 8), np.inf), 0.0, "density: not finite"),
        (-1.0, 0.0, "positive"),
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

    flow = Simulation((5, 6, 7), RATES)
    flow.set_flow(1.0, 0.02 * np.random.default_rng(5).standard_normal((3, 5, 6, 7)))
    output = FieldOutput(2, tmp_path)
    flow.run(2, [output])
    reader = vtk_io.vtkHDFReader()
    reader.SetFileName(str(output.written[-1]))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (6, 7, 8)  # points of 5 x 6 x 7 cells
    velocity = vtk_to_numpy(image.GetCellData().GetArray("velocity"))
    density = vtk_to_numpy(image.GetCellData().GetArray("density"))
    assert (velocity.reshape(7, 6, 5, 3) == flow.velocity.transpose(3, 2, 1, 0)).all()
    assert (density.reshape(7, 6, 5) == flow.density.T).all()


def test_negative_steps_are_refused():
    with pytest.raises(InputError, match="steps"):
        Simulation((8, 8, 8), RATES).run(-1)
