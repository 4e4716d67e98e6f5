import resource
import signal

import h5py
import numpy as np
import pytest

from lbm import Flow, InputError, NoSlip, OutputError, Rates, Simulation
from lbm.observers import Sums
from lbm.spheres import DryRebound, Film, FilmRebound, SoftContact, Sphere, Spheres

RATES = Rates.two_relaxation_times(0.02)
SHAPE = (9, 8, 10)


def _flow(threads=None, **changes):
    arguments = {
        "shape": SHAPE,
        "rates": RATES,
        "faces": {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((0.03, 0, 0))},
        "force": (1e-5, 0, 0),
        **changes,
    }
    flow = Simulation(**arguments, threads=threads)
    flow.set_flow(1.0, 0.02 * np.random.default_rng(7).standard_normal((3, *flow.shape)))
    return flow


@pytest.mark.parametrize("saved_after", [10, 11])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_restart_is_bit_identical_with_any_number_of_threads(tmp_path, saved_after, dtype):
    path = tmp_path / "state.h5"
    whole = _flow(threads=2, dtype=dtype)
    whole.run(saved_after)
    whole.save(path)
    whole.run(13)
    for threads in (1, 2):
        again = _flow(threads=threads, dtype=dtype)
        again.restore(path)
        assert again.steps == saved_after
        again.run(13)
        assert again.steps == whole.steps
        assert (again.lattice.slots() == whole.lattice.slots()).all()


def test_truncated_file_is_refused(tmp_path):
    path = tmp_path / "state.h5"
    flow = _flow()
    flow.save(path)
    content = path.read_bytes()
    for length in (0, 100, len(content) // 2, len(content) - 8):
        path.write_bytes(content[:length])
        with pytest.raises(InputError, match=r"state\.h5"):
            flow.restore(path)


def test_damaged_data_are_refused(tmp_path):
    path = tmp_path / "state.h5"
    flow = _flow()
    flow.save(path)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(InputError, match="damaged"):
        flow.restore(path)


def test_other_version_is_refused(tmp_path):
    path = tmp_path / "state.h5"
    flow = _flow()
    flow.save(path)
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = 99
    with pytest.raises(InputError, match="version 99"):
        flow.restore(path)


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"shape": (9, 8, 11)}, "shape"),
        ({"dtype": np.float32}, "dtype"),
        ({"rates": Rates.bgk(0.02)}, "rates"),
        ({"faces": {"x": "free-slip"}}, "faces"),
        ({"faces": {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((0.02, 0, 0))}}, "faces"),
        ({"force": (2e-5, 0, 0)}, "force"),
    ],
)
def test_another_simulation_is_refused_and_left_alone(tmp_path, changes, named):
    path = tmp_path / "state.h5"
    _flow().save(path)
    other = _flow(**changes)
    before = other.lattice.slots().copy()
    with pytest.raises(InputError, match=named):
        other.restore(path)
    assert (other.lattice.slots() == before).all()


def test_only_what_differs_is_named(tmp_path):
    path = tmp_path / "state.h5"
    lid = np.zeros((9, 8, 3))
    _flow(faces={"z-": "no-slip", "z+": NoSlip(lid)}).save(path)
    lid[4, 4, 0] = 0.01
    with pytest.raises(InputError, match=r"faces\.z\+\.velocity = ") as caught:
        _flow(faces={"z-": "no-slip", "z+": NoSlip(lid)}).restore(path)
    assert len(str(caught.value)) < len(str(path)) + 300


def test_missing_and_foreign_files_are_refused(tmp_path):
    flow = _flow()
    with pytest.raises(InputError, match="no such"):
        flow.restore(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("not HDF5")
    with pytest.raises(InputError, match=r"text\.h5"):
        flow.restore(tmp_path / "text.h5")


def test_full_disk_leaves_the_previous_checkpoint(tmp_path):
    path = tmp_path / "state.h5"
    flow = _flow()
    flow.save(path)
    before = path.read_bytes()
    flow.run(4)
    # a limit on the size of files stands for the full disk: writes fail part-way
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limits[1]))
    try:
        with pytest.raises(OutputError, match="intact"):
            flow.save(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, handler)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["state.h5"]


def test_outputs_follow_links_and_name_what_cannot_be_written(tmp_path):
    flow = Simulation((8, 8, 8), Rates.two_relaxation_times(0.1))
    flow.set_flow()
    target, link = tmp_path / "kept.h5", tmp_path / "link.h5"
    flow.save(target)
    link.symlink_to(target)
    flow.save(link)
    assert link.is_symlink()
    (tmp_path / "file").touch()
    for bad in (tmp_path / "file" / "c.h5", tmp_path, tmp_path / ("x" * 300), "", "x\0y"):
        with pytest.raises(OutputError):
            flow.save(bad)
        with pytest.raises(InputError):
            flow.restore(bad)
    for bad in (None, 3):
        with pytest.raises(InputError, match="path"):
            flow.save(bad)


@pytest.mark.parametrize(("name", "value"), [("steps", -1), ("parity", 7)])
def test_an_impossible_state_is_refused(tmp_path, name, value):
    flow = Simulation((8, 8, 8), Rates.two_relaxation_times(0.1))
    flow.set_flow()
    flow.save(tmp_path / "c.h5")
    with h5py.File(tmp_path / "c.h5", "a") as file:
        file.attrs[name] = value
    with pytest.raises(InputError, match="damaged"):
        flow.restore(tmp_path / "c.h5")


def test_what_was_saved_can_be_looked_at_without_a_simulation(tmp_path):
    whole = _flow()
    whole.run(7)
    whole.save(tmp_path / "state.h5")
    faces = {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((0.03, 0, 0))}
    flow = Flow(SHAPE, RATES, faces=faces, force=(1e-5, 0, 0))
    flow.restore(tmp_path / "state.h5")
    sums = Sums(1)
    sums(flow)
    assert (flow.steps, sums.steps) == (7, [7])
    assert (flow.velocity == whole.velocity).all()


def test_a_law_need_not_be_defined_everywhere(tmp_path):
    """A list of measured rebounds ends; a description need not, and still tells one list from another."""

    def flow(*measured):
        law = FilmRebound(lambda speed, count: measured[count] * speed / (speed > 1e-3), 0.5, 1e-4)
        box = Simulation((16, 16, 20), RATES, faces={"z": "no-slip"})
        box.add(Spheres([Sphere(3.0, 8.0, (8.0, 8.0, 9.0))], contact=law))
        return box

    flow(0.7, 0.6).save(tmp_path / "state.h5")
    again = flow(0.7, 0.6)
    again.restore(tmp_path / "state.h5")
    assert again.steps == 0
    for other in ((0.7, 0.5), (0.7, 0.6, 0.5)):
        with pytest.raises(InputError, match="contact"):
            flow(*other).restore(tmp_path / "state.h5")


# Everything that decides the motion of spheres


def _hertz_like(stiffness):
    return SoftContact(lambda overlap, rate, speed: max(0.0, stiffness * overlap - 0.1 * rate), 20.0)


def _film(factor=1.0, cut_off=0.5, floor=0.01, normal=True, tangential=None):
    return Film(cut_off, floor, (lambda gap, v, onset: -factor * v / gap) if normal else None, tangential)


def _drag_along(factor):
    return lambda gap, slip, spin, normal: (-factor * slip / gap, -spin / gap)


def _driven(speed, below=2.0):
    return lambda step, gap: (0.0, 0.0, -speed * min(1.0, step / 50)) if gap > below else None


FALLING = {
    "gravity": (0.0, 0.0, -1e-4),
    "film": _film(),
    "contact": DryRebound(0.97, 60.0, 10.0, 0.0),
    "drive": _driven(0.02),
}
LAW = FilmRebound(lambda speed, count: 0.7 * speed, 0.5, 1e-4)


@pytest.mark.parametrize(
    ("one", "other", "named"),
    [
        ({}, {"contact": DryRebound(0.5, 60.0, 10.0, 0.0)}, r"contact\.e_dry = 0\.97, this simulation has 0\.5"),
        ({}, {"contact": DryRebound(0.97, 61.0, 10.0, 0.0)}, "contact.added_mass"),
        ({}, {"contact": None}, "contact"),
        ({}, {"contact": SoftContact.linear(0.97, 900.0, 20.0)}, "contact"),
        ({}, {"film": None}, "film"),
        ({}, {"film": _film(normal=False)}, "film.normal"),
        ({}, {"film": _film(1 + 1e-9)}, "film.normal"),
        ({}, {"film": _film(tangential=_drag_along(1.0))}, "film.tangential"),
        ({}, {"film": _film(floor=0.02)}, "film.floor"),
        ({"film": _film(tangential=_drag_along(1.0))}, {"film": _film(tangential=_drag_along(2.0))}, "tangential"),
        (
            {"film": None, "contact": LAW},
            {"film": None, "contact": FilmRebound(lambda speed, count: 0.7 * speed + 1e-6, 0.5, 1e-4)},
            "contact.rebound",
        ),
        (
            {"film": None, "contact": LAW},
            {"film": None, "contact": FilmRebound(lambda speed, count: (0.7, 0.7, 0.6)[count] * speed, 0.5, 1e-4)},
            "contact.rebound",
        ),
        ({"film": None, "contact": LAW}, {"film": None, "contact": FilmRebound(LAW.rebound, 0.6, 1e-4)}, "edge"),
        (
            {"contact": SoftContact.linear(0.9, 900.0, 20.0)},
            {"contact": SoftContact.linear(0.9, 900.0, 21.0)},
            "contact.duration",
        ),
        (
            {"contact": SoftContact.hertz(0.9, 900.0, 20.0)},
            {"contact": SoftContact.hertz(0.8, 900.0, 20.0)},
            "contact.force",
        ),
        ({"contact": _hertz_like(1.0)}, {"contact": _hertz_like(1.001)}, "contact.force"),
        ({}, {"drive": None}, "drive"),
        ({}, {"drive": _driven(0.021)}, "drive"),
        ({}, {"drive": _driven(0.02, below=4.0)}, "drive"),
        ({}, {"gravity": (0.0, 0.0, -2e-4)}, "gravity"),
        ({}, {"fraction": 0.1}, "fraction"),
        ({}, {"interpolation": "central-linear"}, "interpolation"),
    ],
)
def test_a_simulation_with_another_law_of_motion_is_refused(tmp_path, one, other, named):
    def flow(changes):
        simulation = Simulation((16, 16, 20), RATES, faces={"z": "no-slip"})
        simulation.add(Spheres([Sphere(3.0, 8.0, (8.0, 8.0, 9.0))], **{**FALLING, **changes}))
        return simulation

    flow(one).save(tmp_path / "state.h5")
    flow(one).restore(tmp_path / "state.h5")
    with pytest.raises(InputError, match=named):
        flow(other).restore(tmp_path / "state.h5")
