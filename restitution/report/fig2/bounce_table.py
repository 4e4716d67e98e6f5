"""The tables of bounces on Figure 2's page: records, runs and lines of the point particle as rows of words."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from restitution import datasets
from restitution.bounce.agreement import distance_from_contact_d
from restitution.impacts.bounces import Bounces
from restitution.impacts.shipped import impacts_of
from restitution.report.fig2.content import PUBLISHED, RECORD, SHORT, Fig2
from restitution.report.fig2.scores import BOUNCES, Score, reference_apexes
from restitution.report.page import number, percent
from restitution.stokes import Speed


def main_rows(fig2: Fig2) -> list[dict]:
    """The record, the published simulation, the runs of the figure and its finer grids, the point particle."""
    rows = [
        _record_row(RECORD, "measured", fig2.records[RECORD], None),
        _record_row(PUBLISHED, "published simulation", fig2.records[PUBLISHED], fig2.records[RECORD]),
    ]
    own = [name for name in fig2.own if fig2.runs[name].case.record == RECORD]
    grids = [
        name for group in fig2.groups if group.of_grids and group.against.name in SHORT for name in group.names
    ]
    shown = dict.fromkeys((*SHORT, *grids, *own))
    rows += [run_row(fig2, name) for name in shown if name in fig2.runs]
    return rows + [_line_row(fig2.scores[line.name]) for line in fig2.lines]


def rows_of_other_records(fig2: Fig2) -> list[dict]:
    """Each record followed by its runs."""
    runs = [
        run for run in fig2.runs.values() if run.case.record not in (None, RECORD) and run.case.contact is not None
    ]
    rows = []
    for record in dict.fromkeys(run.case.record for run in runs):
        rows.append(_record_row(record, "measured", fig2.records.get(record), None))
        rows += [run_row(fig2, run.case.name) for run in runs if run.case.record == record]
    return rows


def run_row(fig2: Fig2, name: str) -> dict:
    """A kept run and its errors."""
    run, score = fig2.runs[name], fig2.scores[name]
    cells = f"{score.grid.cells_per_diameter:g}"
    return _scored(score) | {"cells": cells, "made": run.made_with, "stale": run.stale}


def _line_row(score: Score) -> dict:
    return _scored(score) | {"cells": "", "made": "point-particle model, at once", "stale": False}


def _scored(score: Score) -> dict:
    b = score.bounces
    return {
        "name": score.case,
        "contact": score.contact,
        "v": number(score.approach_speed_m_s, 3),
        "apexes": _cells(b.apexes_m, b.apex_errors),
        "intervals": _cells(b.intervals_s, b.interval_errors),
        "rms": number(score.rms_gap_d, 3),
    }


def _record_row(name: str, contact: str, found: Bounces | None, goal: Bounces | None) -> dict:
    """A record as far as it has bounces; beside the main record, the ``goal``, where it is a simulation of it."""
    resource, nothing = datasets.resource(name), np.empty(0)
    apexes, pace = (reference_apexes(name, found), found.intervals_s) if found is not None else (nothing, nothing)
    rms = "" if goal is None else f"{distance_from_contact_d(found, goal, resource.conditions):.3f}"
    return {
        "name": resource.experiment.cite,
        "contact": contact,
        "cells": "",
        "v": "" if found is None else _far_speed(name),
        "apexes": _cells(apexes, _errors(apexes, nothing if goal is None else reference_apexes(RECORD, goal))),
        "intervals": _cells(pace, _errors(pace, nothing if goal is None else goal.intervals_s)),
        "rms": rms,
        "made": name,
        "stale": False,
    }


def _far_speed(name: str) -> str:
    """Speed of the first approach of a record outside the film."""
    rows = [r for r in impacts_of(name, Speed.FAR).rows if r["impact"] == 1]
    return f"{rows[0]['impact_speed_m_s']:.3f}" if rows else ""


def _errors(values: Sequence[float], goals: Sequence[float]) -> list[float]:
    return [value / goals[k] - 1 if k < len(goals) else math.nan for k, value in enumerate(values)]


def _cells(values: Sequence[float], errors: Sequence[float]) -> list[str]:
    """The first bounces in thousandths, each with its error in brackets; empty where there is none."""
    shown = [_cell(value, error) for value, error in zip(values, errors, strict=True)]
    return (shown + [""] * BOUNCES)[:BOUNCES]


def _cell(value: float, error: float) -> str:
    if math.isnan(value):
        return ""
    return _three_digits(value * 1e3) + (f" ({percent(error)})" if not math.isnan(error) else "")


def _three_digits(value: float) -> str:
    """Two decimals, below 1 three digits."""
    return f"{value:#.3g}" if value < 1 else f"{value:.2f}"
