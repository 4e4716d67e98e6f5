import numpy as np
import pytest

from lbm import FlowScales, InputError, OutsideRangeWarning, Scales
from lbm.scales import DIMENSIONS

GONDRET = {
    "length_m": 3e-3, "speed_m_s": 0.585, "viscosity_m2_s": 1e-5 / 0.935, "density_kg_m3": 935.0, "cells": 10,
}  # fmt: skip


def test_physical_numbers_survive_the_change_of_units():
    flow = FlowScales.from_conditions(**GONDRET, lattice_speed=0.05)
    assert flow.reynolds == pytest.approx(0.585 * 3e-3 / (1e-5 / 0.935))
    assert flow.scales.si(flow.speed, "velocity") == pytest.approx(0.585)
    assert flow.scales.si(flow.length, "length") == pytest.approx(3e-3)
    assert flow.scales.si(1.0, "density") == pytest.approx(935.0)
    assert flow.mach == pytest.approx(0.05 * 3**0.5)
    assert flow.relaxation_time == pytest.approx(0.5 + 3 * flow.viscosity)


@pytest.mark.parametrize("quantity", DIMENSIONS)
def test_there_and_back(quantity):
    scales = Scales(2e-4, 3e-6, 950.0)
    assert scales.lattice(scales.si(1.7, quantity), quantity) == pytest.approx(1.7)


def test_derived_units_are_products_of_others():
    s = Scales(2e-4, 3e-6, 950.0)
    assert s.unit("force") == pytest.approx(s.unit("mass") * s.unit("acceleration"))
    assert s.unit("pressure") == pytest.approx(s.unit("density") * s.unit("velocity") ** 2)
    assert s.unit("torque") == pytest.approx(s.unit("force") * s.unit("length"))
    assert s.unit("dynamic viscosity") == pytest.approx(s.unit("kinematic viscosity") * s.unit("density"))


@pytest.mark.parametrize(
    ("change", "knob"),
    [
        ({"lattice_speed": 0.2}, "lattice_speed"),
        ({"viscosity_m2_s": 1e-6}, "cells"),
        ({"cells": 2000}, "fewer cells"),
    ],
)
def test_warns_with_the_knob_to_turn(change, knob):
    with pytest.warns(OutsideRangeWarning, match=knob):
        FlowScales.from_conditions(**{**GONDRET, "lattice_speed": 0.05, **change})


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"lattice_speed": 0.4}, "lattice_speed"),
        ({"viscosity_m2_s": 1e-9}, "cells"),
        ({"viscosity_m2_s": 0.0}, "viscosity_m2_s"),
        ({"viscosity_m2_s": -1.0}, "viscosity_m2_s"),
        ({"cells": np.nan}, "cells"),
        ({"length_m": np.inf}, "length_m"),
    ],
)
def test_refuses_what_cannot_run(change, named):
    with pytest.raises(InputError, match=named):
        FlowScales.from_conditions(**{**GONDRET, "lattice_speed": 0.05, **change})


def test_unknown_quantity():
    with pytest.raises(InputError, match="charge"):
        Scales(1e-3, 1e-3).unit("charge")


def test_lists_are_taken_and_other_things_refused():
    scales = Scales(2e-4, 4e-6)
    assert scales.si([1, 2], "velocity") == pytest.approx([50, 100])
    assert scales.lattice((50, 100), "velocity") == pytest.approx([1, 2])
    for refused in (
        lambda: scales.si("a", "velocity"),
        lambda: scales.si(1, ["velocity"]),
        lambda: Scales("a", 1, 1),
        lambda: FlowScales.from_conditions(**{**GONDRET, "length_m": "1"}),
    ):
        with pytest.raises(InputError):
            refused()
