"""Conditions that no liquid and no record has."""

import pytest

from restitution import datasets
from restitution.calibration.result.design import candidates
from restitution.cases.reading import names, read_case
from restitution.cli import main
from restitution.conditions import Conditions
from restitution.doubts.pace import of_speed
from restitution.doubts.stated import of_conditions, of_fluid, of_size
from tests.flights import STEEL_IN_OIL, as_track
from tests.restitution.doubts.test_clock import filmed


def conditions(density, viscosity, diameter=3e-3, solid=7800.0):
    return Conditions.model_validate(
        {
            "fluid": {"density": density, "viscosity": viscosity},
            "sphere": {"diameter": diameter, "density": solid},
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


@pytest.mark.parametrize(
    ("stated", "named", "hint"),
    [
        (conditions(935.0, 0.01, 3.0), "size", '"3 mm"'),
        (conditions(935.0, 0.01, 0.5), "size", '"0.5 mm"'),
        (conditions(0.935, 0.01), "density", "g/cm3"),
        (conditions(935.0, 0.01, solid=7.8), "density", "g/cm3"),
        (conditions(935.0, 0.01, solid=7.8e6), "density", "kg/m3"),
        (conditions(998.0, 1e-6), "viscosity", "cSt"),
        (conditions(998.0, 1e-4), "viscosity", "a tenth"),
    ],
)
def test_numbers_without_their_unit_are_named_where_no_motion_is_known(stated, named, hint):
    (doubt,) = of_conditions([stated, stated], "my.toml")
    assert (doubt.name, doubt.where) == (named, "my.toml")
    assert hint in doubt.message


def test_shipped_records_cases_and_pairs_are_not_doubted():
    known = [datasets.resource(name).conditions for name in datasets.names()]
    known += [read_case(name).conditions for name in names()] + [c.conditions for c in candidates()]
    assert of_conditions(known) == []


@pytest.mark.parametrize(("density", "viscosity"), [(770, 7e-5), (1141, 1.9e-4), (626, 2.2e-4), (1.2, 1.8e-5)])
def test_the_thinnest_liquids_and_gases_are_not_doubted(density, viscosity):
    """Carbon dioxide at 20 C, liquid oxygen, pentane, air."""
    assert of_conditions([conditions(density, viscosity)]) == []


def test_a_speed_that_nothing_falls_with_is_doubted():
    """Terminal speed of the steel sphere in oil of 10 mPa s: 0.58 m/s (Schiller & Naumann: 0.60)."""
    oil, typed = conditions(935.0, 0.01), conditions(935.0, 10.0)
    assert of_speed(0.6, oil) == of_speed(2.0, oil) == []  # a pendulum may be faster than a fall
    (doubt,) = of_speed(600.0, oil)
    assert '"600 mm/s"' in doubt.message
    (doubt,) = of_speed(150.0, typed, by_stokes=True)
    assert '"10 mPa s"' in doubt.message


@pytest.mark.parametrize(
    ("density", "edge_d", "doubted"),
    [(1140, 0.1, True), (2500, 0.1, True), (1140, 0.2, False), (7800, 0.1, False), (800, 0.1, False)],
)
def test_a_light_sphere_that_leaves_a_thin_film_is_doubted(tmp_path, capsys, density, edge_d, doubted):
    (tmp_path / "case.toml").write_text(
        f'[fluid]\ndensity = 1000\nviscosity = "2.5 mPa s"\n[sphere]\ndiameter = "6 mm"\ndensity = {density}\n'
        'e_dry = 0.95\n[release]\nkind = "rest"\ngap_d = 3\n[film]\nform = "none"\n'
        f'[contact]\nmode = "effective"\nmeasured = [0.6]\nedge_d = {edge_d}\n[run]\nafter_contact = 0.05\n'
    )
    status = main(["bounce", str(tmp_path / "case.toml"), "--out", str(tmp_path / "out")])
    if density < 1000:
        assert status == 2, "it rises"
    else:
        assert not status
        assert ("doubt: a sphere" in capsys.readouterr().out) == doubted
