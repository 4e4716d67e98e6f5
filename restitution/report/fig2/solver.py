"""What Figure 2's page says of the solver: settling spheres, numerics of the runs, verification."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from restitution.report.page import percent
from restitution.runs.validity import physics

if TYPE_CHECKING:
    from restitution.report.fig2.checks import Check
    from restitution.report.fig2.content import Fig2
    from restitution.runs.kept import KeptRun


def settling(fig2: Fig2) -> list[dict]:
    """Peak speed over terminal speed of each release without contact, and the distance from its track."""
    rows = []
    for name, run in fig2.runs.items():
        settled = fig2.scores[name].settled
        if run.case.contact is not None or math.isnan(settled.peak_over_terminal):
            continue
        rows.append(
            {
                "name": name,
                "peak": f"{settled.peak_over_terminal:.4f}",
                "error": percent(settled.peak_over_terminal_error, ".2f"),
                "rms": "" if math.isnan(settled.rms_over_drop) else f"{settled.rms_over_drop * 100:.2f} %",
                "made": run.made_with,
                "stale": run.stale,
            }
        )
    return rows


def numerics(run: KeptRun) -> dict:
    """Grid, box, step and method of a run."""
    n, film, about = run.case.numerics, run.case.film, run.about
    return {
        "name": run.case.name,
        "cells": f"{n.cells_per_diameter:g}",
        "shape": " × ".join(str(s) for s in about.shape),
        "steps": about.steps,
        "step_us": f"{about.step_s * 1e6:.3g}",
        "numbers": {k: f"{about.numbers[k]:.4g}" for k in ("Re", "Ma", "relaxation time", "grid Re")},
        "method": f"{run.case.rates}, {n.interpolation}, {n.precision}; sides {n.sides}, top {n.top}"
        + ("; a quarter" if run.case.quartered else ""),
        "film": film.form if film.form == "none" else f"{film.form}, {film.cut_off:g} cells",
        "seconds": f"{about.seconds:.0f} ({about.threads})",
    }  # fmt: skip


def missed(checks: list[Check]) -> str:
    """How many figures with an aim miss it, and which kinds, in words."""
    aimed = [c for c in checks if c.target is not None]
    kinds = Counter(c.name for c in aimed if c.missed)
    if not kinds:
        return f"All {len(aimed)} figures with an aim meet it."
    each = ", ".join(f"{name} ({n} of {sum(c.name == name for c in aimed)})" for name, n in kinds.items())
    return f"Of {len(aimed)} figures with an aim {sum(kinds.values())} miss it: {each}."


def older(checks: list[Check]) -> str:
    """What is to be said of figures that another version of the program gave; nothing where there are none."""
    now = physics.agreed_version()
    old = sum(c.physics is None or c.physics != now for c in checks)
    return f"{old} of these figures were measured with another version of the program." if old else ""


def check(c: Check) -> dict:
    """A figure of the verification beside its reference."""
    # Against 0 the error is the figure itself, which stands there already.
    return {
        "name": c.name,
        "case": c.case,
        "measured": f"{c.measured:.4g}",
        "reference": f"{c.reference:.4g}" if c.reference else "",
        "error": percent(c.error, ".2f"),
        "target": "" if c.target is None else f"{c.target * 100:g} %",
        "missed": c.missed,
        "source": c.source,
    }
