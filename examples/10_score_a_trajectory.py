"""Task: score somebody else's trajectory, here a published simulation, against a record.

Printed, for both and by the same functions: apexes, times from contact to contact, e_eff of each impact; then the
distance of the one from the other, each from its own first contact.
Source: simulation by Biegert, Vowinckel & Meiburg, J. Comput. Phys. 340 (2017) 105; measured by Gondret, Lance &
Petit, Phys. Fluids 14 (2002) 643, the 3 mm sphere.
"""

from restitution import datasets
from restitution.bounce import distance_from_contact_d
from restitution.impacts import filmed, find_impacts

TRAJECTORIES = {"measured": "gondret2002_st152", "simulated": "biegert2017_st152"}


def main():
    """Apexes in m, times in s, e_eff with St, of both; the distance in d."""
    conditions = datasets.resource("gondret2002_st152").conditions
    scores, bounces = {}, {}
    for name, record in TRAJECTORIES.items():
        track = datasets.load_track(record)  # or Track.from_table(pandas.read_csv(...))
        bounces[name] = filmed(track, conditions)
        impacts = find_impacts(track, conditions, speed="far").table().query("outcome == 'rebound'")
        scores[name] = {
            "apexes": bounces[name].apexes_m,
            "intervals": bounces[name].intervals_s,
            "stokes": impacts.stokes.to_numpy(float),
            "e_eff": impacts.e_eff.to_numpy(float),
        }
        print(f"{name}: apexes {(1e3 * bounces[name].apexes_m).round(2)} mm")
        print(f"  contact to contact {(1e3 * bounces[name].intervals_s).round(1)} ms")
        for row in impacts.itertuples():
            print(f"  St {row.stokes:5.1f}: e_eff {row.e_eff:.2f} +- {row.e_eff_sigma:.2f}")
    rms = distance_from_contact_d(bounces["simulated"], bounces["measured"], conditions)
    print(f"rms of the gaps up to t* = 8: {rms:.3f} d")
    return scores | {"rms_d": rms}


if __name__ == "__main__":
    main()
