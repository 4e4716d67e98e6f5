"""What may be put into the fluid: the protocol of :meth:`lbm.Simulation.add`.

A body changes the populations near its surface after every step. It finds them by
:func:`lbm.fluid.lattice.incoming` and :func:`lbm.fluid.lattice.outgoing`.
"""

from __future__ import annotations

import json
from typing import Protocol

import numpy as np

from lbm.arguments import shown
from lbm.errors import InputError
from lbm.fluid.lattice import Lattice

__all__ = ["Body", "attach", "description", "set_state", "state"]


class Body(Protocol):
    """Called after every step; says what a restart must find again.

    A class may leave out ``prepare``, and ``state`` with ``set_state`` if nothing of it changes in time. One
    derived from this class gets them as they stand here.
    """

    def __call__(self, lattice: Lattice, step: int, force: tuple[float, float, float] | None) -> None:
        """Change populations of ``lattice`` after step number ``step`` (from 0), made with ``force``.

        An error raised here leaves a half-done step; what can fail belongs into :meth:`prepare`.
        """

    def describe(self) -> dict:
        """What must agree at a restart, in JSON's terms: numbers, strings, lists and dictionaries."""

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Called when the body is added and before every step, when an error leaves the flow as it was."""

    def state(self) -> dict[str, np.ndarray]:
        """What changes in time, as arrays of numbers; a checkpoint keeps them bit for bit."""
        return {}

    def set_state(self, state: dict[str, np.ndarray]) -> None:
        """Continue from what :meth:`state` gave."""


def attach(body: Body, lattice: Lattice, step: int) -> None:
    """Prepare ``body`` for ``lattice``; :class:`InputError` for what does not keep to the protocol."""
    if isinstance(body, type):
        raise InputError(f"{shown(body)}: a class; give a body, {body.__name__}(...)")
    if not callable(body) or not callable(getattr(body, "describe", None)):
        raise InputError(f"{shown(body)}: no body; give a callable object with describe(), see lbm.bodies.Body")
    if hasattr(body, "state") != hasattr(body, "set_state"):
        raise InputError(f"{type(body).__name__}: state and set_state come together")
    if hasattr(body, "prepare"):
        body.prepare(lattice, step)
    description(body)
    state(body)


def description(body: Body) -> dict:
    """``describe()`` and the kind of the body, as JSON gives them back."""
    found = body.describe()
    try:
        return {"kind": type(body).__name__, **json.loads(json.dumps(found))}
    except (TypeError, ValueError) as error:
        raise InputError(f"{type(body).__name__}.describe(): not in JSON's terms ({error})") from None


def state(body: Body) -> dict[str, np.ndarray]:
    """``state()`` as arrays; empty for a body that has none."""
    found = body.state() if hasattr(body, "state") else {}
    arrays = {name: np.asarray(value) for name, value in found.items()}
    for name, value in arrays.items():
        if value.dtype.kind not in "biufc" or not name or "/" in name:
            raise InputError(f"{type(body).__name__}.state(): {name!r} is no array of numbers with a plain name")
    return arrays


def set_state(body: Body, saved: dict[str, np.ndarray]) -> None:
    """Hand ``saved`` to the body, if it has a state."""
    if hasattr(body, "set_state"):
        body.set_state(saved)
