"""A way into the wall, holes, copies and impossible fluids are doubted; soft contacts and pixels are not."""

import numpy as np
import pytest

from restitution.doubts import of_track
from restitution.tracks import contacts
from tests.flights import STEEL_IN_OIL, as_track, film, fly

D = STEEL_IN_OIL.sphere.diameter
FLIGHTS, TRUTHS = fly(9e-3, -0.3, (0.75, 0.6), 0.6)
TIMES = np.arange(0, FLIGHTS[-1].end, 1e-3)
GAP = film(FLIGHTS, TIMES)[0] + 1e-5 * np.random.default_rng(0).standard_normal(len(TIMES))


def names(times, gap, conditions=STEEL_IN_OIL):
    track = as_track(times, gap)
    return [doubt.name for doubt in of_track(track, contacts(track), conditions)]


def test_the_record_itself_is_not_doubted():
    assert names(TIMES, GAP) == []


@pytest.mark.parametrize(("shift", "doubted"), [(0.33, True), (0.15, True), (0.01, False)])
def test_a_wall_that_is_placed_too_high(shift, doubted):
    """A third of a diameter is no contact; a hundredth may be the overlap of a soft one."""
    assert ("wall" in names(TIMES, GAP - shift * D)) == doubted


def test_a_contact_within_a_hole_is_one_where_both_sides_meet_there():
    first, second = (truth.time_s for truth in TRUTHS)
    for begin, end, doubted in ((-8e-3, 8e-3, []), (-2e-3, 2e-3, []), (-4e-3, second - first + 4e-3, ["hole"])):
        keep = (first + begin > TIMES) | (first + end < TIMES)
        assert names(TIMES[keep], GAP[keep]) == doubted


def test_pictures_that_are_there_four_times():
    k = 4 * (np.arange(len(TIMES)) // 4)
    assert "repeated" in names(TIMES, GAP[k])
    assert "repeated" not in names(TIMES, 1e-4 * np.round(GAP / 1e-4))


def test_a_kinematic_viscosity_in_place_of_the_dynamic_one():
    thin = STEEL_IN_OIL.model_copy(update={"fluid": STEEL_IN_OIL.fluid.model_copy(update={"viscosity": 1.07e-5})})
    assert names(TIMES, GAP, thin) == ["viscosity"]
    air = thin.model_copy(update={"fluid": thin.fluid.model_copy(update={"density": 1.2})})
    assert "viscosity" not in names(TIMES, GAP, air)
