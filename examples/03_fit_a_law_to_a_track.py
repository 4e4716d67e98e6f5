"""Task: fit a rebound law to a track by all its positions, not by slopes beside the contacts.

The equation of motion of a bouncing sphere is fitted to every frame, the restitution of each bounce among the
unknowns; the law is fitted to those restitutions.
Printed: e of each bounce with its error, the parameter of the law, the first apex with the law and as measured,
and how far the law's trajectory is from the frames.
Source: Gondret, Lance & Petit, Phys. Fluids 14 (2002) 643, Fig. 2, the 3 mm sphere.
"""

from restitution import datasets
from restitution.calibration import Plan, Reading, model_of
from restitution.calibration.trajectories import Measured, fit_law, read_recordings

RECORD = "gondret2002_st152"  # or the name of a file of one's own, with Reading(conditions=...)


def main():
    """The restitutions, K with its intervals, first apexes in m and the distance from the frames in d."""
    reading = Reading()
    recordings = read_recordings([RECORD], reading)
    measured = Measured.of(recordings, wakes=[True])  # the sphere meets the wake of its own approach
    fit = fit_law(measured, Plan(model_of("eq4_linear")), reading)
    result = fit.result()

    restitutions = fit.trajectories[0].restitutions
    for n, (e, sigma) in enumerate(restitutions, 1):
        print(f"bounce {n}: e = {e:.3f} +- {sigma:.3f}")
    print(result)
    record = result.trajectories[0]
    apex = datasets.resource(RECORD).quoted["apex_m"][0]
    print(f"first apex {1e3 * record.apex_1_law_m:.2f} mm, measured {1e3 * apex:.2f} mm")
    print(f"rms of the gaps {record.rms_law_d:.3f} d")
    K = result.parameters[0]
    return {
        "e": [e for e, _ in restitutions], "K": K.value, "intervals": K.intervals,
        "apex": record.apex_1_law_m, "rms_d": record.rms_law_d,
    }  # fmt: skip


if __name__ == "__main__":
    main()
