"""What the runs of Figure 2 say, in words made of their own scores."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from restitution.impacts.shipped import impacts_of
from restitution.report.fig2.bands import band
from restitution.report.fig2.content import DRY, IMPOSED, RECORD, SOFT, Fig2
from restitution.report.fig2.scores import Score
from restitution.report.page import number, percent
from restitution.stokes import Speed

if TYPE_CHECKING:
    from restitution.cases.case import Case
    from restitution.report.fig2.studies import Group
    from restitution.runs.kept import KeptRun


def in_words(fig2: Fig2) -> list[str]:
    """Findings on the two ways of contact, restitution, what is not known, grids, and the stretched contact."""
    words = []
    for name, opening in _openings(fig2).items():
        words += [opening + _errors(fig2.scores[name]) + _unknown(fig2, name), _restitution(fig2.runs[name])]
        words += [w for group in fig2.groups if (w := _grids(fig2, group, name))]
    if SOFT in fig2.runs and DRY in fig2.runs:
        change = _first_apex(fig2.scores[SOFT]) / _first_apex(fig2.scores[DRY]) - 1
        words.append(
            "A contact stretched over the time that sound needs to pass two diameters, which takes no added mass "
            f"from outside, changes the first apex of the dry contact by {percent(change)}."
        )
    return words


def _openings(fig2: Fig2) -> dict[str, str]:
    """How each way of contact was run, by case, as far as there are runs."""
    found = {}
    if IMPOSED in fig2.runs:
        contact = fig2.runs[IMPOSED].case.contact
        constants = ", ".join(f"{name} = {value:g}" for name, value in contact.parameters.items())
        found[IMPOSED] = (
            f"The abstract's way, e_eff imposed at each bounce by {contact.law} with {constants}, fitted to the "
            "other records"
        )
    if DRY in fig2.runs:
        found[DRY] = "With e_dry and the film resolved, nothing tuned"
    return found


def _first_apex(score: Score) -> float:
    return score.bounces.apexes_m[0]


def _errors(score: Score) -> str:
    apexes = " and ".join(percent(error) for error in score.bounces.apex_errors[:2])
    intervals = " and ".join(percent(error) for error in score.bounces.interval_errors[:2])
    return (
        f", at {score.grid.cells_per_diameter:g} cells per diameter: the first two apexes are off by {apexes}, "
        f"the times between contacts by {intervals}; the rms distance is {number(score.rms_gap_d, 3)} d."
    )


def _unknown(fig2: Fig2, name: str) -> str:
    """How far the first apex lies open, one cause at a time."""
    about = band(fig2, name)
    if about is None:
        return ""
    apexes = [_first_apex(fig2.scores[case]) for case in (name, *about.cases)]
    low, high = (number(apex * 1e3, 2) for apex in (min(apexes), max(apexes)))
    return f" What is not known leaves its first apex open from {low} to {high} mm ({', '.join(about.cases)})."


def _restitution(run: KeptRun) -> str:
    """e_eff far, bounce by bounce, beside the measured one and its error."""
    rows = impacts_of(RECORD, Speed.FAR).rows
    own = run.impacts[run.impacts.speed_definition == str(Speed.FAR)].set_index("impact").e_eff
    measured = {r["impact"]: (r["e_eff"], r["e_eff_sigma"]) for r in rows if "e_eff" in r}
    pairs = [(own[k], *found) for k, found in measured.items() if math.isfinite(own.get(k, math.nan))]
    within = sum(abs(a - b) <= 2 * s for a, b, s in pairs)
    each = "; ".join(f"{a:.3f} against {b:.3f} ± {s:.3f}" for a, b, s in pairs)
    return (
        f"Its e_eff outside the film by slopes, both evaluated alike, bounce by bounce, the measured one second: "
        f"{each}; {within} of {len(pairs)} within two standard errors."
    )


def _grids(fig2: Fig2, group: Group, name: str) -> str | None:
    """How far the apexes of several grids and lattice speeds are apart, with the closures of the run ``name``."""
    main, first = fig2.runs[name].case, group.against
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
    where = "" if first.name == name else " in the smaller box" if _smaller(first, main) else f" of {first.name}"
    return (
        f"With {cells} cells per diameter and lattice speeds of {speeds}{where}: {'; '.join(shown)}; "
        f"the last is {percent(scores[-1].bounces.apex_errors[0])} from the record's first apex."
        + (f" Made with another version of code or case: {stale}." if stale else "")
    )


def _smaller(case: Case, main: Case) -> bool:
    """Whether a case has a smaller box than the main one."""
    return all(getattr(case.numerics, side) < getattr(main.numerics, side) for side in ("width_d", "height_d"))
