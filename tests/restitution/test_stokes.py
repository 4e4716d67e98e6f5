"""Stokes numbers: the definitions against hand arithmetic, and that no convention passes for another."""

import numpy as np
import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import ConventionError, InputError
from restitution.stokes import CONVENTIONS, Speed, StokesNumber

GONDRET = Conditions.model_validate(
    {"fluid": {"density": 935, "viscosity": 0.01}, "sphere": {"diameter": 3e-3, "density": 7800}}
)
PAIR = GONDRET.model_copy(update={"partner": GONDRET.sphere})


@pytest.mark.parametrize(
    ("key", "value"),
    # v = 0.585 m/s by hand: rho_p v d/mu = 7800 * 0.585 * 3e-3 / 0.01 = 1368.9
    [("st_d", 1368.9), ("st", 152.1), ("st_18", 76.05), ("st_star", 152.1 * 8267.5 / 7800), ("st_b", 152.1)],
)
def test_definitions(key, value):
    assert StokesNumber.from_speed(0.585, GONDRET, key).value == pytest.approx(value, rel=1e-12)


def test_binary_form_of_equal_spheres_is_twice_that_of_a_wall():
    """m* = m/2, r* = r/2: St_B = (m/2) v/(6 pi mu r^2/4) = 2 St."""
    wall, pair = (StokesNumber.from_speed(0.3, c, "st_b").value for c in (GONDRET, PAIR))
    assert pair == pytest.approx(2 * wall, rel=1e-12)


@pytest.mark.parametrize("source", CONVENTIONS)
@pytest.mark.parametrize("target", CONVENTIONS)
def test_conversion_is_the_ratio_of_definitions(source, target):
    v = np.array([0.01, 0.3, 2.0])
    converted = StokesNumber.from_speed(v, PAIR, source).to(target, PAIR)
    assert converted.convention == target
    np.testing.assert_allclose(converted.value, StokesNumber.from_speed(v, PAIR, target).value, rtol=1e-13)


def test_fixed_ratios_need_no_conditions_and_the_others_refuse():
    assert StokesNumber(152.0, "st").to("st_d").value == pytest.approx(1368)
    assert StokesNumber(152.0, "st_18").to("st").value == pytest.approx(304)
    with pytest.raises(ConventionError, match="conditions"):
        StokesNumber(152.0, "st").to("st_star")
    with pytest.raises(ConventionError, match="unknown"):
        StokesNumber(152.0, "reynolds")


@pytest.mark.parametrize("name", laws.names("rebound"))
def test_no_law_takes_another_convention_silently(name):
    law = laws.get(name)
    with pytest.raises(ConventionError, match="bare number"):
        law(100.0, 0.97)
    own = StokesNumber.from_speed(0.585, GONDRET, law.convention, law.speed)
    given = StokesNumber.from_speed(0.585, GONDRET, "st_d", law.speed)
    assert law(given, 0.97, GONDRET) == pytest.approx(law(own, 0.97), rel=1e-12)
    slope = law.derivative(given, 0.97, GONDRET) * given.value
    assert slope == pytest.approx(law.derivative(own, 0.97) * own.value, rel=1e-12)
    if law.convention not in ("st", "st_d", "st_18"):
        with pytest.raises(ConventionError):
            law(given, 0.97)
    if law.speed is not Speed.UNSTATED:
        with pytest.raises(ConventionError, match="speed"):
            law(own.read_as("window"), 0.97)
        with pytest.raises(ConventionError, match="speed"):
            law(own.read_as("unstated"), 0.97)


def test_conditions_name_every_wrong_field(tmp_path):
    from restitution.conditions import read_conditions

    path = tmp_path / "c.toml"
    path.write_text(
        '[fluid]\ndensity = -1\nviscosity = "thin"\n[sphere]\ndiameter = 3e-3\ndensity = nan\ncolour = 1\n'
    )
    with pytest.raises(InputError) as caught:
        read_conditions(path)
    fields = {d.field for d in caught.value.defects}
    assert fields == {"fluid.density", "fluid.viscosity", "sphere.density", "sphere.colour"}
    assert all(d.file == str(path) for d in caught.value.defects)
