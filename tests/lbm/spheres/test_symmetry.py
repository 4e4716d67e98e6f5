"""A sphere on the edge of two mirrors is the whole sphere: the quarter of a box against the whole one."""

import numpy as np
import pytest

from lbm import InputError, Rates, Simulation
from lbm.spheres import RESOLVED, DryRebound, Film, Sphere, Spheres, lattice_added_mass, lost_to_grid

RADIUS, WIDTH, HEIGHT = 3.0, 20, 24
ALONG_AXIS = ("gap", "z", "vz", "fz")


def falling(box, centre, faces, steps):
    """A driven sphere, set free at 2 cells of gap, that meets the wall and leaves it."""
    volume = 4 / 3 * np.pi * RADIUS**3

    def drive(step, gap):
        return None if gap < 2 else (0.0, 0.0, -0.06 * min(1.0, step / 40))

    contact = DryRebound(0.97, volume * lattice_added_mass(2 * RADIUS), 2 * RADIUS, 0.0)
    film = Film(RESOLVED, 1e-3, lambda gap, v, _: -6 * np.pi * 0.02 * RADIUS**2 * v * lost_to_grid(gap), None)
    flow = Simulation(box, Rates.two_relaxation_times(0.02), faces={"z": "no-slip", **faces})
    sphere = Sphere(RADIUS, 8.0, (*centre, RADIUS + 5))
    ball = Spheres([sphere], gravity=(0.0, 0.0, -2e-4), film=film, contact=contact, drive=drive)
    flow.add(ball)
    flow.run(steps)
    return flow, ball


@pytest.fixture(scope="module")
def whole():
    return falling((WIDTH, WIDTH, HEIGHT), (WIDTH / 2, WIDTH / 2), {}, 200)


MIRRORS = {
    "quarter": ((WIDTH // 2, WIDTH // 2, HEIGHT), (0, 0), {"x": "free-slip", "y": "free-slip"}),
    "half": ((WIDTH, WIDTH // 2, HEIGHT), (WIDTH / 2, 0), {"y": "free-slip"}),
    "quarter at the high faces": (
        (WIDTH // 2, WIDTH // 2, HEIGHT),
        (WIDTH // 2, WIDTH // 2),
        {"x": "free-slip", "y": "free-slip"},
    ),
}


@pytest.mark.parametrize("part", MIRRORS)
def test_a_part_between_mirrors_moves_as_the_whole(whole, part):
    """To round-off at first; over a first bounce, which amplifies it, to 1e-6 d."""
    _, ball = falling(*MIRRORS[part], 200)
    mine, its = ball.track(), whole[1].track()
    assert len(whole[1].impacts) == 1
    for name in ALONG_AXIS:
        scale = np.abs(its[name]).max()
        assert mine[name][:60] == pytest.approx(its[name][:60], abs=1e-12 * scale), name
    assert np.abs(mine["gap"] - its["gap"]).max() < 1e-6 * 2 * RADIUS


def test_the_flow_of_a_quarter_is_that_of_the_whole(whole):
    flow, _ = falling(*MIRRORS["quarter"], 200)
    n = WIDTH // 2
    assert flow.velocity == pytest.approx(whole[0].velocity[:, n:, n:], abs=1e-9)


@pytest.mark.parametrize(
    ("asymmetric", "what"),
    [
        ({"velocity": (0.01, 0.0, 0.0)}, "velocity of sphere 0: component x"),
        ({"spin": (0.0, 0.0, 1e-3)}, "spin of sphere 0: component z"),
        ({"position": (0.25, 0.0, 8.0)}, "beyond the face x-.*through the centre"),
    ],
)
def test_what_would_break_the_symmetry_is_refused(asymmetric, what):
    shape, (x, y), faces = MIRRORS["quarter"]
    flow = Simulation(shape, Rates.two_relaxation_times(0.02), faces=faces)
    start = {"radius": RADIUS, "density": 8.0, "position": (x, y, 8.0)} | asymmetric
    with pytest.raises(InputError, match=what):
        flow.add(Spheres([Sphere(**start)]))


def test_a_sphere_in_half_a_box_turns_about_the_normal_of_the_mirror():
    """Spin decays alike in the half and in the whole box, and pushes neither of them aside."""
    spins = []
    for shape, y, faces in (((16, 16, 16), 8.0, {}), ((16, 8, 16), 0.0, {"y": "free-slip"})):
        flow = Simulation(shape, Rates.two_relaxation_times(0.05), faces=faces)
        ball = Spheres([Sphere(RADIUS, 2.0, (8.0, y, 8.0), spin=(0.0, 0.01, 0.0))])
        flow.add(ball)
        flow.run(60)
        spins.append(ball.track()["wy"])
        assert np.abs(ball.track()["vz"]).max() < 1e-12
    assert 0 < spins[0][-1] < 0.009
    assert spins[1] == pytest.approx(spins[0], rel=1e-12)
