"""What DEM codes deliver: by runs of the programs on record, and by running them where they are installed."""

import re
import shutil
import subprocess

import numpy as np
import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.export import Request, law_closure
from restitution.export.dem import lammps, lammps_drop_test, liggghts, yade
from restitution.export.dem.constant import best_constant, constant_at
from restitution.export.dem.viscous_contact import delivered
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


def dropped_in_liggghts(text: str, v: float, folder) -> float:
    """The e that LIGGGHTS delivers with an exported text."""
    commands = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    (folder / "in.drop").write_text(
        "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off\n"
        "communicate single vel yes\nregion box block 0 0.02 0 0.02 0 0.02 units box\ncreate_box 1 box\n"
        "neighbor 0.001 bin\nneigh_modify delay 0\nfix Y all property/global youngsModulus peratomtype 5e7\n"
        f"fix nu all property/global poissonsRatio peratomtype 0.3\n{commands}\n"
        f"create_atoms 1 single 0.01 0.01 {0.0015 + v * 2e-6:.9g} units box\n"
        "set group all diameter 0.003 density 7800\n"
        f"velocity all set 0 0 {-v} units box\nfix move all nve/sphere\ntimestep 1e-7\n"
        f'variable e equal vz[1]/{v}\nrun 6000\nprint "delivered ${{e}}"\n'
    )
    done = subprocess.run(["liggghts", "-in", "in.drop"], cwd=folder, capture_output=True, text=True, check=False)
    return float(re.findall(r"delivered ([\d.e-]+)", done.stdout)[-1])


@pytest.mark.parametrize("St", [20.0, 50.0, 120.0, 300.0, 1000.0])
def test_liggghts_delivers_what_is_said(steel, viscous, St, tmp_path):
    if shutil.which("liggghts") is None:
        pytest.skip("liggghts is not installed: what it delivers was not measured")
    v = St / steel.per_speed
    text, stated = viscous
    assert abs(dropped_in_liggghts(text, v, tmp_path) - law(St)) <= stated + 0.003
    constant = liggghts(steel, Request(0, v, 0.02, RANGE))
    assert dropped_in_liggghts(constant, v, tmp_path) == pytest.approx(law(St), abs=0.002)


@pytest.mark.parametrize(
    "request_", [Request(0, 0.3, 0.02, (50.0, 200.0)), Request(1, None, 0.02, (100.0, 300.0))]
)
def test_lammps_delivers_what_is_said(steel, request_, tmp_path):
    program = shutil.which("lmp")
    if program is None:
        pytest.skip("lmp is not installed: what LAMMPS delivers was not measured")
    if subprocess.run([program, "-h"], capture_output=True, check=False).returncode:
        pytest.skip("lmp does not start here (the one of PyPI needs LD_PRELOAD=libmpi.so.12)")
    speeds = np.geomspace(0.2, 1.0, 4)
    (tmp_path / "in.drop").write_text(lammps_drop_test(steel, request_, speeds))
    command = [program, "-in", "in.drop", "-log", "none"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    asked = law(0.3 * steel.per_speed) if request_.level == 0 else (law(100) + law(300)) / 2
    given = [float(x) for x in re.findall(r"delivered (\S+)", done.stdout) if x[0].isdigit()]
    assert len(given) == 4, done.stdout + done.stderr
    np.testing.assert_allclose(given, asked, atol=0.002)


def test_codes_that_cut_the_tension_get_the_inverse(steel):
    """Schwager & Poeschel's formula as they print it, applied to what is typed, gives what is asked."""

    def cut(e):
        z = -np.log(e) / np.hypot(np.pi, np.log(e))
        s = np.sqrt(1 - z**2)
        return np.exp(-z / s * (np.pi - np.arctan(2 * z * s / (1 - 2 * z**2))))

    text = yade(steel, Request(0, 0.3, 0.02, RANGE))
    assert cut(float(re.search(r"en=([\d.]+)", text)[1])) == pytest.approx(law(78.0), rel=1e-7)
    text = lammps(steel, Request(1, None, 0.02, (100.0, 300.0)))
    assert cut(float(re.search(r"hooke \S+ (\S+)", text)[1])) == pytest.approx((law(100) + law(300)) / 2, rel=1e-7)


def test_yade_level_1_states_its_deviation(steel):
    text = yade(steel, Request(1, None, 0.02, (100.0, 1000.0)))
    en, roughness = (float(re.search(rf"{key}=([\d.e+-]+)", text)[1]) for key in ("en", "roughnessScale"))
    St = np.geomspace(100, 1000, 50)
    e = en * (1 + np.log(2 * roughness / 0.003) / (9 * St))
    stated = float(re.search(r"within ([\d.]+) of ours", text)[1])
    assert np.abs(e - law(St)).max() == pytest.approx(stated, abs=1e-3)


def test_what_cannot_be_is_refused(steel):
    conditions = Conditions.model_validate(PAIR)
    with pytest.raises(InputError, match="twice"):
        impacts_of(law_closure(laws.get("taylor_1925")), conditions, None, "lammps")
    with pytest.raises(InputError, match=r"0\.05 < e"):
        liggghts(steel, Request(0, 10 / steel.per_speed, 0.02, RANGE))
    with pytest.raises(InputError, match=r"0\.135"):
        yade(steel, Request(0, 15 / steel.per_speed, 0.02, RANGE))
    with pytest.raises(InputError, match="--speed"):
        lammps(steel, Request(0, None, 0.02, RANGE))
    linear = impacts_of(law_closure(laws.get("eq4_linear")), conditions, None, "lammps")
    with pytest.raises(InputError, match="no rebound"):
        lammps(linear, Request(0, 20 / steel.per_speed, 0.02, RANGE))
