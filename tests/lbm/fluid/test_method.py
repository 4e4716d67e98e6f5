import numpy as np
import pytest
from numba import njit

from lbm import InputError, Rates
from lbm.fluid import moments, stencil
from lbm.fluid.collision import collide
from tests.lbm.reference import collide as dense_collide

PRESETS = {
    "two-relaxation-times": Rates.two_relaxation_times(0.02),
    "dhumieres2002": Rates.dhumieres2002(0.02),
    "bgk": Rates.bgk(0.02),
    "bulk": Rates.bulk(0.02, 0.1),
    "all different": Rates(nu=1.7, e=1.1, eps=1.3, q=1.2, pi=1.5, m=1.9),
}
FORCES = {"no force": None, "force": (1e-3, -2e-3, 3e-3)}


@njit
def _collide(f, rates, force):
    return collide(f, rates, force)


def _random_cell(seed=0, dtype=float):
    return (0.02 * np.random.default_rng(seed).standard_normal(stencil.Q)).astype(dtype)


def test_stencil_is_isotropic_to_fourth_order():
    c, w = stencil.C.astype(float), stencil.W
    delta = np.eye(3)
    assert np.isclose(w.sum(), 1)
    assert np.allclose(np.einsum("k,ka,kb->ab", w, c, c), delta / 3)
    fourth = np.einsum("k,ka,kb,kc,kd->abcd", w, c, c, c, c)
    pairs = np.einsum("ab,cd->abcd", delta, delta)
    assert np.allclose(fourth, (pairs + pairs.transpose(0, 2, 1, 3) + pairs.transpose(0, 3, 2, 1)) / 9)
    assert (stencil.C[stencil.OPPOSITE] == -stencil.C).all()


def test_moments_are_orthogonal_with_the_published_norms():
    assert np.allclose(moments.M @ moments.M.T, np.diag(moments.NORMS))
    norms = dict(zip(moments.NAMES, moments.NORMS, strict=True))
    # squared norms follow by hand from the polynomials' values on the shells |c|^2 = 0, 1, 2
    assert norms["e"] == 30**2 + 6 * 11**2 + 12 * 8**2
    assert norms["eps"] == 12**2 + 6 * 4**2 + 12
    assert norms["q_x"] == 2 * 4**2 + 8


@pytest.mark.parametrize("force", FORCES.values(), ids=FORCES)
@pytest.mark.parametrize("rates", PRESETS.values(), ids=PRESETS)
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-16), (np.float32, 2e-8)])
def test_unrolled_collision_is_the_dense_one(rates, force, dtype, tolerance):
    f = _random_cell(dtype=dtype)
    typed = None if force is None else tuple(dtype(v) for v in force)
    after = np.array(_collide(tuple(f), rates.scaled(dtype), typed))
    assert (after == after.astype(dtype)).all()  # computed in that precision throughout
    expected = dense_collide(f.astype(float), rates, force or (0, 0, 0))
    assert np.abs(after - expected).max() < tolerance


@pytest.mark.parametrize("force", FORCES.values(), ids=FORCES)
@pytest.mark.parametrize("rates", PRESETS.values(), ids=PRESETS)
def test_collision_conserves_mass_and_adds_the_force_to_momentum(rates, force):
    f = _random_cell(1)
    after = np.array(_collide(tuple(f), rates.scaled(np.float64), force))
    assert abs((after - f).sum()) < 1e-15
    assert np.abs(stencil.C.T @ (after - f) - np.array(force or (0, 0, 0))).max() < 1e-15


@pytest.mark.parametrize("rates", PRESETS.values(), ids=PRESETS)
def test_equilibrium_is_left_alone(rates):
    f = moments.equilibrium(np.array(1.03), np.array([0.05, -0.02, 0.08]))
    assert np.abs(np.array(_collide(tuple(f), rates.scaled(np.float64), None)) - f).max() < 1e-16


def test_presets_follow_their_sources():
    nu = 0.013
    standard = Rates.dhumieres2002(nu)
    assert (standard.e, standard.eps, standard.q, standard.pi, standard.m) == (1.19, 1.4, 1.2, 1.4, 1.98)
    trt = Rates.two_relaxation_times(nu)
    assert np.isclose((1 / trt.nu - 0.5) * (1 / trt.q - 0.5), 3 / 16)
    bulk = Rates.bulk(nu, 0.07)
    assert np.isclose(bulk.bulk_viscosity, 0.07)
    assert all(np.isclose(r.viscosity, nu) for r in (standard, trt, bulk, Rates.bgk(nu)))


@pytest.mark.parametrize("nu", [0.0, -0.1, np.nan, np.inf])
@pytest.mark.parametrize("preset", [Rates.dhumieres2002, Rates.two_relaxation_times, Rates.bgk])
def test_viscosity_must_be_positive(preset, nu):
    with pytest.raises(InputError, match="viscosity"):
        preset(nu)


@pytest.mark.parametrize("wrong", ["0.1", None, [0.1], True])
def test_rates_are_made_of_numbers(wrong):
    for preset in (Rates.dhumieres2002, Rates.two_relaxation_times, Rates.bgk):
        with pytest.raises(InputError, match=r"viscosity .*must be a number"):
            preset(wrong)
    with pytest.raises(InputError, match="bulk viscosity"):
        Rates.bulk(0.1, wrong)
    with pytest.raises(InputError, match="magic"):
        Rates.two_relaxation_times(0.1, wrong)
    with pytest.raises(InputError, match="s_e"):
        Rates(nu=1, e=wrong, eps=1, q=1, pi=1, m=1)


def test_relaxation_time_of_a_half_is_refused():
    with pytest.raises(InputError, match=r"s_nu = 2.*raise the viscosity"):
        Rates(nu=2.0, e=1, eps=1, q=1, pi=1, m=1)
