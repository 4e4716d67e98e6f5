"""What the runs of Figure 2 say, in words made of their own scores."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from restitution import datasets
from restitution.impacts.find import find_impacts
from restitution.report.fig2.content import IMPOSED, MAIN, RECORD, SOFT, Fig2
from restitution.report.fig2.scores import Score
from restitution.report.page import number, percent
from restitution.stokes import Speed

if TYPE_CHECKING:
    from restitution.cases.case import Case
    from restitution.report.fig2.studies import Group
    from restitution.runs.kept import KeptRun


def in_words(fig2: Fig2) -> list[str]:
    """Findings on the main run, its restitution, its grid and its contact, as far as there are runs."""
    if MAIN not in fig2.runs:
        return []
    words = [_main(fig2.scores[MAIN]), _restitution(fig2.runs[MAIN])]
    words += [w for group in fig2.groups if (w := _grids(fig2, group))]
    if SOFT in fig2.runs:
        change = _first_apex(fig2.scores[SOFT]) / _first_apex(fig2.scores[MAIN]) - 1
        words.append(
            "A contact stretched over the time that sound needs to pass two diameters, which takes no added mass "
            f"from outside, changes the first apex by {percent(change)}."
        )
    if IMPOSED in fig2.runs:
        words.append(_imposed(fig2.scores[IMPOSED], fig2.runs[IMPOSED]))
    return words


def _first_apex(score: Score) -> float:
    return score.bounces.apexes_m[0]


def _main(score: Score) -> str:
    apexes = " and ".join(percent(error) for error in score.bounces.apex_errors[:2])
    intervals = " and ".join(percent(error) for error in score.bounces.interval_errors[:2])
    return (
        f"With nothing tuned, at {score.grid.cells_per_diameter:g} cells per diameter, the first two apexes are "
        f"off by {apexes}, the times between contacts by {intervals}; the rms distance is "
        f"{number(score.rms_gap_d, 3)} d."
    )


def _restitution(run: KeptRun) -> str:
    """e_eff far, bounce by bounce, beside the measured one and its error."""
    rows = find_impacts(datasets.load_track(RECORD), datasets.resource(RECORD).conditions, Speed.FAR).rows
    own = run.impacts[run.impacts.speed_definition == str(Speed.FAR)].set_index("impact").e_eff
    measured = {r["impact"]: (r["e_eff"], r["e_eff_sigma"]) for r in rows if "e_eff" in r}
    pairs = [(own[k], *found) for k, found in measured.items() if math.isfinite(own.get(k, math.nan))]
    within = sum(abs(a - b) <= 2 * s for a, b, s in pairs)
    each = "; ".join(f"{a:.3f} against {b:.3f} ± {s:.3f}" for a, b, s in pairs)
    return (
        f"Its e_eff outside the film, bounce by bounce, the measured one second: {each}; "
        f"{within} of {len(pairs)} within two standard errors."
    )


def _imposed(score: Score, run: KeptRun) -> str:
    """What becomes of an e_eff that is imposed at the wall."""
    far = run.impacts[run.impacts.speed_definition == str(Speed.FAR)].e_eff.dropna()
    given = [c.speed_out_m_s / c.speed_in_m_s for c in run.about.contacts[: len(far)] if c.speed_in_m_s > 0]
    pairs = "; ".join(f"{a:.3f} becomes {b:.3f}" for a, b in zip(given, far, strict=False))
    return (
        f"With contact (a) e_eff is imposed at the wall; evaluated as the record is, {pairs}, and the first apex "
        f"is off by {percent(score.bounces.apex_errors[0])}: the drag of the fluid set in motion, strongest at "
        "once after the reversal, is in the measured e_eff already and acts once more in the run."
    )


def _grids(fig2: Fig2, group: Group) -> str | None:
    """How far the apexes of several grids and lattice speeds are apart, with the closures of the main run."""
    main, first = fig2.runs[MAIN].case, group.against
    if not group.of_grids or (first.contact, first.film) != (main.contact, main.film):
        return None
    known = [n for n in group.names if n in fig2.runs and not math.isnan(_first_apex(fig2.scores[n]))]
    if len(known) < 2:
        return None
    scores = [fig2.scores[name] for name in known]
    cells = ", ".join(f"{s.grid.cells_per_diameter:g}" for s in scores)
    speeds = ", ".join(f"{s.grid.lattice_speed:g}" for s in scores)
    shown = []
    for k, which in enumerate(("first", "second")):
        apexes = [apex for s in scores if not math.isnan(apex := s.bounces.apexes_m[k])]
        values = ", ".join(number(apex * 1e3, 2) for apex in apexes)
        shown.append(f"{which} apex {values} mm, {100 * (max(apexes) / min(apexes) - 1):.1f} % between them")
    stale = ", ".join(name for name in known if fig2.runs[name].stale)
    where = "" if first.name == MAIN else " in the smaller box" if _smaller(first, main) else f" of {first.name}"
    return (
        f"With {cells} cells per diameter and lattice speeds of {speeds}{where}: {'; '.join(shown)}; "
        f"the last is {percent(scores[-1].bounces.apex_errors[0])} from the record's first apex."
        + (f" Made with another version of code or case: {stale}." if stale else "")
    )


def _smaller(case: Case, main: Case) -> bool:
    """Whether a case has a smaller box than the main one."""
    return all(getattr(case.numerics, side) < getattr(main.numerics, side) for side in ("width_d", "height_d"))
