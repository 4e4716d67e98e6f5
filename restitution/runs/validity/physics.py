"""Whether the program still computes what it did when the kept runs were made, held by numbers, not by its text.

``cases/probes/`` has small cases, some seconds in all, which together use every option of a case. What the program
made of them stands in ``probes.json`` beside this module, with a version that is raised when these numbers are
written anew (``python -m benchmarks.probes --write "why"``). A text that is known to agree is not asked again:
that of ``probes.json``, or one whose verdict lies beside the compiled kernels.

Numbers are dimensionless: lengths over the diameter d, speeds over the reference speed v, times over d/v, forces
over rho v^2 d^2. They are compared, never hashed: processors and libraries differ in the last digits.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

from restitution import datasets
from restitution.cases import reading as case_files
from restitution.cases.case import Case
from restitution.errors import InputError
from restitution.files import write_whole
from restitution.runs.filmed import simulated_impacts
from restitution.runs.resolved import ResolvedRun, kernel_folder
from restitution.runs.validity.program import program_hash

TOLERANCES = {"float64": 2e-11, "float32": 1.5e-5, "impacts": 2e-3}
"""Largest differences that count as none, by precision of the run, and for impacts taken from a measured track.

Thirty times what one program moves with threads, processor (generic, without fused multiply-add) and numba 0.61 to
0.68: 6e-13 and 5e-7 (``python -m benchmarks.probes --spread``). The errors of impacts come from draws in which the
last digits decide now and then: between two processors one record's moved by 5e-4.
"""
PROBES = Path(case_files.__file__).parent / "probes"
NUMBERS = Path(__file__).parent / "probes.json"
IMPACTS = "impacts"
"""Name of the probe of what takes impacts from a track, which no run of the solver depends on."""
IMPACT_RECORD = "gondret2002_st27"
_MOMENTS = (0.2, 0.4, 0.6, 0.8, 1.0)
_DIGITS = 13

Numbers = dict[str, list[float]]


@cache
def committed() -> dict:
    """The content of ``probes.json``: version, why it was raised, text of the program that agreed, numbers."""
    return json.loads(NUMBERS.read_text("utf-8"))


def text(content: dict) -> str:
    """``probes.json`` as a text, an entry a line."""
    probes = ",\n".join(
        f"  {json.dumps(name)}: {{\n"
        + ",\n".join(
            f"   {json.dumps(entry)}: {json.dumps([_rounded(x) for x in numbers])}"
            for entry, numbers in entries.items()
        )
        + "\n  }"
        for name, entries in content["numbers"].items()
    )
    head = "".join(f" {json.dumps(key)}: {json.dumps(content[key])},\n" for key in ("version", "why", "program"))
    return f'{{\n{head} "numbers": {{\n{probes}\n }}\n}}\n'


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def version() -> int:
    """The version of the physics that kept runs must be of."""
    return committed()["version"]


@cache
def departures(show: Callable[[str], None] | None = None) -> tuple[str, ...]:
    """Probes whose numbers the present program does not give, each with the entries that depart.

    Runs the probes where the answer for this text is not known yet.
    """
    content = committed()
    if content["program"] == program_hash():
        return ()
    key = hashlib.sha256(program_hash().encode() + NUMBERS.read_bytes()).hexdigest()[:16]
    folder = kernel_folder()
    if folder is not None:
        with suppress(OSError, ValueError):
            return tuple(json.loads((folder / f"probes-{key}.json").read_text("utf-8")))
    if show is not None:
        show("the program is not the one that made the kept runs: checks by short probe cases what it computes")
    departing = tuple(compare(content["numbers"], probe_numbers()))
    if folder is not None:
        with suppress(InputError):  # a verdict that cannot be kept is found again
            write_whole(folder / f"probes-{key}.json", json.dumps(departing))
    return departing


def agreed_version() -> int | None:
    """The version of the physics where the program's runs are of it, None where a probe departs."""
    return None if any(not d.startswith(f"{IMPACTS}:") for d in departures()) else version()


def impacts_agree() -> bool:
    """Whether impacts are taken from a track as when the kept runs were made."""
    return not any(d.startswith(f"{IMPACTS}:") for d in departures())


def probe_numbers() -> dict[str, Numbers]:
    """What the present program makes of every probe."""
    return {case.name: _run(case) for case in probe_cases()} | {IMPACTS: _impacts()}


def probe_cases() -> list[Case]:
    """The probe cases, in the order of their names."""
    return [case_files.read_case(path) for path in sorted(PROBES.glob("*.toml"))]


def precision(probe: str) -> str:
    """Which of :data:`TOLERANCES` holds for a probe."""
    cases = {case.name: case.numerics.precision for case in probe_cases()}
    return cases.get(probe, IMPACTS)


def compare(committed: dict[str, Numbers], now: dict[str, Numbers]) -> list[str]:
    """``probe: entries`` for each probe that departs by more than its tolerance."""
    departing = []
    for name in sorted({*committed, *now}):
        ours, theirs = now.get(name, {}), committed.get(name, {})
        tolerance = TOLERANCES[precision(name)]
        entries = [e for e in sorted({*ours, *theirs}) if apart(ours.get(e), theirs.get(e)) > tolerance]
        if entries:
            departing.append(f"{name}: {', '.join(entries)}")
    return departing


def apart(one: list[float] | None, other: list[float] | None) -> float:
    """Largest difference of two entries; infinite where they are not of one length or not finite."""
    if one is None or other is None or len(one) != len(other):
        return np.inf
    difference = float(np.max(np.abs(np.subtract(one, other)), initial=0.0))
    return difference if np.isfinite(difference) else np.inf


def _run(case: Case) -> Numbers:
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()
    d, v, density = case.sphere.diameter, case.reference_speed, case.fluid.density
    motion = run.motion()
    rows = motion.iloc[[round(part * (len(motion) - 1)) for part in _MOMENTS]]

    def over(unit: float, *columns: str, of: pd.DataFrame = rows) -> list[float]:
        return [float(x) / unit for x in of[list(columns)].to_numpy().ravel()]

    once = rows.iloc[[2]]
    contacts = run.contacts
    return {
        "gap": over(d, "gap_m"),
        "place": over(d, "x_m", "y_m"),
        "velocity": over(v, "vx_m_s", "vy_m_s", "vz_m_s"),
        "spin": over(v / d, "spin_x_1_s", "spin_y_1_s", "spin_z_1_s"),
        "force": over(density * v**2 * d**2, "force_x_N", "force_y_N", "force_z_N", of=once),
        "torque": over(density * v**2 * d**3, "torque_x_N_m", "torque_y_N_m", "torque_z_N_m", of=once),
        "contacts": [x for c in contacts for x in (c.time_s * v / d, c.speed_in_m_s / v, c.speed_out_m_s / v)],
        "length": [run.time_s * v / d],
        "vorticity": [float(np.sqrt(np.mean(run.vorticity() ** 2))) * d / v],
    }


def _impacts() -> Numbers:
    """Impacts of a measured track, as they are taken from a simulated one."""
    track = datasets.load_track(IMPACT_RECORD)
    table = pd.DataFrame({"time_s": track.time_s, "gap_m": track.value})
    case = case_files.read_case("gondret_st27")
    rows = simulated_impacts(table, case)[0]
    names = ("e_eff", "e_eff_sigma", "impact_speed_m_s", "time_s")
    return {name: [float(x) for x in pd.to_numeric(rows[name], errors="coerce").dropna()] for name in names}
