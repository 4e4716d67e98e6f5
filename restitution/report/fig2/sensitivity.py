"""What the result of Figure 2 depends on: groups of cases that differ in one choice."""

from __future__ import annotations

from restitution.report.fig2.content import Fig2
from restitution.report.page import number, percent

SHOWN = 2
"""Bounces that are shown."""
SENSITIVITY = (
    (
        "cells per diameter, contact (b); at 20 half the lattice speed and 6 d wide",
        ("gondret_st152_10", "gondret_st152_16", "gondret_st152_20"),
    ),
    (
        "cells per diameter, contact (b), in a smaller box",
        ("gondret_st152_10_small", "gondret_st152_16_small", "gondret_st152_20_small"),
    ),
    ("a box 6 d wide and 12 d high, a way of 9 d", ("gondret_st152_10", "gondret_st152_10_small")),
    ("cells per diameter, contact (a)", ("gondret_st152_10_measured", "gondret_st152_16_measured")),
    ("cells per diameter, contact (c)", ("gondret_st152_10_soft", "gondret_st152_16_soft")),
    ("dry restitution 0.97 or 0.99", ("gondret_st152_10", "gondret_st152_10_elastic")),
    (
        "contact (a): e_eff of each bounce as measured, or by a law",
        ("gondret_st152_10_measured", "gondret_st152_10_eq4", "gondret_st152_10_legendre"),
    ),
    ("width of the box", ("gondret_st152_10", "gondret_st152_10_narrow", "gondret_st152_10_wide")),
    ("lattice speed", ("gondret_st152_10", "gondret_st152_10_fast", "gondret_st152_10_slow")),
    (
        "film: what the grid lacks, or Eq. (3) from 1 or 2 cells on",
        ("gondret_st152_10", "gondret_st152_10_cutoff1", "gondret_st152_10_cutoff2"),
    ),
    (
        "tension the film bears: 1 atm, calibrated at St 27, any",
        ("gondret_st152_10", "gondret_st152_10_calibrated", "gondret_st152_10_suction"),
    ),
    (
        "tension at 16 cells: 1 atm, calibrated at St 27",
        ("gondret_st152_16", "gondret_st152_16_calibrated"),
    ),
    (
        "added mass that the wall pays for: the lattice's, potential flow's",
        ("gondret_st152_10", "gondret_st152_10_potential"),
    ),
)
"""What is varied, and the cases; changes are from the first."""


def sensitivity(fig2: Fig2) -> list[dict]:
    """Changes of apexes, intervals and rms gap from the first case of each group that is kept."""
    rows = []
    for what, names in SENSITIVITY:
        kept = [name for name in names if name in fig2.runs]
        if len(kept) > 1:
            rows += [_row(what, name, fig2, kept[0]) for name in kept]
    return rows


def _row(what: str, name: str, fig2: Fig2, first: str) -> dict:
    score, base, run = fig2.scores[name], fig2.scores[first], fig2.runs[name]
    apexes, intervals = score.bounces.apexes_m[:SHOWN], score.bounces.intervals_s[:SHOWN]
    changes = [percent(apex / old - 1) for apex, old in zip(apexes, base.bounces.apexes_m, strict=False)]
    return {
        "what": what,
        "name": name,
        "apexes": [number(apex * 1e3, 3) for apex in apexes],
        "changes": [""] * SHOWN if name == first else changes,
        "intervals": [number(interval * 1e3, 2) for interval in intervals],
        "v": number(score.approach_speed_m_s, 4),
        "rms": number(score.rms_gap_d, 3),
        "made": run.made_with,
        "stale": run.stale,
    }
