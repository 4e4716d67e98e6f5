"""The vorticity about the sphere in the middle plane, kept at three moments of the first impact."""

from __future__ import annotations

import io
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError
from restitution.inputs import read_bytes

if TYPE_CHECKING:
    from restitution.runs.resolved import ResolvedRun

MOMENTS = ("before", "at", "after")
BEFORE_D, AFTER_D = 0.5, 1.0
"""Gaps in diameters: on the way in, and on the way out after the first impact."""
_DAMAGED = (OSError, EOFError, BadZipFile, zlib.error, KeyError, ValueError, TypeError, AttributeError)
"""What NumPy makes of an archive that is none."""
MOST_BYTES = 2**26
"""Of a file of pictures."""
HALF_WIDTH_D, HEIGHT_D = 1.5, 4.0
"""What a picture shows, in diameters from the axis and above the wall."""


@dataclass(frozen=True)
class Frame:
    """``vorticity`` in 1/s on points ``x_d``, ``z_d``: diameters from axis and wall."""

    vorticity: NDArray
    x_d: NDArray
    z_d: NDArray
    gap_d: float
    time_s: float
    """After the first contact; before it, time to the wall at the speed then, negative."""


@dataclass
class FlowFrames:
    """The frames so far, by moment."""

    frames: dict[str, Frame] = field(default_factory=dict)

    def look(self, run: ResolvedRun) -> None:
        """Take a frame if its moment has come."""
        moment = self._moment(run)
        if moment is None:
            return
        cells = run.flow.length
        curl = run.vorticity()
        x = (np.arange(curl.shape[0]) + 0.5 - curl.shape[0] / 2) / cells
        z = (np.arange(curl.shape[1]) + 0.5) / cells
        near_x, near_z = np.abs(x) <= HALF_WIDTH_D, z <= HEIGHT_D
        if run.contacts:
            time = run.time_s - run.contacts[0].time_s
        else:
            speed = -float(run.spheres.velocities[0, 2])
            time = -run.gap_d * cells / speed * run.step_s
        self.frames[moment] = Frame(curl[np.ix_(near_x, near_z)], x[near_x], z[near_z], float(run.gap_d), time)

    def _moment(self, run: ResolvedRun) -> str | None:
        if not run.contacts:
            return "before" if run.gap_d < BEFORE_D and "before" not in self.frames else None
        if "at" not in self.frames:
            return "at"
        first_flight = len(run.contacts) == 1 and run.gap_d > AFTER_D
        return "after" if first_flight and "after" not in self.frames else None

    def arrays(self) -> dict[str, NDArray]:
        """All frames as arrays by name."""
        arrays = {}
        for moment, f in self.frames.items():
            arrays[f"{moment}_vorticity"] = f.vorticity.astype(np.float32)
            arrays[f"{moment}_x_d"], arrays[f"{moment}_z_d"] = f.x_d, f.z_d
            arrays[f"{moment}_scalars"] = np.array([f.gap_d, f.time_s])
        return arrays

    def take(self, arrays: Mapping[str, NDArray]) -> None:
        """Take the frames that :meth:`arrays` gave; raises :class:`ValueError` for what they are not."""
        for moment in MOMENTS:
            if f"{moment}_vorticity" not in arrays:
                continue
            names = ("vorticity", "x_d", "z_d", "scalars")
            vorticity, x_d, z_d, scalars = (np.asarray(arrays[f"{moment}_{name}"]) for name in names)
            if vorticity.shape != (len(x_d), len(z_d)) or scalars.shape != (2,):
                raise ValueError(f"{moment} the impact: {vorticity.shape} values on other points")
            self.frames[moment] = Frame(vorticity, x_d, z_d, *map(float, scalars))

    def as_bytes(self) -> bytes:
        """As a compressed NumPy archive."""
        content = io.BytesIO()
        np.savez_compressed(content, **self.arrays())
        return content.getvalue()

    def read(self, path: Path) -> None:
        """Take the frames of a file, if there is one; raises :class:`InputError` where it is damaged."""
        if not path.is_file():
            return
        try:
            with np.load(io.BytesIO(read_bytes(path, MOST_BYTES))) as kept:
                self.take(kept)
        except InputError:
            raise
        except _DAMAGED:
            rule = "is damaged: no pictures of a flow can be read from it"
            raise InputError(Defect(rule, file=str(path))) from None
