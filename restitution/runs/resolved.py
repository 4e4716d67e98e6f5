"""The resolved solver on a case: the only place where ``restitution`` meets ``lbm``.

A case becomes lattice units, the closure laws become the plain callables that :mod:`lbm.spheres.film` and
:mod:`lbm.spheres.contact` take, and what the solver recorded comes back in SI, time counted from the first
contact.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import lbm
from lbm.faces.records import AXES
from lbm.fluid import cache
from lbm.fluid.fields import with_image
from lbm.io import checkpoint as lbm_checkpoint
from lbm.observers import DivergenceGuard, FieldOutput
from lbm.spheres import SphereImpact
from restitution.cases.case import Case
from restitution.errors import Defect, DivergedError, InputError, StoppedError
from restitution.runs.record import SolverContact
from restitution.runs.setup import check_edge, fall_time, set_up

if TYPE_CHECKING:
    import pandas as pd

_LONGEST = 4.0
"""A run without contact is given up after this many times the fall at the reference speed."""
_LONGEST_RUN = 100
_NEAR_D = 0.5
_MOST_STEPS = 1e7
"""Of a span that is asked for: each is a row of ``motion.csv``, which is kept whole."""
_STOP = "stop"


class ResolvedRun:
    """A case on the lattice; :meth:`advance` until :attr:`finished`, and read in between."""

    def __init__(self, case: Case, file: str = ""):
        if case.numerics is None:
            raise InputError(
                Defect("is missing: the resolved solver needs it", file=file or case.name, field="numerics")
            )
        self.case = case
        self.warnings: list[str] = []
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", lbm.OutsideRangeWarning)
            try:
                self.setup = set_up(case, file)
                self.simulation, self.spheres = self.setup.build()
            except lbm.InputError as error:
                raise InputError(Defect(str(error), file=file or case.name, field="numerics")) from None
        self.flow = self.setup.flow
        check_edge(self.setup, file or case.name)
        self._check_span(file or case.name)
        self.warnings += [str(w.message) for w in caught]
        self.guard = DivergenceGuard()
        self._unguarded = 0
        self._stop = 0
        """The step at which the run is looked at next, which an interrupt does not change."""

    def _check_span(self, file: str) -> None:
        """Refuse a run that nobody could keep, nor wait for."""
        for name in ("after_contact", "duration"):
            seconds = getattr(self.case.run, name)
            if seconds is not None and seconds / self.step_s > _MOST_STEPS:
                rule = f"is more than {_MOST_STEPS:.0e} steps of {self.step_s:.2g} s: fewer seconds"
                raise InputError(Defect(rule, file=file, field=f"run.{name}", value=f"{seconds:g}"))

    @property
    def step_s(self) -> float:
        """One time step in s."""
        return self.flow.scales.step_s

    @property
    def cells(self) -> int:
        """Cells of the box."""
        return int(np.prod(self.simulation.shape))

    @property
    def time_s(self) -> float:
        """Time since the release."""
        return self.simulation.steps * self.step_s

    @property
    def gap_d(self) -> float:
        """Gap now, in diameters."""
        return float(self.spheres.centres[0, 2] - self.spheres.radii[0]) / self.flow.length

    def in_d(self, cells: float, steps: float) -> float:
        """So many cells and the way of so many steps, at least at the reference speed, in diameters."""
        speed = max(-float(self.spheres.velocities[0, 2]), self.flow.speed)
        return (cells + steps * speed) / self.flow.length

    @property
    def _impacts(self) -> list[SphereImpact]:
        """Those at the floor; a slanting way may meet the sides too."""
        return [i for i in self.spheres.impacts if i.face == "z-"]

    @property
    def notes(self) -> list[str]:
        """What the motion has beside that above one wall."""
        first = {i.face: i for i in reversed(self.spheres.impacts) if i.face != "z-"}
        return [
            f"the sphere met the wall {face} {i.step * self.step_s:.4g} s after its release: from there on this "
            "is not the motion above one wall; a wider box, or a shorter run, has none of it"
            for face, i in first.items()
        ]

    @property
    def contacts(self) -> list[SolverContact]:
        """The contacts with the floor so far."""
        speed = self.flow.scales.unit("velocity")
        return [
            SolverContact(
                time_s=float(i.step) * self.step_s,
                speed_in_m_s=float(i.speed_in * speed),
                speed_out_m_s=float(i.speed_out * speed),
            )
            for i in self._impacts
        ]

    @property
    def expected_s(self) -> float:
        """About how long the run is going to be, in s since the release."""
        span, found = self.case.run, self.contacts
        if span.after_contact is None:
            return span.duration or self._longest
        first = found[0].time_s if found else max(fall_time(self.case), self.time_s)  # it may sink slower
        return min(first + span.after_contact, span.duration or math.inf)

    @property
    def is_due(self) -> bool:
        """Whether the run has come to the end of an :meth:`advance`, where it is to be looked at."""
        return self.simulation.steps == self._stop

    @property
    def gave_up(self) -> bool:
        """Whether the sphere has not met the wall in the time that it was given for that."""
        span = self.case.run
        waits = span.duration is None and not self.contacts
        above = self.gap_d * self.case.sphere.diameter > (self.case.floor or 0.0)
        return waits and above and self.time_s >= self._longest

    @property
    def finished(self) -> bool:
        """Whether the span of the case is over, or the run :attr:`gave_up`."""
        span, found, now = self.case.run, self.contacts, self.time_s
        if span.duration is not None and now >= span.duration:
            return True
        if self.case.contact is None and self.gap_d * self.case.sphere.diameter <= (self.case.floor or 0.0):
            return True
        if span.after_contact is not None and found:
            return now >= found[0].time_s + span.after_contact
        return now >= self._longest

    def _left(self) -> int:
        """Steps to the end of the span, as far as it is known by now; at least one."""
        span, found = self.case.run, self.contacts
        ends = [span.duration, found[0].time_s + span.after_contact if found and span.after_contact else None]
        end = min((e for e in ends if e is not None), default=math.inf)
        return max(1, math.ceil(min((end - self.time_s) / self.step_s, _LONGEST_RUN)))

    @property
    def _longest(self) -> float:
        return _LONGEST * fall_time(self.case)

    def advance(self, observers: tuple = ()) -> None:
        """Advance by up to a hundred steps, fewer as the first contact nears, so that its moment is not missed.

        Where that was interrupted, go on to the step that was chosen then. Raises :class:`StoppedError` for a run
        that diverges or cannot write.
        """
        if self.simulation.steps >= self._stop:
            self._stop = self.simulation.steps + self._steps_to_look()
        steps = self._stop - self.simulation.steps
        due = self._unguarded + steps >= _LONGEST_RUN
        with _in_our_words():
            self.simulation.run(steps, observers, guard=self.guard if due else None)
        self._unguarded = 0 if due else self._unguarded + steps

    def _steps_to_look(self) -> int:
        steps = _LONGEST_RUN
        if not math.isfinite(self.gap_d):
            self.check()  # names the cell, if the flow is to blame
            raise DivergedError(f"diverged by step {self.simulation.steps}: the sphere is nowhere")
        if not self._impacts:
            least = 1.0 if self.gap_d > _NEAR_D else 0.1  # a sphere that has just been released gains speed
            speed = max(-float(self.spheres.velocities[0, 2]), least * self.flow.speed)
            steps = int(min(max(0.5 * self.gap_d * self.flow.length / speed, 1), steps))
        return min(steps, self._left())

    def check(self) -> None:
        """Raise :class:`StoppedError` if the flow has diverged."""
        with _in_our_words():
            self.guard(self.simulation)

    def save(self, path: Path, owner: str, beside: Mapping[str, np.ndarray]) -> None:
        """Write a checkpoint of the run ``owner``; raises :class:`StoppedError` where that cannot be."""
        with _in_our_words():
            self.simulation.save(path, owner, {_STOP: np.array([self._stop, self._unguarded]), **beside})

    def restore(self, path: Path, owner: str) -> dict[str, np.ndarray]:
        """Continue from a checkpoint; what was saved beside. Raises :class:`InputError` for one of another run."""
        with _in_our_words():
            beside = self.simulation.restore(path, owner)
        if _STOP not in beside:
            raise InputError(Defect("is no checkpoint of a run", file=str(path)))
        self._stop, self._unguarded = map(int, beside.pop(_STOP))
        return beside

    def leave_walls_out(self) -> None:
        """Begin without film and contact, as an approach that several cases share does."""
        self.simulation, self.spheres = replace(self.setup, film=None, contact=None).build()

    def fork(self, path: Path, approach: str) -> dict[str, np.ndarray]:
        """Begin from the checkpoint of an ``approach``; what was saved beside.

        Raises :class:`InputError` for one of another approach, or one in which film or contact of this case would
        have acted.
        """
        self.leave_walls_out()
        beside = self.restore(path, approach)
        with _in_our_words():
            self.spheres.take_film_and_contact(self.setup.film, self.setup.contact, self.simulation.lattice.grid)
        return beside

    def snapshots(self, folder: Path) -> FieldOutput:
        """An observer that writes the flow for ParaView."""
        interval = self.case.run.snapshot_interval
        steps = _LONGEST_RUN if interval is None else max(1, round(interval / self.step_s))
        return FieldOutput(steps, folder, self.case.name, self.flow.scales, self.setup.mirrors)

    def motion(self) -> pd.DataFrame:
        """Every step so far in SI: ``time_s``, ``gap_m``, position, velocity, spin, force and torque of the fluid.

        Time is counted from the first contact, or from the release where there is none; velocities are positive
        away from the wall (z).
        """
        import pandas as pd

        track, si = self.spheres.track(0), self.flow.scales.si
        first = self._impacts[0].step if self._impacts else 0.0
        kinds = {
            "gap": ("gap_m", "length"), "v": ("v{}_m_s", "velocity"), "w": ("spin_{}_1_s", "frequency"),
            "f": ("force_{}_N", "force"), "t": ("torque_{}_N_m", "torque"),
        }  # fmt: skip
        table = {"time_s": (track["step"] - first) * self.step_s}
        table["gap_m"] = si(track["z"] - self.spheres.radii[0], "length")
        table |= {f"{axis}_m": si(track[axis], "length") for axis in "xyz"}
        for letter in "vwft":
            name, quantity = kinds[letter]
            table |= {name.format(axis): si(track[letter + axis], quantity) for axis in "xyz"}
        return pd.DataFrame(table)

    def vorticity(self) -> np.ndarray:
        """Vorticity about y in 1/s in the plane through the middle of the whole box, (nx, nz).

        By central differences; inside the sphere the velocity is the sphere's own.
        """
        u = self.simulation.velocity
        for axis in map(AXES.index, self.setup.mirrors):
            u = with_image(u, axis)
        middle = u.shape[2] // 2
        along, up = u[0, :, middle, :].astype(float), u[2, :, middle, :].astype(float)
        centre, r = self.spheres.centres[0], self.spheres.radii[0]
        x, z = (np.arange(n) + 0.5 for n in along.shape)
        if "x" in self.setup.mirrors:
            x -= self.simulation.shape[0]
        inside = (x[:, None] - centre[0]) ** 2 + (z[None, :] - centre[2]) ** 2 < r**2
        along[inside], up[inside] = self.spheres.velocities[0, [0, 2]]
        curl = np.gradient(along, axis=1) - np.gradient(up, axis=0)
        return self.flow.scales.si(curl, "frequency")


def kernel_folder() -> Path | None:
    """Where the compiled kernels of this version of the solver are kept; None where they cannot be."""
    return cache.own_directory()


@contextmanager
def _in_our_words() -> Iterator[None]:
    """The solver's errors as this package's."""
    try:
        yield
    except lbm.InputError as error:
        raise InputError(str(error)) from None
    except lbm.DivergenceError as error:
        raise DivergedError(str(error)) from None
    except lbm.OutputError as error:
        raise StoppedError(str(error)) from None


def owner_of(checkpoint: Path) -> str | None:
    """Which run a checkpoint is of; None where there is none that can be read."""
    try:
        return lbm_checkpoint.described(checkpoint).get("owner")
    except (lbm.InputError, AttributeError):
        return None
