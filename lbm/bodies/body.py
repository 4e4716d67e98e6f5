"""What may be put into the fluid: the protocol of :meth:`lbm.Simulation.add`.

A body changes the populations near its surface after every step. It finds them by
:func:`lbm.fluid.lattice.incoming` and :func:`lbm.fluid.lattice.outgoing`.
"""

from __future__ import annotations

import json
from abc import abstractmethod
from typing import Protocol, runtime_checkable

import numpy as np

from lbm.arguments import shown
from lbm.errors import InputError
from lbm.fluid.lattice import Lattice

__all__ = ["Body", "attach", "description", "state"]


@runtime_checkable
class Body(Protocol):
    """Called after every step; says what a restart must find again.

    A body is derived from this class, or has all of its methods. What nothing of changes in time needs only
    ``__call__`` and ``describe`` of its own, and :meth:`reach` for speed.
    """

    @abstractmethod
    def __call__(self, lattice: Lattice, step: int, force: tuple[float, float, float] | None) -> None:
        """Change populations of ``lattice`` after step number ``step`` (from 0), made with ``force``.

        An error raised here leaves a half-done step; what can fail belongs into :meth:`prepare`.
        """

    @abstractmethod
    def describe(self) -> dict:
        """What must agree at a restart, in JSON's terms: numbers, strings, lists and dictionaries."""

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Called when the body is added and before every step, when an error leaves the flow as it was.

        Two steps that are made at once (:meth:`reach`) are both prepared before the first.
        """
        return

    def reach(self, lattice: Lattice) -> np.ndarray | None:
        """Numbers of the planes z in which the next call may read or change populations; None: in any of them.

        Where all bodies know it, the flow far from them makes two steps while its populations are in the cache.
        """
        return None

    def state(self) -> dict[str, np.ndarray]:
        """What changes in time, as arrays of numbers; a checkpoint keeps them bit for bit."""
        return {}

    def set_state(self, state: dict[str, np.ndarray]) -> None:
        """Continue from what :meth:`state` gave."""
        return


def attach(body: Body, lattice: Lattice, step: int) -> None:
    """Prepare ``body`` for ``lattice``; :class:`InputError` for what does not keep to the protocol."""
    if isinstance(body, type):
        raise InputError(f"{shown(body)}: a class; give a body, {body.__name__}(...)")
    if not isinstance(body, Body):
        raise InputError(f"{shown(body)}: no body; give an object of a class derived from lbm.Body")
    body.prepare(lattice, step)
    description(body)
    state(body)


def description(body: Body) -> dict:
    """``describe()`` and the kind of the body, as JSON gives them back."""
    entries = body.describe()
    try:
        return {"kind": type(body).__name__, **json.loads(json.dumps(entries))}
    except (TypeError, ValueError) as error:
        raise InputError(f"{type(body).__name__}.describe(): not in JSON's terms ({error})") from None


def state(body: Body) -> dict[str, np.ndarray]:
    """``state()`` as arrays."""
    arrays = {name: np.asarray(value) for name, value in body.state().items()}
    for name, value in arrays.items():
        if value.dtype.kind not in "biufc" or not name or "/" in name:
            raise InputError(f"{type(body).__name__}.state(): {name!r} is no array of numbers with a plain name")
    return arrays
