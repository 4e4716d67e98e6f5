"""The motion at a wall on its own, without a fluid: each contact against what mechanics says of it."""

import math

import pytest

from lbm import InputError
from lbm.spheres import DryRebound, Film, FilmRebound, SoftContact
from lbm.spheres.wall_motion import FRACTION, motion_at_wall

MASS = 900.0
FILM = Film(0.5, 0.01, lambda gap, velocity, onset: -0.2 * velocity / gap)
FORCELESS = Film(0.5, 0.01)


def _fly(motion, gap, v, steps, weight=0.0):
    """Gaps, velocities and impacts of ``steps`` steps without a fluid."""
    gaps, speeds, impacts = [gap], [v], []
    for n in range(steps):
        gap, v, new = motion.step(float(n), gap, v, 0.0, weight, MASS)
        gaps.append(gap)
        speeds.append(v)
        impacts += new
    return gaps, speeds, impacts


@pytest.mark.parametrize(
    ("contact", "e"),
    [
        (DryRebound(0.8, 0.0, 10.0, 0.0), 0.8),
        (SoftContact.linear(0.8, MASS, 20.0), 0.8),
        (SoftContact.hertz(0.8, MASS, 20.0), 0.8),
        (FilmRebound(lambda speed, count: 0.8 * speed, 0.5, 0.0), 0.8),
    ],
    ids=["dry", "linear", "hertz", "law"],
)
def test_without_film_the_contact_alone_decides_the_rebound(contact, e):
    motion = motion_at_wall(FORCELESS, contact, FRACTION)
    _, speeds, impacts = _fly(motion, 3.03, -0.05, 120)
    assert len(impacts) == 1
    assert speeds[-1] / 0.05 == pytest.approx(e, rel=0.02)
    assert impacts[0].speed_in == pytest.approx(0.05, rel=1e-9)
    # 3.03 cells at 0.05; a soft contact ends a duration later
    assert impacts[0].step == pytest.approx(60.6 + getattr(contact, "duration", 0.0), abs=0.7)


def test_a_film_takes_what_its_resistance_integrates_to():
    """m dv = -0.2 dh/h on the way in, whatever the steps: v falls by 0.2 ln(cut_off/floor)/m."""
    motion = motion_at_wall(FILM, DryRebound(1.0, 0.0, 10.0, 0.0), FRACTION)
    _, _, impacts = _fly(motion, 2.0, -0.05, 60)
    assert 0.05 - impacts[0].speed_in == pytest.approx(0.2 * math.log(0.5 / 0.01) / MASS, rel=1e-3)


def test_without_contact_nothing_stops_the_sphere():
    motion = motion_at_wall(FORCELESS, None, FRACTION)
    gaps, speeds, impacts = _fly(motion, 1.0, -0.05, 40)
    assert gaps[-1] == pytest.approx(-1.0)
    assert (speeds[-1], impacts) == (-0.05, [])


def test_under_its_weight_a_dry_sphere_comes_to_rest_on_the_floor_of_the_film():
    gaps, speeds, impacts = _fly(
        motion_at_wall(FILM, DryRebound(0.3, 0.0, 10.0, 0.0), FRACTION), 1.0, -0.05, 400, -0.5
    )
    assert (gaps[-1], speeds[-1]) == (FILM.floor, 0.0)
    assert impacts[-1].speed_out == 0.0
    assert len(impacts) > 2


@pytest.mark.parametrize(
    "contact",
    [
        None,
        DryRebound(0.9, 400.0, 10.0, 0.0),
        SoftContact.linear(0.9, MASS, 20.0),
        FilmRebound(lambda speed, count: (0.9, 0.5)[min(count, 1)] * speed, 1.0, 1e-4),
    ],
    ids=["none", "dry", "soft", "law"],
)
@pytest.mark.parametrize("stopped", [15, 35, 50])
def test_a_motion_goes_on_from_its_numbers(contact, stopped):
    film = None if isinstance(contact, FilmRebound) else FILM
    whole, first, second = (motion_at_wall(film, contact, FRACTION) for _ in range(3))
    gaps, speeds, _ = _fly(whole, 1.8, -0.05, 60, -0.02)
    _fly(first, 1.8, -0.05, stopped, -0.02)
    second.remember(first.numbers())
    gap, v = gaps[stopped], speeds[stopped]
    for n in range(stopped, 60):
        gap, v, _ = second.step(float(n), gap, v, 0.0, -0.02, MASS)
    assert (gap, v) == (gaps[-1], speeds[-1])


@pytest.mark.parametrize(
    "make",
    [
        lambda: SoftContact(lambda *given: 0.0, 0.0),
        lambda: SoftContact.linear(0.9, MASS, -1.0),
        lambda: SoftContact.hertz(0.9, 0.0, 20.0),
        lambda: DryRebound(1.1, 0.0, 10.0, 0.0),
        lambda: DryRebound(0.9, -1.0, 10.0, 0.0),
        lambda: FilmRebound(lambda speed, count: speed, 0.0, 0.0),
        lambda: FilmRebound(lambda speed, count: speed, 0.5, -1e-4),
        lambda: Film(0.5, 0.6),
    ],
)
def test_contacts_and_films_out_of_range_are_refused(make):
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize(
    ("film", "contact", "fraction"),
    [
        (FILM, FilmRebound(lambda speed, count: speed, 0.5, 0.0), FRACTION),
        (None, "dry", FRACTION),
        (None, DryRebound, FRACTION),
        (None, None, 0.0),
        (None, None, 0.6),
    ],
)
def test_what_does_not_go_together_is_refused(film, contact, fraction):
    with pytest.raises(InputError):
        motion_at_wall(film, contact, fraction)


# The fluid's answer to a dry rebound

DIAMETER, VISCOSITY = 10.0, 1.5e-3
JUMP = 0.05 * (1 + 0.8)


def _after_rebound(contact, force, steps):
    """Velocities 1/2, 3/2, ... steps after the contact; the fluid pushes with ``force(step after it)``."""
    motion = motion_at_wall(FORCELESS, contact, FRACTION)
    gap, v, _ = motion.step(0.0, FORCELESS.floor + 0.025, -0.05, 0.0, 0.0, MASS)
    found = [v]
    for n in range(steps):
        if motion.matters(gap, v):
            gap, v, _ = motion.step(float(n + 1), gap, v, force(n), 0.0, MASS)
        found.append(v)
    return found


def test_until_sound_is_gone_the_sphere_has_bassets_force_of_the_jump():
    """The impulse over that of the displaced mass is 9 sqrt(T/pi), T = nu t/a^2 (lbm.problems.impulsive_start)."""
    contact = DryRebound(0.8, 300.0, DIAMETER, VISCOSITY)
    found = _after_rebound(contact, lambda n: -3.0, 60)
    settled = math.ceil(2.5 * DIAMETER * math.sqrt(3))
    displaced = math.pi / 6 * DIAMETER**3
    for n in (1, 10, 40):
        exact = 9 / math.sqrt(math.pi) * math.sqrt(VISCOSITY * (n + 0.5) / (DIAMETER / 2) ** 2)
        assert 0.04 - found[n] == pytest.approx(exact * displaced * JUMP / MASS, rel=1e-3)
    assert found[-1] == found[settled]  # beyond the film, past that time, the motion is no affair of the wall


def test_then_it_has_the_fluids_force_again():
    contact = DryRebound(0.8, 0.0, 0.4, 0.0)  # sound is gone after 1.7 steps, still in the film
    found = _after_rebound(contact, lambda n: -0.9, 5)
    assert found[1] == pytest.approx(0.04, rel=1e-9)
    assert found[5] - found[4] == pytest.approx(-0.9 / MASS, rel=1e-6)


def test_a_motion_within_the_answer_goes_on_from_its_numbers():
    contact = DryRebound(0.8, 300.0, DIAMETER, VISCOSITY)
    whole, other = (motion_at_wall(FORCELESS, contact, FRACTION) for _ in range(2))
    gap, v = FORCELESS.floor + 0.05, -0.05
    for n in range(30):
        gap, v, _ = whole.step(float(n), gap, v, -1.0, 0.0, MASS)
    other.remember(whole.numbers())
    assert whole.step(30.0, gap, v, -1.0, 0.0, MASS) == other.step(30.0, gap, v, -1.0, 0.0, MASS)
