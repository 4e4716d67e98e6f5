"""The film's resistance to sliding and turning, and oblique impacts."""

import math

import numpy as np
import pandas as pd
import pytest

from restitution import cases
from restitution.cases import FilmModel
from restitution.cli import main
from restitution.runs.closures import tangential_force
from restitution.runs.record import read_record
from restitution.runs.simulate import simulate

# Goldman, Cox & Brenner 1967, exact, at gap/r = 0.0032 and 0.0453: force by translation, torque by translation,
# torque by rotation, force by rotation, in the units of restitution.laws.resistance
NEAR, EDGE = (4.0223, 0.38494, 2.6793, 0.51326), (2.6475, 0.14552, 1.6996, 0.194026)
R, MU, GAP = 10.0, 0.1, 0.032
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def along():
    """The film of a sphere of 10 cells' radius below the gap 0.0453 r."""
    return tangential_force(FilmModel(tangential=True, cut_off_cells=0.453), r=R, mu=MU)


def test_sliding_and_turning_against_the_exact_values(along):
    by_sliding, torque, by_turning, push = (near - edge for near, edge in zip(NEAR, EDGE, strict=True))
    force, turn = along(GAP, np.array([1.0, 0, 0]), np.zeros(3), UP)
    assert force[0] / (-6 * math.pi * MU * R) == pytest.approx(by_sliding, rel=0.02)
    assert turn[1] / (8 * math.pi * MU * R**2) == pytest.approx(torque, rel=0.02)  # as if it rolled
    force, turn = along(GAP, np.zeros(3), np.array([0, 1.0, 0]), UP)
    assert turn[1] / (-8 * math.pi * MU * R**3) == pytest.approx(by_turning, rel=0.02)
    assert force[0] / (6 * math.pi * MU * R**2) == pytest.approx(push, rel=0.02)


def test_it_is_reciprocal_dissipates_and_knows_no_direction(along):
    axes = np.eye(3)
    for normal in (UP, -UP, axes[0]):
        motions = [(u, np.zeros(3)) for u in axes if not u @ normal] + [
            (np.zeros(3), w) for w in axes if not w @ normal
        ]
        loads = [np.concatenate(along(GAP, u, w, normal)) for u, w in motions]
        matrix = np.array([[-np.concatenate(motion) @ load for motion in motions] for load in loads])
        assert np.allclose(matrix, matrix.T)
        assert np.linalg.eigvalsh(matrix).min() > 0


OBLIQUE = """
base = "gondret_st152_10"
[release]
kind = "drive"
gap_d = 1.0
speed = 0.3
ramp = 0.0005
along = {along}
[numerics]
cells_per_diameter = 8
lattice_speed = 0.1
width_d = 2.5
height_d = 4.5
[film]
tangential = {film}
[run]
after_contact = 0.003
"""


@pytest.fixture(scope="module")
def oblique(tmp_path_factory):
    """Motion of an oblique impact without and with the film along the wall."""
    motions = []
    for film in ("false", "true"):
        folder = tmp_path_factory.mktemp("oblique")
        (folder / "case.toml").write_text(OBLIQUE.format(along=0.2, film=film))
        simulate(cases.read_case(folder / "case.toml"), folder / "out")
        motions.append(pd.read_csv(folder / "out" / "motion.csv"))
    return motions


def test_an_oblique_release_reaches_its_speed_along_the_wall(oblique):
    motion = oblique[0]
    driven = motion[: int(np.argmax(motion.gap_m < 0.0015))]
    since = (driven.index + 1) * (motion.time_s[1] - motion.time_s[0])
    assert np.allclose(driven.vx_m_s, -0.2 * np.expm1(-since / 0.0005), rtol=1e-3)
    assert np.abs(motion.vy_m_s).max() < 0.01 * 0.2


def test_the_film_turns_a_sliding_sphere_as_if_it_rolled(oblique):
    """Where the gap is thinnest, the spin gains in the sense of rolling what it does not without the film."""
    without, within = (motion.spin_y_1_s[motion.time_s.abs() < 0.0005] for motion in oblique)
    assert np.ptp(within) > np.ptp(without)
    assert within.iloc[-1] > without.iloc[-1]


def test_a_side_wall_that_is_met_is_no_contact_of_the_fall(tmp_path):
    """The clock begins at the floor, where the gap is that of the film's roughness, and the side is told."""
    text = OBLIQUE.format(along=0.4, film="false").replace("[film]", 'sides = "no-slip"\n[film]')
    (tmp_path / "case.toml").write_text(text)
    simulate(cases.read_case(tmp_path / "case.toml"), tmp_path / "out")
    run, motion = read_record(tmp_path / "out"), pd.read_csv(tmp_path / "out" / "motion.csv")
    first = motion[motion.time_s >= 0].iloc[0]
    assert first.gap_m < 0.02 * 0.003
    assert motion.vx_m_s[motion.time_s < 0].min() < 0, "it came back from the side before"
    assert run.contacts[0].time_s == 0
    assert any("x+" in note for note in run.notes)


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('[release]\nkind = "rest"\ngap_d = 1.0\nalong = 0.1\n[numerics]\nreference_speed = 0.5', "release.along"),
        ('[film]\nform = "nguyen_ladd_2002"\ntangential = true\ncut_off_cells = 1.0', "film.tangential"),
    ],
)
def test_what_the_model_cannot_do_is_refused(tmp_path, capsys, text, field):
    (tmp_path / "case.toml").write_text(f'base = "gondret_st152_10"\n{text}\n')
    assert main(["simulate", str(tmp_path / "case.toml"), "--out", str(tmp_path / "out")]) == 2
    assert field in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_point_particle_refuses_an_oblique_release(tmp_path, capsys):
    (tmp_path / "case.toml").write_text('base = "gondret_st152_10"\n[release]\nalong = 0.1\n')
    assert main(["bounce", str(tmp_path / "case.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "release.along" in capsys.readouterr().err
