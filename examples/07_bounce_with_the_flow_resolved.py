"""Task: the same sphere with the flow around it resolved, from a case of one's own.

Six cells a diameter in a small box, to be had in seconds; ten cells and a longer way are what figures need.
Printed: the speeds at the wall, the first apex and the time to the second contact, simulated and measured.
Source: Gondret, Lance & Petit, Phys. Fluids 14 (2002) 643, Fig. 2, the 3 mm sphere.
"""

import tempfile
from pathlib import Path

from restitution import datasets
from restitution.cases import read_case
from restitution.impacts import filmed, modelled
from restitution.runs import ResolvedRun

CASE = """
base = "gondret_st152_10"   # the 3 mm sphere; what follows replaces its keys
[release]
kind = "drive"
gap_d = 5.0
speed = 0.585               # m/s
ramp = 0.002                # s
[numerics]
cells_per_diameter = 6
lattice_speed = 0.05
width_d = 4.0
height_d = 9.0
[run]
after_contact = 0.095       # s
"""


def main():
    """Contacts in m/s, apex in m and time of flight in s, simulated and measured."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mine.toml"
        file.write_text(CASE)
        case = read_case(file)
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()

    motion, contacts = run.motion(), run.contacts
    times = [contact.time_s - contacts[0].time_s for contact in contacts]
    simulated = modelled(motion.time_s.to_numpy(), motion.gap_m.to_numpy(), times, case.conditions)
    record = filmed(datasets.load_track(case.record), case.conditions)
    print(f"at the wall: {contacts[0].speed_in_m_s:.3f} m/s in, {contacts[0].speed_out_m_s:.3f} m/s out")
    for name, it in (("simulated", simulated), ("measured", record)):
        print(f"{name}: first apex {1e3 * it.apexes_m[0]:.2f} mm, flight of {1e3 * it.intervals_s[0]:.1f} ms")
    return {"contacts": contacts, "simulated": simulated, "measured": record, "motion": motion}


if __name__ == "__main__":
    main()
