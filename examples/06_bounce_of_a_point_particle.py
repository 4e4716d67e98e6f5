"""Task: a bouncing sphere as a point particle, in milliseconds, against a record.

Released as it was filmed, with the rebound by Legendre's law, and by Eq. (4), its K that of all records, without
and with the wake of the approach, whose constants are those of resolved runs.
Printed: the first apexes, modelled and measured; the distance from the frames, each trajectory from its own first
contact; the energy that the integration loses.
Source: Gondret, Lance & Petit, Phys. Fluids 14 (2002) 643, Fig. 2, the 3 mm sphere.
"""

from restitution import datasets, laws
from restitution.bounce import Closures, OwnWake, bounce, distance_from_contact_d, release_of
from restitution.impacts import filmed, modelled

RECORD = "gondret2002_st152"


def main():
    """Apexes in m, distance in d and imbalance of the energy, by model; the apexes of the record."""
    conditions = datasets.resource(RECORD).conditions
    track = datasets.load_track(RECORD)
    record = filmed(track, conditions)
    release = release_of(track, conditions)  # the first frame, and the mean speed of the approach

    models = {
        "Legendre": Closures(rebound=laws.get("legendre_2005")),
        "Eq. (4)": Closures(rebound=laws.get("eq4_exponential", K=10.9)),
        "Eq. (4), wake": Closures(rebound=laws.get("eq4_exponential", K=10.9), wake=OwnWake()),
    }
    found = {}
    for name, closures in models.items():
        path = bounce(conditions, release, closures, end=0.4)
        contacts = [impact.time_s for impact in path.impacts]
        rms = distance_from_contact_d(modelled(path.time_s, path.gap_m, contacts, conditions), record, conditions)
        apexes = ", ".join(f"{1e3 * gap:.2f}" for gap in path.apexes()[:3])
        print(f"{name}: apexes {apexes} mm, rms {rms:.3f} d, energy lost {path.imbalance:.1e}")
        found[name] = {"apexes": path.apexes()[:3], "rms_d": rms, "imbalance": path.imbalance}
    print("measured: apexes", ", ".join(f"{1e3 * gap:.2f}" for gap in record.apexes_m[:3]), "mm")
    return found


if __name__ == "__main__":
    main()
