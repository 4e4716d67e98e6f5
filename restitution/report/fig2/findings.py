"""What the runs of Figure 2 say, in words made of their own scores."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from restitution import datasets
from restitution.impacts.find import find_impacts
from restitution.report.page import number, percent
from restitution.stokes import Speed

if TYPE_CHECKING:
    import pandas as pd

    from restitution.report.fig2.content import Fig2
    from restitution.runs.kept import KeptRun

GRIDS = ("gondret_st152_10", "gondret_st152_16", "gondret_st152_20")
SMALL_GRIDS = tuple(f"{name}_small" for name in GRIDS)


def in_words(fig2: Fig2, imposed: str, main: str, soft: str, record: str) -> list[str]:
    """Findings on the main run, its restitution, its grid and its contact, as far as there are runs."""
    table = fig2.scores.set_index("case")
    if main not in fig2.runs:
        return []
    words = [_main(table.loc[main], fig2.runs[main]), _restitution(fig2.runs[main], record)]
    words += [
        w for w in (_grids(fig2, table, GRIDS, ""), _grids(fig2, table, SMALL_GRIDS, " in the smaller box")) if w
    ]
    if soft in table.index:
        change = table.loc[soft, "apex_1_m"] / table.loc[main, "apex_1_m"] - 1
        words.append(
            "A contact stretched over the time that sound needs to pass two diameters, which takes no added mass "
            f"from outside, changes the first apex by {percent(change)}."
        )
    if imposed in fig2.runs:
        words.append(_imposed(table.loc[imposed], fig2.runs[imposed]))
    return words


def _main(row: pd.Series, run: KeptRun) -> str:
    apexes = " and ".join(percent(row[f"apex_{k}_error"]) for k in (1, 2))
    intervals = " and ".join(percent(row[f"interval_{k}_error"]) for k in (1, 2))
    cells = run.case.numerics.cells_per_diameter
    return (
        f"With nothing tuned, at {cells:g} cells per diameter, the first two apexes are off by {apexes}, "
        f"the times between contacts by {intervals}; the rms distance is {number(row['rms_gap_d'], 3)} d."
    )


def _restitution(run: KeptRun, record: str) -> str:
    """e_eff far, bounce by bounce, beside the measured one and its error."""
    rows = find_impacts(datasets.load_track(record), datasets.resource(record).conditions, Speed.FAR).rows
    own = run.impacts[run.impacts.speed_definition == str(Speed.FAR)].set_index("impact").e_eff
    measured = {r["impact"]: (r["e_eff"], r["e_eff_sigma"]) for r in rows if "e_eff" in r}
    pairs = [(own[k], *found) for k, found in measured.items() if math.isfinite(own.get(k, math.nan))]
    within = sum(abs(a - b) <= 2 * s for a, b, s in pairs)
    each = "; ".join(f"{a:.3f} against {b:.3f} ± {s:.3f}" for a, b, s in pairs)
    return (
        f"Its e_eff outside the film, bounce by bounce, the measured one second: {each}; "
        f"{within} of {len(pairs)} within two standard errors."
    )


def _imposed(row: pd.Series, run: KeptRun) -> str:
    """What becomes of an e_eff that is imposed at the wall."""
    far = run.impacts[run.impacts.speed_definition == str(Speed.FAR)].e_eff.dropna()
    given = [c.speed_out_m_s / c.speed_in_m_s for c in run.about.contacts[: len(far)] if c.speed_in_m_s > 0]
    pairs = "; ".join(f"{a:.3f} becomes {b:.3f}" for a, b in zip(given, far, strict=False))
    return (
        f"With contact (a) e_eff is imposed at the wall; evaluated as the record is, {pairs}, and the first apex "
        f"is off by {percent(row['apex_1_error'])}: the drag of the fluid set in motion, strongest at once after "
        "the reversal, is in the measured e_eff already and acts once more in the run."
    )


def _grids(fig2: Fig2, table: pd.DataFrame, names: tuple[str, ...], where: str) -> str | None:
    """How far the apexes of several grids and lattice speeds are apart, with the same closures."""
    known = [name for name in names if name in table.index and not math.isnan(table.loc[name, "apex_1_m"])]
    if len(known) < 2:
        return None
    rows = table.loc[known]
    cells, speeds = (", ".join(f"{v:g}" for v in rows[c]) for c in ("cells_per_diameter", "lattice_speed"))
    shown = []
    for k, which in ((1, "first"), (2, "second")):
        apexes = rows[f"apex_{k}_m"].dropna()
        values = ", ".join(number(a * 1e3, 2) for a in apexes)
        shown.append(f"{which} apex {values} mm, {100 * (apexes.max() / apexes.min() - 1):.1f} % between them")
    stale = ", ".join(name for name in known if fig2.runs[name].stale)
    return (
        f"With {cells} cells per diameter and lattice speeds of {speeds}{where}: {'; '.join(shown)}; "
        f"the last is {percent(rows['apex_1_error'].iloc[-1])} from the record's first apex."
        + (f" Made with another version of code or case: {stale}." if stale else "")
    )
