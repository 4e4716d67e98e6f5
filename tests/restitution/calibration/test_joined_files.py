"""Files of several laboratories, each with a Stokes number of its own, become one set of impacts."""

import numpy as np
import pytest

from restitution.calibration import read
from restitution.errors import InputError

HEAD = "stokes,stokes_sigma,stokes_convention,e_eff,e_dry,speed_definition"


def write(folder, name, convention, *rows, more="", cells=""):
    lines = [HEAD + more, *(f"{st},{st / 50},{convention},{e},0.97,far{cells}" for st, e in rows)]
    (folder / name).write_text("\n".join(lines) + "\n")
    return folder / name


def test_stokes_numbers_of_two_definitions_are_converted_to_the_first(tmp_path):
    a = write(tmp_path, "a.csv", "st", (20, 0.4), (100, 0.8))
    b = write(tmp_path, "b.csv", "st_d", (360, 0.6), (1800, 0.85))
    impacts = read([a, b])
    np.testing.assert_allclose(impacts.St, [20, 100, 40, 200])
    np.testing.assert_allclose(impacts.St_sigma, np.array([20, 100, 40, 200]) / 50)
    np.testing.assert_allclose(read([b, a]).St, [360, 1800, 180, 900])


def test_added_mass_needs_fluid_and_sphere(tmp_path):
    a, b = write(tmp_path, "a.csv", "st", (20, 0.4)), write(tmp_path, "b.csv", "st_star", (60, 0.6))
    with pytest.raises(InputError, match="--conditions"):
        read([a, b])
    names = ",fluid_density_kg_m3,fluid_viscosity_Pa_s,sphere_diameter_m,sphere_density_kg_m3"
    b = write(tmp_path, "b.csv", "st_star", (60, 0.6), more=names, cells=",1000,0.01,0.003,2500")
    np.testing.assert_allclose(read([a, b]).St, [20, 60 * 2500 / 3000])  # rho_p/(rho_p + rho_f/2)
