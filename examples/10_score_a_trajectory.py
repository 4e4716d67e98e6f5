"""Task: score somebody else's trajectory, here a published simulation, against a record; hold one in a test.

Printed: approach speed, apexes, times from contact to contact, e_eff of each bounce and the distance in d, each
beside the record's, as `restitution validate --trajectory FILE --case gondret-st152` does for a file.
Source: simulation by Biegert, Vowinckel & Meiburg, J. Comput. Phys. 340 (2017) 105; measured by Gondret, Lance &
Petit, Phys. Fluids 14 (2002) 643, the 3 mm sphere.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import pandas

from restitution import datasets
from restitution.validation import assert_trajectory, case_of, score


def main():
    """The values of both by label."""
    case = case_of("gondret-st152")
    track = datasets.load_track("biegert2017_st152")
    # Its contact is stretched in time; its clock is zero at the end of the first, where the rebound begins.
    simulated = score("simulated", track, case, first_s=0.0)
    measured = score("measured", datasets.load_track(case.record), case)
    for r in simulated.judged.row.truth():
        if r.label in simulated.values:
            goal = f"at most {r.value:.2g}" if r.side == "at most" else f"{r.value:.4g} +- {r.tolerance:.2g}"
            print(f"{r.label}: {simulated.values[r.label]:.4g}, the record {goal}")
    print(f"could not be filled: {', '.join(simulated.left_open)}")
    # In a test of your own solver: fails where a value is not the record's, a known shortfall held where it is.
    assert_trajectory(track, case.name, allow={"apex 2, mm": 0.2}, may_lack=simulated.left_open)
    # A file will do, or columns; its header says what it holds: "t [ms],gap [mm]", "t/sqrt(d/g),gap/d", "t,v".
    with TemporaryDirectory() as folder:
        file = Path(folder) / "track.csv"
        pandas.DataFrame({"t [ms]": 1e3 * track.time_s, "gap [mm]": 1e3 * track.value}).to_csv(file, index=False)
        assert_trajectory(file, case.name, allow={"apex 2, mm": 0.2}, may_lack=simulated.left_open)
    return {"measured": measured.values, "simulated": simulated.values}


if __name__ == "__main__":
    main()
