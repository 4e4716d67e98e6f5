"""What the result of Figure 2 depends on: rows of the groups of cases that differ in one choice."""

from __future__ import annotations

from restitution.report.fig2.content import Fig2
from restitution.report.page import number, percent

SHOWN = 2
"""Bounces that are shown."""


def sensitivity(fig2: Fig2) -> list[dict]:
    """Changes of apexes, intervals and rms gap from the first case of each group that is kept."""
    rows = []
    for group in fig2.groups:
        kept = [name for name in group.names if name in fig2.runs]
        if len(kept) > 1:
            rows += [_row(group.varies, name, fig2, kept[0]) for name in kept]
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
