"""The files that a run leaves: tables in the schemas of the measured data, ``run.json``, pictures of the flow."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from restitution.runs.filmed import filmed, simulated_impacts
from restitution.runs.flow_pictures import FlowFrames
from restitution.runs.record import FILE, RunRecord, SolverContact, digest
from restitution.runs.resolved import ResolvedRun
from restitution.runs.validity import physics
from restitution.runs.validity.program import program_hash
from restitution.runs.validity.told import told
from restitution.tables.writing import table_text

if TYPE_CHECKING:
    import pandas as pd


def results(run: ResolvedRun, frames: FlowFrames, seconds: float, every_step: bool) -> dict[str, str | bytes]:
    """The files of a run as it now stands, the motion of ``every_step`` among them or not."""
    case, motion = run.case, _rows(run)
    trajectory = motion[["time_s", "gap_m"]]
    velocity = motion[["time_s", "vz_m_s"]].rename(columns={"vz_m_s": "velocity_m_s"})
    impacts, notes = simulated_impacts(trajectory, case)
    first = run.contacts[0].time_s if run.contacts else 0.0
    contents: dict[str, str | bytes] = {
        "trajectory.csv": table_text(trajectory),
        "velocity.csv": table_text(velocity),
        "impacts.csv": table_text(impacts),
        "flow.npz": frames.as_bytes(),
    }
    if every_step:
        contents["motion.csv"] = table_text(run.motion(), "%.7g")
    record = RunRecord(
        case=case.name,
        title=case.title,
        date=time.strftime("%Y-%m-%d", time.gmtime()),
        finished=run.finished and not run.gave_up,
        seconds=round(seconds, 1),
        threads=run.simulation.threads,
        steps=run.simulation.steps,
        shape=run.simulation.shape,
        step_s=run.step_s,
        numbers={name: float(f"{value:.5g}") for name, value in run.flow.describe().items()},
        contacts=tuple(_contact(c, first) for c in run.contacts),
        notes=(*run.notes, *notes),
        physics=physics.agreed_version(),
        code_hash=program_hash(),
        told=told(case),
        filmed=filmed(case),
        case_as_run=case.model_dump(mode="json", exclude_none=True),
        files={name: digest(content) for name, content in contents.items()},
    )
    return contents | {FILE: record.text()}


def trajectory_of(run: ResolvedRun) -> pd.DataFrame:
    """``time_s`` from the first contact and ``gap_m``, as far as the run has come, in the rows that are kept."""
    return _rows(run)[["time_s", "gap_m"]]


def _rows(run: ResolvedRun) -> pd.DataFrame:
    return run.motion().iloc[:: run.setup.rows_apart]


def _contact(c: SolverContact, first: float) -> SolverContact:
    return SolverContact(
        time_s=_g(c.time_s - first), speed_in_m_s=_g(c.speed_in_m_s), speed_out_m_s=_g(c.speed_out_m_s)
    )


def _g(value: float) -> float:
    return float(f"{value:.6g}")
