"""Saving and restoring a simulation: one HDF5 file, written aside, then renamed.

The restored run continues bit for bit, with the same number of threads or another. Functions of time (force,
faces) are not compared: the simulation that continues must have been given the same ones. Bodies say themselves
what decides their motion, functions included.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from lbm import arguments
from lbm.arguments import shown
from lbm.bodies import body as bodies
from lbm.errors import InputError
from lbm.faces import records as boundaries
from lbm.io.files import write_aside
from lbm.rates import Rates

if TYPE_CHECKING:
    from lbm.simulation import Simulation

__all__ = ["FORMAT", "VERSION", "Saved", "read", "save"]

FORMAT = "lbm checkpoint"
VERSION = 3
_ROUND_OFF = 1e-12


def save(simulation: Simulation, path: Path | str) -> None:
    """Write ``simulation`` to ``path``; on failure the file that was there is left as it was."""
    with write_aside(path) as file:
        file.attrs["format"] = FORMAT
        file.attrs["version"] = VERSION
        file.attrs["steps"] = simulation.steps
        file.attrs["parity"] = simulation.lattice.parity
        file.create_dataset("description", data=json.dumps(_describe(simulation)))  # too long for an attribute
        _put(file, "slots", simulation.lattice.slots())
        for index, body in enumerate(simulation.bodies):
            for name, value in bodies.state(body).items():
                _put(file, f"body/{index}/{name}", value)


def _put(file: h5py.File, name: str, value: np.ndarray) -> None:
    """With a check sum, which HDF5 has for what is not empty and not a single number."""
    file.create_dataset(name, data=value, **({"fletcher32": True} if value.ndim and value.size else {}))


@dataclass(frozen=True)
class Saved:
    """The state in a file: populations, time, and the states of the bodies in their order."""

    slots: np.ndarray
    parity: int
    steps: int
    states: list[dict[str, np.ndarray]]


def read(simulation: Simulation, path: Path | str) -> Saved:
    """The state saved in ``path`` by a simulation with the same grid, precision, flow and bodies as this one.

    Raises :class:`InputError` for a file that is truncated, of another version or of another simulation.
    """
    path = arguments.path("checkpoint", path)
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise InputError(f"{path}: not an lbm checkpoint")
            if file.attrs["version"] != VERSION:
                raise InputError(
                    f"{path}: checkpoint of version {file.attrs['version']}, this program reads {VERSION}; "
                    "start anew or use the program that wrote it"
                )
            saved, own = json.loads(file["description"][()]), json.loads(json.dumps(_describe(simulation)))
            for where, then, now in _differences(saved, own):
                raise InputError(f"{path}: saved with {where} = {shown(then)}, this simulation has {shown(now)}")
            slots = file["slots"][...]
            steps, parity = int(file.attrs["steps"]), int(file.attrs["parity"])
            states = [
                {name: file[f"body/{index}/{name}"][...] for name in bodies.state(body)}
                for index, body in enumerate(simulation.bodies)
            ]
    except FileNotFoundError:
        raise InputError(f"{path}: no such checkpoint") from None
    except (PermissionError, IsADirectoryError) as error:
        raise InputError(f"{path}: may not be read ({error.strerror})") from error
    except (OSError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        if not _is_file(path):
            raise InputError(f"{shown(str(path))}: no such checkpoint") from None
        raise InputError(f"{path}: damaged or truncated checkpoint ({error}); use an earlier one") from error
    own_slots = simulation.lattice.slots()
    if slots.shape != own_slots.shape or slots.dtype != own_slots.dtype or steps < 0 or parity not in (0, 1):
        raise InputError(f"{path}: damaged checkpoint ({slots.shape}, step {steps}); use an earlier one")
    if not np.isfinite(slots).all():
        raise InputError(f"{path}: holds values that are not finite; use an earlier one")
    return Saved(slots, parity, steps, states)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for the file system
        return False


def _differences(saved, own, where: str = "") -> Iterator[tuple[str, object, object]]:
    """Place and both values of every entry that differs."""
    if isinstance(saved, dict) and isinstance(own, dict):
        for name in sorted(saved.keys() | own.keys()):
            yield from _differences(saved.get(name), own.get(name), f"{where}.{name}" if where else name)
    elif isinstance(saved, list) and isinstance(own, list) and where == "bodies" and len(saved) == len(own):
        for index, (then, now) in enumerate(zip(saved, own, strict=True)):
            yield from _differences(then, now, f"{where}[{index}]")
    elif not _agree(saved, own):
        yield where, saved, own


def _agree(saved, own) -> bool:
    """Whether two entries are equal, numbers up to the round-off with which a function may give them."""
    if isinstance(saved, list) and isinstance(own, list):
        return len(saved) == len(own) and all(_agree(then, now) for then, now in zip(saved, own, strict=True))
    if isinstance(saved, float) and isinstance(own, float):
        return math.isclose(saved, own, rel_tol=_ROUND_OFF)
    return saved == own


def _describe(simulation: Simulation) -> dict:
    """What must agree for a restart, in JSON's terms."""
    return {
        "shape": list(simulation.shape),
        "dtype": simulation.dtype.name,
        "rates": {name: getattr(simulation.rates, name) for name in Rates.__dataclass_fields__},
        "force": _plain(simulation.given_force),
        "faces": {
            name: {"kind": type(face).__name__, **{key: _plain(value) for key, value in vars(face).items()}}
            for name, face in zip(boundaries.FACES, simulation.faces, strict=True)
        },
        "bodies": [bodies.description(body) for body in simulation.bodies],
    }


def _plain(value):
    """A number, vector or None in JSON's terms; of an array its hash, of a function that it is one."""
    if value is None or callable(value):
        return None if value is None else "function of time"
    value = np.asarray(value, dtype=float)
    if value.size > 3:
        return f"array {value.shape}, SHA-256 {hashlib.sha256(value.tobytes()).hexdigest()[:16]}"
    return value.tolist()
