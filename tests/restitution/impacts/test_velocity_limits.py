"""A velocity tells its contact to within a frame alone: what is said of a rebound that is not resolved holds the
truth.
"""

import numpy as np

from restitution.impacts import find_impacts
from tests.flights import STEEL_IN_OIL, as_track, film, fly


def test_limits_of_rebounds_that_velocities_do_not_resolve_hold_their_e():
    """Exact velocities at 1 and 2 kHz, the last rebound within the film; the speed before is within two errors."""
    limited, held, spread = 0, 0, 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        fps = rng.choice([1000.0, 2000.0])
        e = (0.7, rng.uniform(0.15, 0.3))
        flights, truths = fly(0.01, 0.0, e, 0.55, STEEL_IN_OIL.free_fall)
        times = np.arange(rng.uniform(0, 1 / fps), flights[-1].end, 1 / fps)
        rows = find_impacts(as_track(times, film(flights, times)[1], "velocity"), STEEL_IN_OIL).rows
        for row in rows:
            if row["outcome"] == "rebound" or abs(row["time_s"] - truths[1].time_s) > 2 / fps:
                continue
            limited += 1
            held += row["e_eff_upper"] >= truths[1].v_out / truths[1].v_in
            spread += abs(row["impact_speed_m_s"] - truths[1].v_in) < 2 * row["impact_speed_sigma_m_s"]
    assert limited >= 10
    assert held == limited
    assert spread >= 0.9 * limited
