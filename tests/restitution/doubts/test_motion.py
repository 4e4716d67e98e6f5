"""What a falling sphere cannot do is doubted, with the mistake that makes it seem so; ordinary records are not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from restitution import datasets
from restitution.conditions import Conditions
from restitution.doubts import Doubt, cleaned, of_track
from restitution.errors import InputError
from restitution.tracks import Track, contacts
from tests.flights import STEEL_IN_OIL, as_track, film, fly


def doubts(track, conditions):
    clean = cleaned(track)
    return [*clean.doubts, *of_track(clean.track, contacts(clean.track), conditions)]


def names(track, conditions):
    return [doubt.name for doubt in doubts(track, conditions)]


def steady_fall(c):
    """Speed at which the standard drag, 24/Re (1 + 0.15 Re^0.687), carries the weight in the fluid."""
    d, mu, rho = c.sphere.diameter, c.fluid.viscosity, c.fluid.density
    weight = (c.sphere.density - rho) * np.pi * d**3 / 6 * c.gravity
    return brentq(lambda v: 3 * np.pi * mu * d * v * (1 + 0.15 * (v * d * rho / mu) ** 0.687) - weight, 1e-9, 1e3)


def ordinary(seed, quantity="gap"):
    """A sphere of 2 to 12 mm in a liquid of 1 to 20 mPa s that bounces twice, as a camera sees it; its
    conditions."""
    rng = np.random.default_rng([99, seed])
    c = Conditions.model_validate(
        {
            "fluid": {"density": rng.uniform(800, 1200), "viscosity": 10 ** rng.uniform(-3, -1.7)},
            "sphere": {
                "diameter": rng.uniform(2e-3, 12e-3),
                "density": rng.choice([2500.0, 7800.0]),
                "e_dry": 0.97,
            },
        }
    )
    d, g = c.sphere.diameter, c.gravity
    fall = g * (c.sphere.density - c.fluid.density) / (c.sphere.density + c.fluid.density / 2)
    flights, _ = fly(rng.uniform(5, 12) * d, 0.0, rng.uniform(0.6, 0.85, 2), steady_fall(c), fall)
    times = np.arange(0, flights[-1].end, rng.uniform(0.03, 0.12) * np.sqrt(d / g))
    times = times[rng.random(len(times)) > 0.05]
    gap, velocity = film(flights, times)
    if quantity == "gap":
        return as_track(times, gap + 0.003 * d * rng.standard_normal(len(times))), c
    return as_track(times, velocity + 0.01 * np.sqrt(g * d) * rng.standard_normal(len(times)), "velocity"), c


def changed(c, fluid=None, sphere=None):
    """The conditions with some numbers multiplied."""
    f = {k: v * getattr(c.fluid, k) for k, v in (fluid or {}).items()}
    s = {k: v * getattr(c.sphere, k) for k, v in (sphere or {}).items()}
    return c.model_copy(update={"fluid": c.fluid.model_copy(update=f), "sphere": c.sphere.model_copy(update=s)})


@pytest.mark.parametrize("quantity", ["gap", "velocity"])
def test_ordinary_records_are_not_doubted(quantity):
    found = {seed: names(*ordinary(seed, quantity)) for seed in range(100)}
    assert {seed: n for seed, n in found.items() if n} == {}


def test_shipped_records_are_not_doubted():
    for name in datasets.names():
        resource = datasets.resource(name)
        if resource.table in ("trajectory", "settling"):
            assert doubts(datasets.load_track(name), resource.conditions) == [], name


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("factor", [2.0, 4.0, 8.0, 33.3])
def test_a_film_played_slowly_is_told_by_how_much(seed, factor):
    track, c = ordinary(seed)
    (doubt,) = doubts(replace(track, time_s=factor * track.time_s), c)
    assert doubt.name == "clock"
    said = float(doubt.message.split("times are ")[1].split()[0])
    assert said == pytest.approx(factor, rel=0.15)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("length", "time"), [(1e3, 1.0), (1e-3, 1.0), (1.0, 1e3), (1.0, 0.3), (7.0, 1.0)])
def test_wrong_units_are_doubted(seed, length, time):
    track, c = ordinary(seed)
    wrong = Track(time * track.time_s, length * track.value, "gap", length * track.sigma)
    assert names(wrong, c) == ["clock"]


@pytest.mark.parametrize("seed", range(8))
def test_dimensionless_numbers_taken_for_metres_and_seconds_are_doubted(seed):
    """Times in d/v, gaps in d, as solvers write them."""
    track, c = ordinary(seed)
    d, v = c.sphere.diameter, 0.8 * steady_fall(c)
    if d * (d / v) ** -2 > 0.5:  # by chance near to one
        return
    assert "clock" in names(Track(track.time_s * v / d, track.value / d, "gap", track.sigma / d), c)


@pytest.mark.parametrize("seed", range(8))
def test_a_viscosity_in_centipoise_is_named(seed):
    track, c = ordinary(seed)
    (doubt,) = doubts(track, changed(c, fluid={"viscosity": 1e3}))
    assert (doubt.name, "mPa s" in doubt.message) == ("speed", True)


def test_a_sphere_lighter_than_its_fluid_that_falls_is_named():
    track, c = ordinary(3)
    light = c.model_copy(update={"sphere": c.sphere.model_copy(update={"density": 0.1 * c.fluid.density})})
    assert names(track, light) == ["lighter"]


def test_a_viscosity_below_that_of_any_gas_is_named():
    """As a kinematic one of water, taken for a dynamic one."""
    track, c = ordinary(3)
    thin = c.model_copy(update={"fluid": c.fluid.model_copy(update={"viscosity": 1e-6})})
    assert names(track, thin)[0] == "viscosity"


@pytest.mark.parametrize("seed", range(8))
def test_densities_in_grams_a_cubic_centimetre_are_named(seed):
    track, c = ordinary(seed)
    (doubt,) = doubts(track, changed(c, fluid={"density": 1e-3}, sphere={"density": 1e-3}))
    assert (doubt.name, "g/cm3" in doubt.message) == ("speed", True)


def test_a_radius_for_the_diameter_is_named():
    """Where the sphere nears its terminal speed; a sphere that fell from a few diameters alone cannot tell."""
    named = 0
    for seed in range(40):
        track, c = ordinary(seed)
        found = doubts(track, changed(c, sphere={"diameter": 0.5}))
        named += any("radius" in doubt.message for doubt in found)
        assert all(doubt.name == "speed" for doubt in found)
    assert named >= 5


@pytest.mark.parametrize("seed", range(8))
def test_upside_down_records_are_named(seed):
    track, c = ordinary(seed)
    top = track.value.max()
    still = np.full(40, top) + track.sigma * np.random.default_rng(seed).standard_normal(40)
    fallen = top - track.value
    times = np.append(track.time_s, track.time_s[-1] + np.median(np.diff(track.time_s)) * np.arange(1, 41))
    for down in (replace(track, value=fallen), Track(times, np.append(fallen, still), "gap", track.sigma)):
        found = doubts(down, c)
        assert [d.name for d in found] == ["direction"]
        assert "--direction down" in found[0].message


@pytest.mark.parametrize("seed", range(8))
def test_velocities_of_a_fall_counted_positive_are_named(seed):
    track, c = ordinary(seed, "velocity")
    (doubt,) = doubts(replace(track, value=-track.value), c)
    assert (doubt.name, "--direction down" in doubt.message) == ("direction", True)


@pytest.mark.parametrize("seed", range(8))
def test_heights_of_the_centre_are_named(seed):
    track, c = ordinary(seed)
    (doubt,) = doubts(replace(track, value=track.value + c.sphere.radius), c)
    assert (doubt.name, "--point centre" in doubt.message) == ("centre", True)


@pytest.mark.parametrize("seed", range(8))
def test_a_minimum_in_mid_air_is_no_contact(seed):
    """Twenty neighbouring frames of a fall follow something else, deeper by a third of the height."""
    track, _ = ordinary(seed)
    value = track.value.copy()
    falling = np.flatnonzero(value < 0.8 * value[0])[0]
    height = value[falling]
    value[falling : falling + 20] = 0.7 * height + 0.1 * height * np.abs(np.linspace(-1, 1, 20))
    found = contacts(replace(track, value=value))
    assert len(found.contacts) == len(contacts(track).contacts)
    assert any(falling <= i < falling + 20 for i in found.hovering)


def dropped(seed, fps=1000.0, noise=2e-5):
    """Steel of 3 mm in oil that falls from rest at 20 mm and bounces three times."""
    c = STEEL_IN_OIL
    rng = np.random.default_rng([98, seed])
    flights, _ = fly(rng.uniform(15e-3, 25e-3), 0.0, (0.8, 0.7, 0.55), steady_fall(c), c.free_fall)
    times = np.arange(rng.uniform(0, 1 / fps), flights[-1].end, 1 / fps)
    return as_track(times, film(flights, times)[0] + noise * rng.standard_normal(len(times))), c


@pytest.mark.parametrize(("length", "time"), [(1.1, 1.0), (1.0, 1.1), (1 / 1.2, 1.0), (1.0, 0.95), (2.0, 1.0)])
def test_a_tenth_is_seen_where_flights_are_long(length, time):
    """Of a clock or a pixel; the factor that is said is that of the acceleration."""
    for seed in range(8):
        track, c = dropped(seed)
        assert doubts(track, c) == []
        (doubt,) = doubts(Track(time * track.time_s, length * track.value, "gap", length * track.sigma), c)
        assert doubt.name == "clock"
        times = float(doubt.message.split("times are ")[1].split()[0])
        away = np.sqrt(length) / time
        assert times == pytest.approx(away if "short" in doubt.message else 1 / away, rel=0.05)


def test_a_wake_is_no_wrong_clock():
    """As strong as after the first rebound of the 3 mm sphere of Gondret et al. (2002), a third of v_in/T."""
    c = STEEL_IN_OIL
    for seed in range(20):
        rng = np.random.default_rng([97, seed])
        wake, decay = rng.uniform(0.2, 0.7), rng.uniform(4e-3, 15e-3)
        start = rng.uniform(15e-3, 25e-3)
        flights, _ = fly(start, 0.0, (0.8, 0.7, 0.55), steady_fall(c), c.free_fall, wake=wake, decay=decay)
        times = np.arange(0, flights[-1].end, 1e-3)
        track = as_track(times, film(flights, times)[0] + 2e-5 * rng.standard_normal(len(times)))
        assert doubts(track, c) == []


def test_a_wrong_solid_or_liquid_is_named_as_such():
    for seed in range(6):
        track, c = dropped(seed)
        (glass,) = doubts(track, changed(c, sphere={"density": 2500 / 7800}))
        assert float(glass.message.split("a sphere of ")[1].split()[0]) == pytest.approx(7800, rel=0.15)
        (thick,) = doubts(track, changed(c, fluid={"viscosity": 10}))
        assert (thick.name, "viscosity" in thick.message, "mPa s" in thick.message) == ("speed", True, False)
        for other in (
            changed(c, sphere={"density": 1e-3}),
            changed(c, sphere={"density": 935 / 7800}, fluid={"density": 7800 / 935}),
        ):
            (light,) = doubts(track, other)
            assert (light.name, "rises" in light.message) == ("lighter", True)


@pytest.mark.parametrize("times", [10.0, 25.4])
def test_a_diameter_in_centimetres_or_inches_is_named(times):
    for seed in range(4):
        track, c = dropped(seed, noise=1e-5)
        (doubt,) = (d for d in doubts(track, changed(c, sphere={"diameter": 1 / times})) if d.name == "speed")
        assert f"{times:g} times as large" in doubt.message


def test_a_dense_sphere_taken_for_steel_is_named():
    """Tungsten carbide of 5 mm in 50 mPa s: free fall hardly tells it, what it is faster than steel falls does."""
    c = Conditions.model_validate(
        {
            "fluid": {"density": 963, "viscosity": 0.05},
            "sphere": {"diameter": 5e-3, "density": 14900, "e_dry": 0.93},
        }
    )
    for seed in range(4):
        rng = np.random.default_rng([96, seed])
        flights, _ = fly(0.07, 0.0, (0.75, 0.64, 0.48), steady_fall(c), c.free_fall)
        times = np.arange(rng.uniform(0, 5e-4), flights[-1].end, 5e-4)
        track = as_track(times, film(flights, times)[0] + 1e-5 * rng.standard_normal(len(times)))
        assert doubts(track, c) == []
        (doubt,) = doubts(track, changed(c, sphere={"density": 7800 / 14900}))
        assert doubt.name == "speed"
        low, high = (
            float(x.strip("?) ")) for x in doubt.message.split("as one of ")[1].split(")")[0].split(" to ")
        )
        assert 9000 < low < 14900 * 1.1
        assert high > 14900 * 0.9


def test_an_upside_down_record_on_a_players_clock_is_told_both():
    for seed in range(4):
        track, c = dropped(seed)
        rest = 2e-5 * np.random.default_rng(seed).standard_normal(80)
        fallen = 0.03 - np.r_[track.value, rest]
        assert names(as_track(np.arange(len(fallen)) / 30, fallen), c) == ["direction", "clock"]


@pytest.mark.parametrize("quantity", ["gap", "velocity"])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("slow", [3.0, 10.0, 30.0])
def test_upside_down_and_slow_is_told_both_while_the_sphere_still_bounces(seed, slow, quantity):
    """A record of long flights, far more frames than in :func:`ordinary`, that ends in mid-air."""
    c = STEEL_IN_OIL
    d, g = c.sphere.diameter, c.gravity
    fall = g * (c.sphere.density - c.fluid.density) / (c.sphere.density + c.fluid.density / 2)
    flights, _ = fly(10 * d, 0.0, [0.8, 0.7, 0.6], steady_fall(c), fall)
    times = np.arange(0, flights[-1].end - 0.02, 1e-3)
    noise = np.random.default_rng([3, seed]).standard_normal(len(times))
    gap, velocity = film(flights, times)
    told = 12 * d - gap - 5e-6 * noise if quantity == "gap" else -(velocity + 1e-3 * noise) / slow
    found = doubts(as_track(slow * times, told, quantity), c)
    assert [doubt.name for doubt in found] == ["direction", "clock"]
    right = as_track(slow * times, 12 * d - told if quantity == "gap" else -told, quantity)
    assert "direction" not in names(right, c)


def test_a_sphere_that_rises_to_a_ceiling_is_not_doubted():
    """Lighter than the liquid, the gap counted from the ceiling: it falls upwards, by the same equation."""
    c = changed(STEEL_IN_OIL, sphere={"density": 50 / 7800})
    flights, _ = fly(0.02, 0.0, (0.6, 0.5), steady_rise(c), abs(c.free_fall))
    times = np.arange(0, flights[-1].end, 5e-4)
    track = as_track(times, film(flights, times)[0] + 1e-5 * np.random.default_rng(0).standard_normal(len(times)))
    assert doubts(track, c) == []


def steady_rise(c):
    heavier = 2 * c.fluid.density - c.sphere.density  # the same weight in the fluid, downwards
    return steady_fall(changed(c, sphere={"density": heavier / c.sphere.density}))


def test_a_hole_is_all_that_is_doubtful_about_a_record_with_one():
    """The approach is not whole: what it says of a terminal speed is no second doubt."""
    for seed in range(8):
        track, c = dropped(seed)
        first = contacts(track).contacts[0].nearest
        for begin, end in ((first - 28, first + 12), (first + 1, first + 70)):
            keep = np.setdiff1d(np.arange(len(track.value)), np.arange(begin, end))
            found = names(replace(track, time_s=track.time_s[keep], value=track.value[keep]), c)
            assert set(found) <= {"minimum", "hole"}


def test_doubts_are_refused_as_input():
    from restitution.doubts import refuse

    refuse([])
    with pytest.raises(InputError) as error:
        refuse([Doubt("clock", "one", "a.csv"), Doubt("clock", "one", "a.csv"), Doubt("speed", "two")])
    assert [str(d) for d in error.value.defects] == ["a.csv: one", "two"]
