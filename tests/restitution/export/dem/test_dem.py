"""What the texts for DEM codes say that they deliver, against runs of the programs on record; see also drops."""

import re

import numpy as np
import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.export import Request, law_closure
from restitution.export.dashpot import typed
from restitution.export.dem import lammps, liggghts, yade
from restitution.export.dem.constant import best_constant, constant_at
from restitution.export.dem.viscous_contact import delivered
from restitution.export.dem.yade import SHARE_AT_A_WALL, law_of_yade
from restitution.export.impacts import impacts_of

PAIR = {
    "fluid": {"density": 935.0, "viscosity": 0.01},
    "sphere": {"diameter": 0.003, "density": 7800.0, "e_dry": 0.97},
}
RANGE = (20.0, 1000.0)


@pytest.fixture(scope="module")
def steel():
    """Eq. (4), first reading: 0.97 exp(-35.46/St), for the 3 mm steel sphere of Gondret et al. in silicone oil."""
    return impacts_of(law_closure(laws.get("eq4_exponential")), Conditions.model_validate(PAIR), None, "test")


@pytest.fixture(scope="module")
def viscous(steel):
    """The text for LIGGGHTS' viscous contact, and the deviation that it states."""
    text = liggghts(steel, Request(1, None, 0.02, RANGE))
    return text, float(re.search(r"within ([\d.]+) of the law", text)[1])


def law(St):
    return 0.97 * np.exp(-18 * 1.97 / np.asarray(St))


@pytest.mark.parametrize(
    ("inputs", "cut", "runs"),
    [
        ((35.0, 0.97), False, {20: 0.000, 50: 0.082, 100: 0.552, 152: 0.707, 500: 0.911}),
        ((35.0, 0.97), True, {20: 0.182, 50: 0.330, 100: 0.590, 152: 0.720, 500: 0.912}),
        ((24.7, 0.919), True, {20: 0.212, 50: 0.453, 80: 0.630, 200: 0.845, 1000: 0.921}),
    ],
)
def test_viscous_contact_of_liggghts_as_it_was_run(inputs, cut, runs):
    """LIGGGHTS 3.8.0 of Debian, one sphere on a wall, `viscous on`, without and with `limitForce on`."""
    np.testing.assert_allclose(
        delivered(np.array(list(runs), float), *inputs, cut), list(runs.values()), atol=1e-3
    )


def test_constant_holds_where_it_says(steel):
    constant = constant_at(steel, 0.3, 0.02)
    assert constant.e == pytest.approx(law(0.3 * 7800 * 0.003 / 0.09), rel=1e-12)
    np.testing.assert_allclose(law(constant.stokes) - constant.e, [-0.02, 0.02], rtol=1e-6)
    best = best_constant(steel, 100, 300)
    assert best.within == pytest.approx((law(300) - law(100)) / 2, rel=1e-9)


def test_liggghts_level_1_says_what_it_delivers(viscous):
    text, stated = viscous
    assert stated < 0.05  # Legendre's constants typed in: 0.4
    critical, most = (
        float(re.search(rf"{k} peratomtypepair 1 (\S+)", text)[1])
        for k in ("CriticalStokes", "MaximumRestitution")
    )
    St = np.geomspace(*RANGE, 60)
    assert np.abs(delivered(St, critical, most) - law(St)).max() <= stated + 0.003


def test_codes_that_cut_the_tension_get_the_inverse(steel):
    """Schwager & Poeschel's formula as they print it, applied to what is typed, gives what is asked."""

    def cut(e):
        z = -np.log(e) / np.hypot(np.pi, np.log(e))
        s = np.sqrt(1 - z**2)
        return np.exp(-z / s * (np.pi - np.arctan(2 * z * s / (1 - 2 * z**2))))

    two = Conditions.model_validate(PAIR | {"partner": {"diameter": 0.003, "density": 7800.0}})
    pair = impacts_of(law_closure(laws.get("eq4_exponential")), two, None, "test")
    text = yade(pair, Request(0, 0.15, 0.02, RANGE))  # St of a pair is twice that at a wall
    assert cut(float(re.search(r"en=([\d.]+)", text)[1])) == pytest.approx(law(78.0), rel=1e-7)
    text = lammps(steel, Request(1, None, 0.02, (100.0, 300.0)))
    assert cut(float(re.search(r"hooke \S+ (\S+)", text)[1])) == pytest.approx((law(100) + law(300)) / 2, rel=1e-7)


def test_walls_of_yade_as_they_were_run(steel):
    """YADE 2023.02a, tc, en = 0.7 typed: 0.7876 at a wall, facet and fixed sphere, 0.7180 of two spheres."""
    assert typed(0.7876, SHARE_AT_A_WALL) == pytest.approx(0.7, abs=5e-4)
    assert typed(0.7180) == pytest.approx(0.7, abs=5e-4)
    # Its lubrication law at a wall, one sphere of 3 mm: what it means, and what it was measured to deliver.
    meant, measured = [0.4213, 0.6140, 0.7242, 0.7873, 0.8233], [0.5281, 0.7010, 0.7938, 0.8427, 0.8706]
    for e, run in zip(meant, measured, strict=True):
        assert law_of_yade(np.inf, e, 0.0, SHARE_AT_A_WALL) == pytest.approx(run, abs=0.003)


def test_walls_and_pairs_get_each_their_own_constant(steel):
    """By hand: of two of the spheres St is twice that at a wall, at the same relative speed."""
    at_wall, request = 0.3 * 7800 * 0.003 / 0.09, Request(0, 0.3, 0.02, RANGE)
    text = lammps(steel, request)
    typed_in = {
        k: float(re.search(rf"^{k} .*hooke \S+ (\S+)", text, re.MULTILINE)[1]) for k in ("pair_coeff", "fix")
    }
    assert typed_in == pytest.approx({"pair_coeff": law(2 * at_wall), "fix": law(at_wall)}, rel=1e-8)
    said = " ".join(liggghts(steel, request).replace("#", " ").split())
    assert float(re.search(r"gives two of them ([\d.]+)", said)[1]) == pytest.approx(law(2 * at_wall), rel=1e-5)
    two = Conditions.model_validate(PAIR | {"partner": {"diameter": 0.003, "density": 7800.0}})
    pair = impacts_of(law_closure(laws.get("eq4_exponential")), two, None, "test")
    assert not any("wall/gran" in text for text in (lammps(pair, request), liggghts(pair, request)))


def test_what_cannot_be_is_refused(steel):
    conditions = Conditions.model_validate(PAIR)
    with pytest.raises(InputError, match="twice"):
        impacts_of(law_closure(laws.get("taylor_1925")), conditions, None, "lammps")
    with pytest.raises(InputError, match=r"0\.05 < e"):
        liggghts(steel, Request(0, 10 / steel.per_speed, 0.02, RANGE))
    with pytest.raises(InputError, match=r"0\.208"):
        yade(steel, Request(0, 15 / steel.per_speed, 0.02, RANGE))
    with pytest.raises(InputError, match="--speed"):
        lammps(steel, Request(0, None, 0.02, RANGE))
    linear = impacts_of(law_closure(laws.get("eq4_linear")), conditions, None, "lammps")
    with pytest.raises(InputError, match="no rebound"):
        lammps(linear, Request(0, 20 / steel.per_speed, 0.02, RANGE))
