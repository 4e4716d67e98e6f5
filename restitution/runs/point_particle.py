"""The point-particle model on a case: the file of the resolved solver, and its tables.

What the options of a case become:

===========================  ==========================================================================
case                         point particle
===========================  ==========================================================================
fluid, sphere, wall          as they are
release ``rest``             released at rest in fluid at rest
release ``drive``            moved as told; the history force remembers it, at ``free_below_d`` it is free
film ``none``                the wall's resistance stays, within 0.1 d, at its value there
film, any other form         all of Brenner's resistance down to the floor: what forms and cut-offs add to
                             a grid is complete here
film ``floor``               gap of contact
film ``tension``             the film cavitates as the sphere leaves; without it, it holds
contact ``effective``        e_eff by law or as measured; the film within ``edge_d`` is a black box, and the
                             measured values of a record are those of the model without wake
contact ``dry``              e_dry at the floor
contact ``soft_*``           refused: a contact here takes no time
``[run]``                    as it is
not used                     ``[numerics]``, ``film.tangential``, ``contact.added_mass``, ``snapshot_interval``
===========================  ==========================================================================

Drag is the standard curve and history Dorgan & Loth's, the defaults of :class:`restitution.bounce.Closures`.
The fluid has no end but the wall.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution.bounce import Closures, Drive, Release, Trajectory, bounce, terminal_speed
from restitution.cases.case import Case
from restitution.errors import Defect, InputError
from restitution.files import write_folder
from restitution.runs.closures import edge_of, effective_law, measured_values
from restitution.runs.filmed import filmed, simulated_impacts
from restitution.runs.record import FILE, POINT_PARTICLE, RunRecord, SolverContact, digest
from restitution.runs.validity.program import program_hash
from restitution.stokes import StokesNumber
from restitution.tables.writing import table_text

if TYPE_CHECKING:
    import pandas as pd

ROW_D = 0.01
"""Way in diameters that the terminal speed makes between two rows."""
_LONGEST = 30.0
"""A sphere that has not met the wall after so many times its fall at terminal speed does not meet it."""
_MOST_ROWS = 1e7
"""Of a table: 240 MB in memory."""
_FIELDS = {
    "release.gap": "release.gap_d", "end": "run.duration", "rebound": "contact.law",
    "sphere.density / fluid.density": "sphere.density",
}  # fmt: skip


@dataclass(frozen=True)
class Prediction:
    """A case and its trajectory from the moment at which the sphere is free; ``first_s`` is its first contact.

    Without a contact ``first_s`` is the release, so minus the duration of the drive.
    """

    case: Case
    path: Trajectory
    release: Release
    first_s: float

    def table(self) -> pd.DataFrame:
        """Columns ``time_s`` from the first contact, ``gap_m``, ``velocity_m_s``; the drive included."""
        import pandas as pd

        d, step = self.case.sphere.diameter, row_s(self.case)
        begin = -self.release.drive.duration if self.release.drive is not None else 0.0
        t = np.arange(begin, self.path.time_s[-1], step)
        gap, velocity = self.path.gap(t), self.path.velocity(t)
        if self.release.drive is not None:
            driven = t < 0
            since = t[driven] - begin
            gap[driven] = self.case.release.gap_d * d - self.release.drive.distance(since)
            velocity[driven] = 0.0 - self.release.drive.velocity(since)
        return pd.DataFrame({"time_s": t - self.first_s, "gap_m": gap, "velocity_m_s": velocity})

    @property
    def contacts(self) -> tuple[SolverContact, ...]:
        """Time from the first and speeds of each contact, as in ``run.json``."""
        impacts = self.path.impacts if self.case.contact is not None else ()
        return tuple(
            SolverContact(time_s=_g(i.time_s - self.first_s), speed_in_m_s=_g(i.v_in), speed_out_m_s=_g(i.v_out))
            for i in impacts
        )


def row_s(case: Case) -> float:
    """Time in s between two rows of a table."""
    return ROW_D * case.sphere.diameter / terminal_speed(case.conditions)


def closures_of(case: Case, file: str = "") -> Closures:
    """The closures that a case chooses; raises :class:`InputError` for what the model cannot do."""
    film, contact, place = case.film, case.contact, file or case.name
    tension = math.inf if film.tension is None else film.tension
    e_dry = 0.0 if contact is None else case.sphere.e_dry  # without a contact the run ends where they touch
    if contact is None or contact.mode == "dry":
        lubrication = film.form != "none"
        return Closures(lubrication=lubrication, contact=case.floor or 0.0, tension=tension, e_dry=e_dry)
    if contact.mode != "effective":
        rule = "stretches a contact in time, which takes none for a point particle: use 'dry' or 'effective'"
        raise InputError(Defect(rule, file=place, field="contact.mode", value=contact.mode))
    if contact.law is None:
        return Closures(measured=measured_values(case, wake=False), film=edge_of(case))
    try:
        return Closures(rebound=effective_law(case), e_dry=e_dry, film=edge_of(case))
    except InputError as error:
        raise _at(error, place) from None


def release_of_case(case: Case) -> Release:
    """The moment at which the sphere is free."""
    r, d = case.release, case.sphere.diameter
    if r.along:
        rule = "is not in this model, which moves up and down only: use the resolved solver"
        raise InputError(Defect(rule, field="release.along", value=f"{r.along:g}"))
    if r.kind == "rest":
        return Release(r.gap_d * d)
    return Release(r.free_below_d * d, drive=Drive(r.speed, r.ramp, (r.gap_d - r.free_below_d) * d))


def predict(case: Case, file: str = "", closures: Closures | None = None) -> Prediction:
    """The trajectory of a case, with its own closures or others.

    Raises :class:`InputError` for a case that cannot be run, and
    :class:`~restitution.bounce.IntegrationError` where the integration fails.
    """
    closures = closures or closures_of(case, file)
    place, conditions = file or case.name, case.conditions
    try:
        release = release_of_case(case)
        driven = release.drive.duration if release.drive is not None else 0.0
        ends = None if case.run.duration is None else case.run.duration - driven
        if ends is not None and ends <= 0:
            rule = f"ends before the sphere is free: the drive takes {driven:.4g} s"
            raise InputError(Defect(rule, field="run.duration", value=f"{case.run.duration:g}"))
        fall = release.gap / terminal_speed(conditions) + terminal_speed(conditions) / conditions.free_fall
        path = bounce(conditions, release, closures, ends or _LONGEST * fall)
        _check_rows(case, path)
        if case.run.after_contact is not None:
            if not path.impacts and ends is None:
                rule = f"no contact within {_LONGEST * fall:.3g} s, {_LONGEST:g} times the fall: give run.duration"
                raise InputError(Defect(rule, field="run.after_contact", value=f"{case.run.after_contact:g}"))
            if path.impacts:
                end = min(path.impacts[0].time_s + case.run.after_contact, ends or math.inf)
                path = bounce(conditions, release, closures, end)
    except InputError as error:
        raise _at(error, place) from None
    first = path.impacts[0].time_s if path.impacts and case.contact is not None else -driven
    if case.contact is None and path.impacts:
        path = _until(path, path.impacts[0].time_s)
    return Prediction(case, path, release, first)


def _check_rows(case: Case, path: Trajectory) -> None:
    """Refuse a table that nobody could keep."""
    span = (path.impacts[0].time_s if path.impacts else 0.0) + (case.run.after_contact or 0.0)
    for field, seconds in (("run.after_contact", span), ("run.duration", case.run.duration or 0.0)):
        if seconds / row_s(case) > _MOST_ROWS:
            rule = f"gives more than {_MOST_ROWS:.0e} rows {row_s(case):.2g} s apart: fewer seconds"
            raise InputError(Defect(rule, field=field, value=f"{seconds:g}"))


def write(prediction: Prediction, folder: str | Path, seconds: float) -> None:
    """The tables and ``run.json`` into ``folder``, all or none; ``seconds`` is what the prediction took."""
    case, path = prediction.case, prediction.path
    table = prediction.table()
    trajectory, velocity = table[["time_s", "gap_m"]], table[["time_s", "velocity_m_s"]]
    impacts, notes = simulated_impacts(trajectory, case)
    contents = {
        "trajectory.csv": table_text(trajectory),
        "velocity.csv": table_text(velocity),
        "impacts.csv": table_text(impacts),
    }
    record = RunRecord(
        model=POINT_PARTICLE,
        case=case.name,
        title=case.title,
        date=time.strftime("%Y-%m-%d", time.gmtime()),
        finished=True,
        seconds=round(seconds, 3),
        threads=1,
        steps=len(path.time_s) - 1,
        shape=(0, 0, 0),  # no grid
        step_s=_g(np.ptp(path.time_s) / (len(path.time_s) - 1)),  # their mean
        numbers={name: _g(value) for name, value in _numbers(prediction).items()},
        closures=path.closures.describe(),
        contacts=prediction.contacts,
        notes=(*_not_used(case), *notes),
        code_hash=program_hash(),
        filmed=filmed(case),
        case_as_run=case.model_dump(mode="json", exclude_none=True),
        files={name: digest(content) for name, content in contents.items()},
    )
    write_folder(folder, {**contents, FILE: record.text()})


def _numbers(prediction: Prediction) -> dict[str, float]:
    c, path = prediction.case.conditions, prediction.path
    speed = terminal_speed(c)
    Re = c.fluid.density * speed * c.sphere.diameter / c.fluid.viscosity
    found = {"terminal speed, m/s": speed, "terminal Re": Re}
    if path.impacts:
        found["St of the first contact"] = float(StokesNumber.from_speed(path.impacts[0].v_in, c).value)
    return found | ({} if prediction.release.drive is not None else {"energy imbalance": path.imbalance})


def _not_used(case: Case) -> list[str]:
    """What of a case has no say here, where that may matter."""
    found = []
    if case.numerics is not None and case.numerics.sides == "no-slip":
        found.append("the side walls of the box are not in the model")
    return found


def _until(path: Trajectory, end: float) -> Trajectory:
    """The trajectory up to ``end``, a contact, without it."""
    rows = slice(0, int(np.searchsorted(path.time_s, end)) + 1)
    return replace(
        path, time_s=path.time_s[rows], gap_m=path.gap_m[rows], velocity_m_s=path.velocity_m_s[rows],
        energy=path.energy[rows], lost=path.lost[rows], impacts=[],
    )  # fmt: skip


def _at(error: InputError, file: str) -> InputError:
    """What the model finds wrong, by file and in the words of the case."""
    return InputError(*(replace(d, file=file, field=_FIELDS.get(d.field, d.field)) for d in error.defects))


def _g(value: float) -> float:
    return float(f"{value:.6g}")
