"""Every resistance law: sign, slope, check values, and its stated error against the exact references."""

from __future__ import annotations

import numpy as np
import pytest

import restitution.laws as laws
from restitution.errors import OutOfRangeWarning
from restitution.laws import REGISTRY, get
from restitution.laws.cut_off import CutOffLaw
from restitution.laws.pair import JeffreyOnishi1984Lubrication

NAMES = laws.names("resistance")
OTHERS = {"kappa": 0.7, "v_ratio": 1.0, "eta": 0.01}
"""Values of the variables besides eps."""

# Goldman, Cox & Brenner, Chem. Eng. Sci. 22, 637 (1967), exact: gap/radius; force and torque from translation,
# torque and force from rotation, in the scales of restitution.laws.resistance.
GOLDMAN = {
    9.0677: (1.0591, 8.77439e-06, 1.0003, 1.16992e-05),
    2.7622: (1.1738, 0.0004216, 1.0059, 0.000562134),
    1.3524: (1.3079, 0.0026423, 1.025, 0.00352307),
    0.5431: (1.5675, 0.0146489, 1.0998, 0.0195319),
    0.1276: (2.1514, 0.0737178, 1.3877, 0.0982904),
    0.0453: (2.6475, 0.14552, 1.6996, 0.194026),
    0.005: (3.7863, 0.34187, 2.5056, 0.455827),
    0.0032: (4.0223, 0.38494, 2.6793, 0.513254),
}
FORCE, COUPLING_TORQUE, TORQUE, COUPLING_FORCE = range(4)

# Two equal spheres: A. K. Townsend's table (series solution); gap/radius; X^A_11, -X^A_12, Y^A_11, -Y^A_12,
# -Y^B_11, Y^C_11.
TOWNSEND = {
    0.025: (11.8308730, 11.1842820, 1.61590039, 0.889093248, 0.702024331, 1.46432992),
    0.05: (6.67965088, 6.03161686, 1.50311680, 0.774182446, 0.543189570, 1.34305909),
    0.1: (4.03209762, 3.38119748, 1.39300628, 0.659875260, 0.394506440, 1.23302792),
    0.2: (2.64104859, 1.98449420, 1.28803765, 0.546750955, 0.261871657, 1.13980694),
    0.3: (2.14662002, 1.48451322, 1.23065676, 0.481539733, 0.194738541, 1.09559483),
    0.5: (1.72266708, 1.04975157, 1.16486469, 0.401078913, 0.124149048, 1.05273781),
    0.6: (1.60952987, 0.931353642, 1.14364637, 0.373018214, 0.103175348, 1.04106986),
}
XA11, XA12, YA11, YA12, YB11, YC11 = range(6)

# The same table for other size ratios: kappa, 2 gap/(r_1 + r_2), X^A_11 and -X^A_12 in units of 6 pi mu r_1.
UNEQUAL = [
    (0.1, 1e-5, 1503.96517, 1502.96871),
    (0.1, 1e-3, 16.2438433, 15.2473769),
    (0.1, 0.025, 1.73970049, 0.743612511),
    (0.1, 0.1, 1.26015449, 0.265292976),
    (0.01, 1e-5, 20.4372552, 19.4372724),
    (0.01, 0.025, 1.01801911, 0.0180316708),
    (0.01, 0.1, 1.01202881, 0.0120867530),
    (1.0, 0.025, 11.8308730, 11.1842820),
    (1.0, 0.1, 4.03209762, 3.38119748),
]


def gaps(law, count=60):
    """Gaps over the validity range, cut to where the law says something."""
    low, high = law.validity
    high = min(high, getattr(law, "eps_c", np.inf) * 0.999, 50.0)
    low = max(low, getattr(law, "eps_min", 0.0) * 1.001, 1e-5)
    return np.geomspace(low, high, count)


def others(law):
    return {v: OTHERS[v] for v in law.variables[1:]}


@pytest.mark.parametrize("name", NAMES)
def test_positive_and_decreasing_over_the_validity_range(name):
    """Holds for the couplings too, whose near forms end before they change sign."""
    law = get(name)
    value = law(gaps(law), **others(law))
    assert np.all(value > 0)
    assert np.all(np.diff(value) < 0)


@pytest.mark.parametrize("name", NAMES)
def test_derivative_is_that_of_the_value(name):
    law = get(name)
    eps = gaps(law, 9)[1:-1]
    h = 1e-4 * eps
    slope = (law(eps + h, **others(law)) - law(eps - h, **others(law))) / (2 * h)
    np.testing.assert_allclose(law.derivative(eps, **others(law)), slope, rtol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_check_values(name):
    checks = REGISTRY[name].checks
    assert checks, "a law needs a value from outside"
    for check in checks:
        law = get(name, **check.parameters)
        assert law(**check.inputs) == pytest.approx(check.value, abs=check.tolerance), check.source


@pytest.mark.parametrize("name", [n for n in NAMES if REGISTRY[n].formula is not None])
def test_formula_says_what_the_code_computes(name):
    law = get(name)
    expression = law.expression()
    for eps in (*gaps(law, 3), 1e-5, 0.7):
        given = {"eps": eps} | others(law) | law.parameters
        by_formula = expression.subs({s: given[s.name] for s in expression.free_symbols})
        assert law(eps, **others(law), out_of_range="ignore") == pytest.approx(float(by_formula), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "percent"),
    [
        ("taylor_1925", {0.01: -1.9, 0.1: -12.7, 0.4: -33.1}),
        ("cooley_oneill_1969", {0.01: -0.004, 0.1: -0.24, 0.4: -2.2, 1.0: -7.3}),
        ("jeffrey_1982", {0.01: -0.002, 0.1: -0.14, 0.4: -1.7}),
        ("bevan_prieve_2000", {0.01: -0.4, 0.06: -0.7, 0.4: -0.22, 1.0: -0.03}),
    ],
)
def test_error_against_the_exact_wall_resistance_is_as_stated(name, percent):
    exact, law = get("brenner_1961"), get(name)
    for eps, stated in percent.items():
        error = 100 * (law(eps, out_of_range="ignore") / exact(eps) - 1)
        digits = len(str(stated).partition(".")[2])
        assert error == pytest.approx(stated, abs=0.51 * 10.0**-digits)


@pytest.mark.parametrize(
    ("name", "log", "constant", "eps_log"),
    [
        ("taylor_1925", -1 / 5, 0.97128, -1 / 21),
        ("cooley_oneill_1969", 0, 0, -1 / 21),
        ("jeffrey_1982", 0, 0, 0),
    ],
)
def test_near_contact_the_exact_resistance_exceeds_each_expansion_by_the_next_terms(name, log, constant, eps_log):
    eps = np.geomspace(1e-5, 1e-2, 60)
    rest = get("brenner_1961")(eps) - get(name)(eps)
    terms = np.stack([np.log(eps), np.ones_like(eps), eps * np.log(eps), eps, eps**2 * np.log(eps)], axis=1)
    found = np.linalg.lstsq(terms, rest, rcond=None)[0]
    np.testing.assert_allclose(found[:3], [log, constant, eps_log], atol=3e-5)


def test_bevan_and_prieve_hold_at_every_gap():
    eps = np.geomspace(1e-6, 1e6, 2000)
    error = get("bevan_prieve_2000")(eps) / get("brenner_1961")(eps) - 1
    assert np.abs(error).max() < 0.0071
    assert error.argmin() == np.abs(error).argmax()


@pytest.mark.parametrize("name", ["taylor_1925", "cooley_oneill_1969", "jeffrey_1982"])
def test_validity_ends_where_the_error_reaches_five_percent(name):
    exact, law = get("brenner_1961"), get(name)
    eps = gaps(law, 400)
    assert np.abs(law(eps) / exact(eps) - 1).max() < 0.05
    beyond = law.validity[1] * 1.07
    assert abs(law(beyond, out_of_range="ignore") / exact(beyond) - 1) > 0.05
    with pytest.warns(OutOfRangeWarning):
        law(beyond)


@pytest.mark.parametrize(
    ("name", "column", "percent"),
    [
        ("goldman_1967_translation", FORCE, {0.005: -0.05, 0.0453: -1.4, 0.1276: -4.4}),
        ("goldman_1967_rotation", TORQUE, {0.005: -0.2, 0.0453: -4.7}),
        ("goldman_1967_coupling_torque", COUPLING_TORQUE, {0.0032: 0.0, 0.005: -0.45, 0.0453: -18}),
        ("goldman_1967_coupling_force", COUPLING_FORCE, {0.0032: 0.0, 0.005: -0.4, 0.0453: -18}),
        ("dance_maxey_2003_translation", FORCE, {0.0032: -0.1, 0.0453: -0.8, 0.1276: -2.6}),
        ("dance_maxey_2003_rotation", TORQUE, {0.005: -0.05, 0.0453: -1.0, 0.1276: -3.9}),
        ("dance_maxey_2003_coupling_force", COUPLING_FORCE, {0.005: -0.1, 0.0453: -3.2, 0.1276: -21}),
        ("chaoui_feuillebois_2003", FORCE, {0.0032: 0.01, 0.0453: 0.02, 0.1276: 0.03, 0.5431: 0.14, 1.3524: -0.3}),
        ("faxen_1922", FORCE, {9.0677: 0.0, 2.7622: 0.0, 1.3524: 0.1, 0.5431: 1.0, 0.1276: 4.4, 0.0453: 1.0}),
        ("goldman_1967_far_rotation", TORQUE, {9.0677: 0.0, 1.3524: -0.1, 0.5431: -1.3, 0.1276: -12}),
        ("goldman_1967_far_coupling_torque", COUPLING_TORQUE, {2.7622: -0.07, 1.3524: -2.6, 0.5431: -15}),
    ],
)
def test_error_against_the_exact_tangential_values_is_as_stated(name, column, percent):
    law = get(name)
    for eps, stated in percent.items():
        error = 100 * (law(eps, out_of_range="ignore") / GOLDMAN[eps][column] - 1)
        digits = len(str(stated).partition(".")[2])
        assert error == pytest.approx(stated, abs=0.51 * 10.0**-digits), eps


@pytest.mark.parametrize("name", [n for n in NAMES if REGISTRY[n].__module__.endswith("wall_tangential")])
def test_tangential_laws_keep_their_range_within_five_percent(name):
    law = get(name)
    column = {
        "force": FORCE,
        "coupling torque": COUPLING_TORQUE,
        "torque": TORQUE,
        "coupling force": COUPLING_FORCE,
    }[law.scale]
    low, high = law.validity
    inside = {eps: exact[column] for eps, exact in GOLDMAN.items() if low <= eps <= high}
    assert len(inside) >= 2
    for eps, exact in inside.items():
        assert law(eps) == pytest.approx(exact, rel=0.05)


def test_couplings_are_reciprocal():
    """F_rot = 4/3 T_trans, exactly for the asymptotes' logarithm and for the exact values."""
    force, torque = get("goldman_1967_coupling_force"), get("goldman_1967_coupling_torque")
    assert force.derivative(0.01) == pytest.approx(4 / 3 * torque.derivative(0.01), rel=1e-12)
    assert force(0.005) == pytest.approx(4 / 3 * torque(0.005), rel=1e-3)
    for exact in GOLDMAN.values():
        assert exact[COUPLING_FORCE] == pytest.approx(4 / 3 * exact[COUPLING_TORQUE], rel=1e-4)


@pytest.mark.parametrize(
    ("name", "column", "factor", "percent"),
    [
        ("taylor_1925_pair", XA11, 1, {0.025: -15, 0.1: -38}),
        ("jeffrey_onishi_1984_normal_self", XA11, 1, {0.025: -0.03, 0.1: -0.3, 0.3: -1.7, 0.6: -4.6}),
        ("jeffrey_onishi_1984_normal_cross", XA12, 1, {0.025: -0.01, 0.1: -0.2, 0.3: -1.4, 0.6: -4.4}),
        ("jeffrey_onishi_1984_tangential_self", YA11, 1, {0.05: -0.4, 0.1: -0.8, 0.3: -2.6, 0.5: -4.4}),
        ("jeffrey_onishi_1984_tangential_cross", YA12, 1, {0.05: -0.2, 0.1: -0.4, 0.3: -1.5, 0.6: -3.8}),
        ("jeffrey_onishi_1984_coupling_force", YB11, 2 / 3, {0.025: -1.0, 0.05: -2.7, 0.1: -7}),
        ("jeffrey_onishi_1984_rotation", YC11, 1, {0.05: -1.0, 0.1: -2.1, 0.2: -4.8, 0.3: -7.7}),
    ],
)
def test_error_against_the_exact_pair_functions_is_as_stated(name, column, factor, percent):
    law = get(name)
    equal = {"kappa": 1.0} if "kappa" in law.variables else {}
    for eps, stated in percent.items():
        error = 100 * (law(eps, **equal, out_of_range="ignore") / (factor * TOWNSEND[eps][column]) - 1)
        digits = len(str(stated).partition(".")[2])
        assert error == pytest.approx(stated, abs=0.51 * 10.0**-digits), eps


@pytest.mark.parametrize(("kappa", "xi", "self_", "cross"), UNEQUAL)
def test_size_ratios_leave_out_only_a_constant(kappa, xi, self_, cross):
    constant_self, constant_cross = {1.0: (0.9954, 0.3502), 0.1: (1.0244, 0.0279), 0.01: (1.0001, 0.0001)}[kappa]
    diverging = get("jeffrey_onishi_1984_lubrication")(xi * (1 + kappa) / 2, kappa, out_of_range="ignore")
    assert self_ - diverging == pytest.approx(constant_self, abs=0.013)
    assert cross - diverging == pytest.approx(constant_cross, abs=0.013)


def test_size_ratios_above_one_follow_by_reciprocity():
    """What 2 does to 1 is what 1 does to 2; the scales differ, so a constant (and eps ln kappa) may be left."""
    law, eps = get("jeffrey_onishi_1984_lubrication"), np.geomspace(1e-5, 1e-3, 9)
    assert np.ptp(law(eps, 10.0)) > 8e4
    assert np.ptp(law(eps, 10.0) - 10 * law(eps / 10, 0.1)) < 2e-4


def test_equal_spheres_are_the_size_ratio_one():
    eps = np.geomspace(1e-5, 0.1, 20)
    equal = get("jeffrey_onishi_1984_normal_self")(eps) - 0.9954
    np.testing.assert_allclose(get("jeffrey_onishi_1984_lubrication")(eps, 1.0), equal, rtol=1e-12)


def test_a_very_large_partner_is_a_wall():
    eps = np.geomspace(1e-4, 0.1, 20)
    wall = get("jeffrey_1982")(eps) - 0.9713
    np.testing.assert_allclose(JeffreyOnishi1984Lubrication()(eps, 1e9), wall, rtol=1e-8)
    np.testing.assert_allclose(get("taylor_1925_pair")(eps[:5], 1e9), 1 / eps[:5], rtol=1e-8)


@pytest.mark.parametrize("name", NAMES)
def test_every_law_says_what_it_is_for(name):
    law = REGISTRY[name]
    assert law.motion
    assert law.scale in ("force", "torque", "coupling force", "coupling torque")
    if issubclass(law, CutOffLaw):
        assert (law.scale, law.motion) == (law.full.scale, law.full.motion)
