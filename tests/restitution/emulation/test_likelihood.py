"""What a solver lacks is told as great as it is: records made with a discrepancy of known size."""

from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from restitution.calibration.reading.reading import Reading
from restitution.emulation.emulated import emulated
from restitution.emulation.runs_table import read_runs

from .parabolas import CONDITIONS, design, gap, write_runs

TRUTH = (0.78, 0.6)
SIGMA_U, TAU, NOISE = 1e-4, 5e-3, 1e-5
"""In m, s, m: of the Ornstein-Uhlenbeck process that is added, and of a reading."""
RECORDS = 60


def lacking(time_s, rng):
    """The process at given times, by its exact recursion (Gillespie, Phys. Rev. E 54 (1996) 2084)."""
    u = np.empty(len(time_s))
    u[0] = SIGMA_U * rng.standard_normal()
    for i, dt in enumerate(np.diff(time_s), 1):
        kept = np.exp(-dt / TAU)
        u[i] = kept * u[i - 1] + SIGMA_U * np.sqrt(1 - kept**2) * rng.standard_normal()
    return u


def test_a_known_discrepancy_is_within_its_intervals_as_often_as_they_say(tmp_path):
    group = read_runs(write_runs(tmp_path, design(14), TRUTH))[0]
    frames = emulated(group, group.records[0], Reading(conditions=CONDITIONS)).frames
    time, rng = frames.recording.time_s, np.random.default_rng(5)
    sizes, times = np.meshgrid(SIGMA_U * np.geomspace(0.4, 2.5, 31), TAU * np.geomspace(0.1, 10, 9))
    sizes, times = np.r_[SIGMA_U, sizes.ravel()], np.r_[TAU, times.ravel()]
    theta, touch = np.tile(TRUTH, (len(sizes), 1)), np.zeros(len(sizes))
    ratios, best = [], []
    for _ in range(RECORDS):
        seen = gap(*TRUTH, time) + lacking(time, rng) + NOISE * rng.standard_normal(len(time))
        one = replace(frames, recording=replace(frames.recording, gap_m=seen))
        log = one.log(theta, touch, sizes, times)
        ratios.append(2 * (log.max() - log[0]))
        best.append(np.log(sizes[np.argmax(log)] / SIGMA_U))
    # Wilks: chi squared of two degrees of freedom; each count within three standard deviations of a binomial one.
    for level in (0.68, 0.95):
        within = np.sum(np.array(ratios) < chi2(2).ppf(level))
        assert abs(within - level * RECORDS) < 3 * np.sqrt(RECORDS * level * (1 - level))
    assert abs(np.mean(best)) < 3 * np.std(best) / np.sqrt(RECORDS)
