"""Conditions that no liquid and no record has."""

import pytest

from restitution.conditions import Conditions
from restitution.doubts.stated import of_fluid, of_size
from tests.flights import STEEL_IN_OIL, as_track
from tests.restitution.doubts.test_clock import filmed


def conditions(density, viscosity, diameter=3e-3):
    return Conditions.model_validate(
        {
            "fluid": {"density": density, "viscosity": viscosity},
            "sphere": {"diameter": diameter, "density": 7800.0},
        }
    )


@pytest.mark.parametrize(("density", "viscosity"), [(935.0, 1.07e-5), (998.0, 1e-6), (1200.0, 4e-5)])
def test_a_kinematic_viscosity_is_named(density, viscosity):
    (doubt,) = of_fluid(conditions(density, viscosity))
    assert f'"{viscosity * 1e6:g} cSt"' in doubt.message


@pytest.mark.parametrize(
    ("density", "viscosity"),
    [
        (998.0, 1e-3),
        (1.2, 1.8e-5),
        (808.0, 1.6e-4),
        (626.0, 2.2e-4),
        (70.8, 1.3e-5),
        (1260.0, 1.4),
        (13534.0, 1.5e-3),
    ],
)
def test_water_air_nitrogen_pentane_hydrogen_glycerol_and_mercury_are_fluids(density, viscosity):
    assert of_fluid(conditions(density, viscosity)) == []


def test_a_diameter_in_millimetres_is_named():
    track = as_track(*filmed(0))
    (doubt,) = of_size(track, 0.0, conditions(935.0, 0.01, 3.0))
    assert '"3 mm"' in doubt.message
    assert of_size(track, 0.0, STEEL_IN_OIL) == []
