"""Spheres that nothing stops: how far they are followed, and that each step on the way is one of finite work."""

import numpy as np
import pytest

from lbm import InputError, Simulation
from lbm.spheres import Sphere, Spheres
from lbm.spheres.wall_motion import FRACTION, motion_at_wall

MIDDLE = (12.0, 10.0, 10.0)


def _driven(faces, spheres, drive=None, steps=400):
    flow = Simulation((24, 20, 20), viscosity=0.05, faces=faces)
    balls = Spheres(spheres, drive=drive)
    flow.add(balls)
    with pytest.raises(InputError) as refused:
        flow.run(steps)
    return flow, balls, str(refused.value)


def _to(x):
    return lambda step, gap: (x, 0.0, 0.0)


@pytest.mark.parametrize(("face", "out"), [("no-slip", 0.0), ("outlet", 0.0), ("free-slip", -3.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_a_sphere_is_followed_to_the_face_by_its_centre_and_to_a_mirror_by_its_surface(face, out, way):
    flow, balls, why = _driven({"x": face}, [Sphere(3.0, 2.0, MIDDLE)], _to(0.05 * way))
    beyond = balls.centres[0, 0] - 24 if way > 0 else -balls.centres[0, 0]
    assert out < beyond <= out + 0.1 + 1e-9  # two steps may be made at once
    assert ("x+" if way > 0 else "x-") in why
    assert np.isfinite(flow.velocity).all()


def test_spheres_are_followed_until_they_meet():
    _, balls, why = _driven(
        {}, [Sphere(3.0, 60.0, (8.0, 10.0, 10.0), (0.05, 0.0, 0.0)), Sphere(3.0, 2.0, (16.0, 10.0, 10.0))]
    )
    assert 5.5 < balls.centres[1, 0] - balls.centres[0, 0] < 6.0
    assert "0 and 1" in why


def test_in_the_wall_without_film_or_contact_a_step_is_a_few_sub_steps(monkeypatch):
    motion = motion_at_wall(None, None, FRACTION)
    count, one = [], motion._substep
    monkeypatch.setattr(motion, "_substep", lambda *given: count.append(1) or one(*given))
    gap, v, _ = motion.step(0.0, -0.5, -0.05, 0.0, -9.0, 900.0)
    assert len(count) <= 8
    assert (gap, v) == pytest.approx((-0.5 - 0.05 - 0.005, -0.06))  # constant force: exact
