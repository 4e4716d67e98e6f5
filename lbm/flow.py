"""A flow in a box: what it is, at one moment. How it goes on is for :mod:`lbm.simulation`."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from operator import attrgetter
from pathlib import Path

import numpy as np

from lbm import arguments
from lbm.bodies import body as bodies
from lbm.bodies.body import Body
from lbm.errors import InputError
from lbm.faces.records import FACES, Face, Periodic, resolve
from lbm.fluid import fields
from lbm.fluid.lattice import Lattice
from lbm.io import checkpoint
from lbm.io.interrupt import interrupts_deferred
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace

__all__ = ["Flow", "Force"]

_BESIDE = "beside/"
Force = Sequence[float] | Callable[[float], Sequence[float]]


class Flow:
    """Fluid of rest density 1 in a box, with its faces and the bodies in it; :class:`lbm.Simulation` advances it.

    Observers are called with it.

    Parameters
    ----------
    shape : (nx, ny, nz), cells along x, y, z, at least 4 each.
    rates : relaxation rates, which set the viscosity; see :class:`lbm.Rates` and :class:`lbm.RatesByPlace`.
    faces : boundary by face ("x-", "x+", ...) or axis ("x", "y", "z"); see :mod:`lbm.faces`.
    force : force density, 3 components, or a function of time giving them; may be exchanged as ``given_force``.
    dtype : float64 or float32.
    viscosity : in place of ``rates``, for :meth:`lbm.Rates.balanced` of it.

    Raises
    ------
    InputError
        For arguments that cannot be used.
    """

    shape: tuple[int, int, int] = property(attrgetter("_shape"), doc="Cells along x, y, z.")
    dtype: np.dtype = property(attrgetter("_dtype"), doc="Precision of the populations.")
    rates: Rates | RatesByPlace = property(
        attrgetter("_rates"), doc="Relaxation rates, fixed for the life of the flow."
    )
    faces: tuple[Face, ...] = property(attrgetter("_faces"), doc="Boundaries in the order x-, x+, y-, ..., z+.")
    steps: int = property(attrgetter("_steps"), doc="Steps made since the start of the flow: the time.")
    bodies: tuple[Body, ...] = property(attrgetter("_bodies"), doc="What :meth:`add` has put into the fluid.")

    def __init__(
        self,
        shape: tuple[int, int, int],
        rates: Rates | RatesByPlace | None = None,
        *,
        faces: dict[str, Face | str] | None = None,
        force: Force | None = None,
        dtype: str | type | np.dtype = np.float64,
        viscosity: float | None = None,
    ):
        self._dtype = arguments.precision(dtype)
        self._shape = arguments.box(shape, self._dtype.itemsize)
        self._rates, self._faces = _rates(rates, viscosity), resolve(faces)
        self.given_force = force
        try:
            self.lattice = Lattice(self._shape, tuple(f.kind for f in self._faces), self._dtype)
        except MemoryError:
            raise arguments.too_large(self._shape, self._dtype.itemsize) from None
        self._bodies: tuple[Body, ...] = ()
        self._steps = 0
        self.warned_of_grid_reynolds = False
        self._running = self._half_done = False
        self._saw_start: list = []  # observers that have been shown this flow at its start
        if any(self._force_at(0.0) or ()):
            self.set_flow()  # without a force, the populations of a new lattice are those of rest

    @property
    def force(self) -> tuple[float, float, float] | None:
        """Force density now."""
        return self._force_at(float(self.steps))

    def _force_at(self, when: float) -> tuple[float, float, float] | None:
        return arguments.force(self.given_force, when)

    def add(self, body: Body) -> None:
        """Put ``body`` into the fluid: :class:`lbm.FixedBody`, or another one derived from :class:`lbm.Body`.

        After every step bodies act in the order in which they were added. A checkpoint holds their states and
        is refused by a flow with other ones.

        Raises
        ------
        InputError
            For what is no body, does not fit the box, or is in the flow already.
        """
        self._refuse_within_run("add")
        if any(body is other for other in self._bodies):
            raise InputError(f"{arguments.shown(body)}: is in this simulation already")
        bodies.attach(body, self.lattice, self.steps)
        self._bodies += (body,)

    def set_flow(self, density=1.0, velocity=(0.0, 0.0, 0.0)) -> None:
        """Start from a density and a velocity.

        Resets the count of steps; bodies stay as they are. Velocity gradients enter the non-equilibrium, so the
        start is smooth.

        Parameters
        ----------
        density : number or (nx, ny, nz)
            Near 1.
        velocity : (3,) or (3, nx, ny, nz)
            In cells a step.

        Raises
        ------
        InputError
            For fields of another shape, that are not finite or out of the method's range; the flow is then as it
            was.
        """
        self._refuse_within_run("set_flow")
        rho = arguments.field("density", density, (), self.shape)
        u = arguments.field("velocity", velocity, (3,), (3, *self.shape))
        arguments.density("density", rho)
        arguments.speed("velocity", u, 0)
        periodic = tuple(isinstance(self.faces[2 * axis], Periodic) for axis in range(3))
        force = self._force_at(0.0)
        with interrupts_deferred(), self._changing():
            fields.write(self.lattice, rho, u, force, self.rates.viscosity, periodic)
            self._steps, self._saw_start = 0, []

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Density (nx, ny, nz) and velocity (3, nx, ny, nz), copies."""
        self._refuse_half_done()
        return fields.read(self.lattice, self.force)

    @property
    def density(self) -> np.ndarray:
        """Density, shape (nx, ny, nz)."""
        return self.fields()[0]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity, shape (3, nx, ny, nz)."""
        return self.fields()[1]

    @property
    def bytes_per_cell(self) -> float:
        """Memory of the populations, pads included."""
        return self.lattice.populations.nbytes / math.prod(self.shape)

    def describe(self) -> dict:
        """What must agree for a restart, in JSON's terms; of functions of time no more than that they are such."""
        return {
            "shape": list(self.shape),
            "dtype": self.dtype.name,
            "rates": asdict(self.rates),
            "force": _plain(self.given_force),
            "faces": {
                name: {"kind": type(face).__name__, **{key: _plain(value) for key, value in vars(face).items()}}
                for name, face in zip(FACES, self.faces, strict=True)
            },
            "bodies": [bodies.description(body) for body in self.bodies],
        }

    def save(self, path: Path | str, owner: str = "", beside: Mapping[str, np.ndarray] | None = None) -> None:
        """Write a checkpoint.

        Parameters
        ----------
        path : path
        owner : str
            Whose it is; :meth:`restore` refuses it to another.
        beside : mapping
            Further arrays by name, which the caller wants to find again.

        Raises
        ------
        OutputError
            If that fails; a file that was at ``path`` is then still there, unchanged.
        """
        self._refuse_half_done()
        arrays = {"slots": self.lattice.slots(), **self._body_states()}
        arrays |= {f"{_BESIDE}{name}": np.asarray(array) for name, array in (beside or {}).items()}
        numbers = {"steps": self.steps, "parity": self.lattice.parity}
        checkpoint.save(path, {"owner": owner, **self.describe()}, numbers, arrays)

    def restore(self, path: Path | str, owner: str = "") -> dict[str, np.ndarray]:
        """Continue from a checkpoint of a flow set up like this one, bit for bit.

        Functions of time (force, faces) are not compared: they must be the same ones.

        Returns
        -------
        The arrays that were saved ``beside`` the flow.

        Raises
        ------
        InputError
            For a file that is damaged, of another version or of another flow; nothing is then changed.
        """
        self._refuse_within_run("restore")
        with interrupts_deferred():
            own = {"slots": self.lattice.slots()}
            description = {"owner": owner, **self.describe()}
            numbers, arrays = checkpoint.read(path, description, ("steps", "parity"), own, ("body/", _BESIDE))
            beside = {n.removeprefix(_BESIDE): arrays.pop(n) for n in [*arrays] if n.startswith(_BESIDE)}
            if {"slots", *self._body_states()} != arrays.keys():
                raise InputError(f"{path}: damaged checkpoint: not all of the flow is in it; use an earlier one")
            slots = arrays.pop("slots")
            self._check(path, slots, numbers)
            with self._changing():
                self.lattice.slots()[...] = slots
                self.lattice.parity, self._steps = numbers["parity"], numbers["steps"]
                for index, body in enumerate(self.bodies):
                    prefix = _place(index, "")
                    self._restore_body(
                        path, body, {n.removeprefix(prefix): a for n, a in arrays.items() if n.startswith(prefix)}
                    )
                self._saw_start = []
            return beside

    def _restore_body(self, path: Path | str, body: Body, state: dict[str, np.ndarray]) -> None:
        try:
            body.set_state(state)
        except (ValueError, TypeError, KeyError, IndexError) as error:
            raise InputError(
                f"{path}: damaged checkpoint: the state of a body ({error}); use an earlier one"
            ) from None

    def _check(self, path: Path | str, slots: np.ndarray, numbers: dict[str, int]) -> None:
        if numbers["steps"] < 0 or numbers["parity"] not in (0, 1):
            raise InputError(f"{path}: damaged checkpoint (step {numbers['steps']}); use an earlier one")
        if not np.isfinite(slots).all():
            raise InputError(f"{path}: holds values that are not finite; use an earlier one")

    def _body_states(self) -> dict[str, np.ndarray]:
        return {
            _place(index, name): value
            for index, body in enumerate(self.bodies)
            for name, value in bodies.state(body).items()
        }

    @contextmanager
    def _changing(self) -> Iterator[None]:
        """Within it the flow is half changed; if that fails, so it stays."""
        self._half_done = True
        yield
        self._half_done = False

    def _refuse_within_run(self, name: str) -> None:
        if self._running:
            raise InputError(f"{name}: called during a run of the same simulation; call it between runs")

    def _refuse_half_done(self) -> None:
        if self._half_done:
            raise InputError(f"stopped amid a change after step {self.steps}; set_flow or restore it first")


def _place(index: int, name: str) -> str:
    """Where a checkpoint keeps the array ``name`` of the state of body number ``index``."""
    return f"body/{index}/{name}"


def _plain(value):
    """A number, vector or None in JSON's terms; of an array its hash, of a function that it is one."""
    if value is None or callable(value):
        return None if value is None else "function of time"
    value = np.asarray(value, dtype=float)
    if value.size > 3:
        return f"array {value.shape}, SHA-256 {hashlib.sha256(value.tobytes()).hexdigest()[:16]}"
    return value.tolist()


def _rates(rates: Rates | RatesByPlace | None, viscosity: float | None) -> Rates | RatesByPlace:
    """Those given, or the default ones of a viscosity."""
    if rates is None and viscosity is not None:
        return Rates.balanced(viscosity)
    if viscosity is not None:
        raise InputError("rates and viscosity: the rates set the viscosity; give one of the two")
    if not isinstance(rates, Rates | RatesByPlace):
        hint = "; call the preset, as Rates.bgk(viscosity)" if callable(rates) else ""
        raise InputError(
            f"rates = {arguments.shown(rates)}: give lbm.Rates, lbm.RatesByPlace, or viscosity = a number{hint}"
        )
    return rates
