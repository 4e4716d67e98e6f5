"""Units at the door: texts with units become SI numbers of the dimension that is asked for."""

import pytest

from restitution.conditions import Conditions, Fluid
from restitution.units import UnitError, in_si


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("10 mPa s", "Pa s", 0.010),
        ("10 mPa·s", "Pa s", 0.010),
        ("10mPas", "Pa s", 0.010),
        ("6.2 cP", "Pa s", 0.0062),
        ("0.01 kg/(m s)", "Pa s", 0.01),
        ("7.8 g/cm3", "kg/m3", 7800.0),
        ("7.8 g cm^-3", "kg/m3", 7800.0),
        ("7.8 kg/l", "kg/m3", 7800.0),
        ("3 mm", "m", 3e-3),
        ("300 µm", "m", 3e-4),
        ("0.5 in", "m", 0.0127),
        ("10.7 cSt", "m2/s", 1.07e-5),
        ("20 cm/s", "m/s", 0.2),
        ("981 cm/s²", "m/s2", 9.81),
        ("1/500 s", "s", 2e-3),
        ("1.5e-5s", "s", 1.5e-5),
        ("10 мПа·с", "Pa s", 0.010),
        ("7.8 г/см3", "kg/m3", 7800.0),
        ("10.7 сСт", "m2/s", 1.07e-5),
        ("300 мкм", "m", 3e-4),
        ("20 см/с", "m/s", 0.2),
        ("2 кГц", "1/s", 2000.0),
        ("5 毫秒", "s", 5e-3),
        ("3 ㎜", "m", 3e-3),
        (0.25, "m", 0.25),
    ],
)
def test_quantities(text, unit, value):
    assert in_si(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    ["3", "", "mm mm", "3 ms", "1,5 mm", "3 foo", "1/0 m", "1e400 m", "(m", "m^99999999", "m" * 99, "3 mm !"],
)
def test_what_is_no_length(text):
    with pytest.raises(UnitError):
        in_si(text, "m")


def test_conditions_in_the_units_of_a_laboratory():
    given = {
        "fluid": {"density": "0.935 g/cm3", "viscosity": "10 mPa s"},
        "sphere": {"diameter": "3 mm", "density": "7.8 g/cm3", "roughness": "0.15 µm"},
        "gravity": "981 cm/s2",
    }
    si = {
        "fluid": {"density": 935.0, "viscosity": 0.010},
        "sphere": {"diameter": 3e-3, "density": 7800.0, "roughness": 1.5e-7},
        "gravity": 9.81,
    }
    assert Conditions.model_validate(given) == Conditions.model_validate(si)


def test_a_kinematic_viscosity_is_times_the_density():
    assert Fluid(density=935.0, viscosity="10 cSt").viscosity == pytest.approx(935.0 * 1e-5)
    assert Fluid(density="0.935 g/cm3", viscosity="10 mm2/s").viscosity == pytest.approx(935.0 * 1e-5)
