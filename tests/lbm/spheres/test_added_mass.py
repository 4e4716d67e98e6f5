"""The added mass of a touching sphere: the fit that runs use, against the lattice itself."""

import pytest

from lbm import InputError
from lbm.problems.impulsive_start import added_mass
from lbm.spheres import lattice_added_mass


def test_the_fit_is_what_the_lattice_gives():
    assert lattice_added_mass(8) == pytest.approx(added_mass(8), abs=0.03)


def test_it_grows_towards_potential_flow():
    values = [lattice_added_mass(n) for n in (8, 16, 32, 1e9)]
    assert values == sorted(values)
    # 3/2 zeta(3) - 1 with zeta(3) = 1.2020569 (Apery's constant)
    assert values[-1] == pytest.approx(1.5 * 1.2020569 - 1, abs=1e-5)


def test_a_diameter_that_is_none_is_refused():
    with pytest.raises(InputError, match="diameter"):
        lattice_added_mass(0.0)
