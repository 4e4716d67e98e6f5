"""Saving and restoring a simulation: one HDF5 file, written aside, then renamed.

The restored run continues bit for bit, with the same number of threads or another.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from lbm import faces as boundaries
from lbm.errors import InputError
from lbm.files import write_aside
from lbm.rates import Rates

if TYPE_CHECKING:
    from lbm.simulation import Simulation

FORMAT = "lbm checkpoint"
VERSION = 1


def save(simulation: Simulation, path: Path | str) -> None:
    """Write ``simulation`` to ``path``; on failure the file that was there is left as it was."""
    with write_aside(path) as file:
        file.attrs["format"] = FORMAT
        file.attrs["version"] = VERSION
        file.attrs["steps"] = simulation.steps
        file.attrs["parity"] = simulation.lattice.parity
        file.attrs["description"] = json.dumps(_describe(simulation))
        file.create_dataset("slots", data=simulation.lattice.slots(), fletcher32=True)


def restore(simulation: Simulation, path: Path | str) -> None:
    """Put the state saved in ``path`` into ``simulation``, which must have the same grid, precision and flow.

    Raises :class:`InputError` for a file that is truncated, of another version or of another simulation.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such checkpoint")
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise InputError(f"{path}: not an lbm checkpoint")
            if file.attrs["version"] != VERSION:
                raise InputError(
                    f"{path}: checkpoint of version {file.attrs['version']}, this program reads {VERSION}; "
                    "start anew or use the program that wrote it"
                )
            saved, own = json.loads(file.attrs["description"]), _describe(simulation)
            for name, value in own.items():
                if saved.get(name) != value:
                    raise InputError(f"{path}: saved with {name} = {saved.get(name)}, this simulation has {value}")
            slots = file["slots"][...]
            steps, parity = int(file.attrs["steps"]), int(file.attrs["parity"])
    except PermissionError as error:
        raise InputError(f"{path}: may not be read ({error.strerror})") from error
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        raise InputError(f"{path}: damaged or truncated checkpoint ({error}); use an earlier one") from error
    own_slots = simulation.lattice.slots()
    if slots.shape != own_slots.shape or slots.dtype != own_slots.dtype or steps < 0 or parity not in (0, 1):
        raise InputError(f"{path}: damaged checkpoint ({slots.shape}, step {steps}); use an earlier one")
    if not np.isfinite(slots).all():
        raise InputError(f"{path}: holds values that are not finite; use an earlier one")
    own_slots[...] = slots
    simulation.lattice.parity, simulation.steps = parity, steps


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
    }


def _plain(value):
    """A number, vector or None in JSON's terms; of a function no more than that it is one."""
    if value is None or callable(value):
        return None if value is None else "function of time"
    return np.asarray(value, dtype=float).tolist()
