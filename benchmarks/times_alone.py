"""Do times of contact, or apexes, alone say what the frames of the same record say?

Of every measured trajectory that ships, the times of contact are read from its own frames (``contact``), handed to
``restitution.flights`` as if a microphone had heard them, and e and the impact speed compared with those from the
frames (``far``). A difference counts as held where it is within the two errors in quadrature. The approach to the
first contact counts as not known, so that bounce 1 has no e; and once as quoted, by the speed of the frames.
The first restitution (:data:`restitution.flights.impacts.FIRST`) comes from the same records: without a
quoted speed this is no independent check of it.

    python -m benchmarks.times_alone
"""

from __future__ import annotations

import numpy as np

from restitution import datasets
from restitution.conditions import Conditions, QuotedImpact
from restitution.flights import Flights, impacts_of
from restitution.flights.table import Kind
from restitution.impacts import find_impacts
from restitution.impacts.bounces import filmed
from restitution.stokes import Speed


def main() -> None:
    held = {"e": [0, 0], "v": [0, 0]}
    print("| record | from | bounce | v by frames | v alone | e by frames | e alone | v, e apart in errors |")
    print("|---|---|---|---|---|---|---|---|")
    for name in datasets.names():
        resource = datasets.resource(name)
        if resource.table != "trajectory" or resource.kind != "measured" or resource.conditions is None:
            continue
        track = datasets.load_track(name)
        frames = {row["impact"]: row for row in find_impacts(track, resource.conditions).rows}
        contact = find_impacts(track, resource.conditions, Speed.CONTACT)
        if len(contact.rows) < 2:
            continue
        seen = filmed(track, resource.conditions)
        first = frames.get(1)
        quoted = (
            None
            if first is None
            else resource.conditions.model_copy(
                update={
                    "impact": QuotedImpact(
                        speed=first["impact_speed_m_s"], speed_sigma=first["impact_speed_sigma_m_s"]
                    )
                }
            )
        )
        plain = resource.conditions.model_copy(update={"impact": None})
        sigma = float(np.median(np.diff(track.time_s))) / np.sqrt(12)
        times = np.array([row["time_s"] for row in contact.rows])
        sets: list[tuple[str, Kind, np.ndarray, float, Conditions]] = [("times", "times", times, sigma, plain)]
        if len(seen.apexes_m) > 1:
            sets.append(("apexes", "apexes", seen.apexes_m, track.sigma, plain))
        if quoted is not None:
            sets.append(("times, v_1", "times", times, sigma, quoted))
        for label, kind, values, error, conditions in sets:
            if len(values) < (3 if kind == "times" and conditions is plain else 2):
                continue
            heard = Flights(kind, np.arange(1, len(values) + 1), values, np.full(len(values), error))
            for row in impacts_of(heard, conditions).rows:
                other = frames.get(row["impact"])
                if other is None or other["outcome"] != "rebound":
                    continue
                pulls = {}
                for short, column in (("v", "impact_speed_m_s"), ("e", "e_eff")):
                    own = column.replace("_m_s", "_sigma_m_s") if short == "v" else "e_eff_sigma"
                    pulls[short] = (row[column] - other[column]) / np.hypot(row[own], other[own])
                    told = not (short == "v" and row["impact"] == 1)  # which was quoted
                    held[short][0] += told and abs(pulls[short]) < 1
                    held[short][1] += told
                print(
                    f"| {name} | {label} | {row['impact']} | {_pm(other, 'impact_speed', 4)} | "
                    f"{_pm(row, 'impact_speed', 4)} | {_pm(other, 'e', 3)} | {_pm(row, 'e', 3)} | "
                    f"{pulls['v']:+.1f}, {pulls['e']:+.1f} |"
                )
    for short, (inside, all_of) in held.items():
        print(f"{short}: {inside} of {all_of} differences within their 68 % errors")


def _pm(row: dict, what: str, digits: int) -> str:
    value, sigma = (
        (row["e_eff"], row["e_eff_sigma"])
        if what == "e"
        else (row["impact_speed_m_s"], row["impact_speed_sigma_m_s"])
    )
    return f"{value:.{digits}f} +- {sigma:.{digits}f}"


if __name__ == "__main__":
    main()
