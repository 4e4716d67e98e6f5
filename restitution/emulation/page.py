"""The page of a calibrated solver, its figures, and ``solver.json``, by file name."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata

from restitution.emulation import plot
from restitution.emulation.calibration import Calibration
from restitution.emulation.held_out import GAIN, closer, distances
from restitution.emulation.solver_file import FILE, solver_fit
from restitution.report.page import render


def files(table: str, found: Sequence[Calibration], command: str) -> dict[str, str | bytes]:
    """All that is written: ``index.html``, ``solver.json`` and the figures of each group."""
    contents: dict[str, str | bytes] = {}
    groups = []
    for k, c in enumerate(found):
        every = (*c.used, *c.held_out)
        drawings = {"posterior": plot.corner(c), "emulator": plot.emulator(every)}
        beside = []
        for e, p in zip(every, c.predictions, strict=True):
            conditions = e.recording.conditions
            beside.append((p, plot.record(p, conditions.sphere.diameter, conditions.gravity)))
            drawings[f"record_{len(beside)}"] = beside[-1][1]
        prefix = f"{k + 1}_" if len(found) > 1 else ""
        contents |= {f"{prefix}{name}.svg": drawing.svg for name, drawing in drawings.items()}
        groups.append({"c": c, "drawings": drawings, "beside": beside, "checks": every})
    fit = solver_fit(table, found)
    page = render(
        "solver.html.j2", title="A solver calibrated by its runs", command=command, groups=groups, fit=fit,
        recommended=recommended(found), missed=missed(found), gains=[gain(c) for c in found],
        worth=not missed(found) and any(closer(c.predictions) < GAIN for c in found),
        sklearn=metadata.version("scikit-learn"),
    )  # fmt: skip
    return {"index.html": page, FILE: fit.text(), **contents}


def recommended(found: Sequence[Calibration]) -> list[dict[str, object]]:
    """One row a parameter and group: the recommended value with its intervals."""
    return [
        {
            "group": c.group.label, "name": t.name, "median": f"{t.median:.4g}",
            "68%": "{:.4g} to {:.4g}".format(*t.intervals[0.68]),
            "95%": "{:.4g} to {:.4g}".format(*t.intervals[0.95]),
            "prior": "{:.4g} to {:.4g}".format(*t.prior) + (", log" if t.logarithmic else ""),
            "says": said(c, t.name),
        }
        for c in found
        for t in c.told
    ]  # fmt: skip


def missed(found: Sequence[Calibration]) -> list[str]:
    """Records from which the solver is farther than its parameters move it."""
    return list(dict.fromkeys(x.record for c in found for x in c.discrepancies if x.elsewhere))


def said(c: Calibration, name: str) -> str:
    """What the records say of a parameter, in words."""
    t = next(t for t in c.told if t.name == name)
    if t.pressed:
        return f"at the {'lower' if t.pressed == 'low' else 'upper'} end of the runs, or beyond"
    if t.says_nothing:
        return "the records say nothing about it"
    return f"{t.share:.0%} of the prior's width"


def gain(c: Calibration) -> str:
    """Whether records come closer, those that were met and those that had no say, in a sentence."""
    known = distances(c.predictions)
    parts = [
        f"records {'held out' if held else 'met'} from {before:.3f} to {after:.3f} d"
        for held, (before, after) in known.items()
    ]
    which = "that had no say" if True in known else "that were met (none was held out)"
    said = f"{'something' if closer(c.predictions) < GAIN else 'nothing'} is gained on records {which}"
    label = f"{c.group.label}: " if c.group.label else ""
    return f"{label}root mean square distances go, {', '.join(parts)}: {said}."
