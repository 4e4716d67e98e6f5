"""A simulation case: what is released how, in which fluid, and what the solver and its closures are told.

One TOML file serves the resolved solver (``restitution simulate``) and the point-particle model, which takes no
``[numerics]``. Fluid, sphere, wall and gravity come from a shipped ``record`` where one is named; keys given
beside it replace its own. Numbers are in SI but where a key says otherwise: ``_d`` diameters, ``_cells``,
``_steps``; a text may have another unit, as in ``diameter = "3 mm"``. Files are read by
:mod:`restitution.cases.reading`; what cannot be run is found by :mod:`restitution.cases.rules`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from restitution.conditions import (
    Acceleration,
    Conditions,
    Duration,
    Fluid,
    Length,
    NonNegative,
    Positive,
    Record,
    Sphere,
    Velocity,
    Wall,
)
from restitution.stokes import WIDEST_FILM
from restitution.units import measured

_LONGEST_NAME = 100
MOST_ADDED_MASS = 8.0
"""Over the displaced mass; ten times that of potential flow about a sphere that touches a wall, 0.803."""


def _plain(name: str) -> str:
    """Results go to a folder of this name: it must not lead elsewhere, nor be none."""
    plain = name.isprintable() and name[:1] not in ("", ".", "-") and not set(name) & set("/\\")
    if not plain or len(name.encode()) > _LONGEST_NAME:
        raise ValueError(
            f"must be a plain name, of at most {_LONGEST_NAME} bytes, without slashes or control "
            "characters, and begin with neither point nor dash: results go to a folder of that name"
        )
    return name


Name = Annotated[str, AfterValidator(_plain)]
Restitution = Annotated[float, Field(ge=0, le=1, strict=True)]
EdgeOfFilm = Annotated[float, Field(gt=0, le=WIDEST_FILM, strict=True)]


class Release(Record):
    """How the sphere starts, at the gap ``gap_d``.

    ``rest``: set free at rest. ``drive``: moved at u(t) = ``speed`` (1 - exp(-t/``ramp``)) towards the wall, speed
    in m/s and ramp in s, until the gap is ``free_below_d``; free from there on. ``along`` is the speed along the
    wall, in m/s, gained likewise: an oblique impact.
    """

    kind: Literal["rest", "drive"]
    gap_d: Positive
    speed: Velocity | None = None
    ramp: Duration | None = None
    along: Annotated[NonNegative, measured("m/s")] = 0.0
    free_below_d: Positive = 0.5


RatesName = Literal[
    "balanced-by-place", "dhumieres-by-place", "quiet-by-place", "balanced", "quiet", "two-relaxation-times",
    "dhumieres2002",
]  # fmt: skip
QUIET_TO = 22.0
"""Grid Reynolds number, speed times cell over viscosity, up to which balanced rates were shown to be quiet.

A sphere held in a stream at 10 cells a diameter: at 22 they are as quiet as any, at 25 the force has 1.3 % of
noise, at 30 the flow diverges (benchmarks/README.md).
"""


class Numerics(Record):
    """Grid, box and method of the resolved run.

    ``lattice_speed`` is what ``reference_speed`` (m/s; by default the speed of the drive) becomes in cells a step:
    it sets the time step. The box is ``width_d`` wide and deep, ``height_d`` high. With ``symmetry`` "quarter",
    the default of a fall that is not ``along`` the wall too, two mirrors meet in the axis of the fall, and a
    quarter of the box is computed for the whole. ``rates`` are those of :class:`lbm.Rates` and
    :class:`lbm.RatesByPlace`, by default as fast as the flow is (:attr:`Case.rates`).
    """

    cells_per_diameter: Positive
    lattice_speed: Positive = 0.05
    reference_speed: Velocity | None = None
    width_d: Positive = 8.0
    height_d: Positive = 13.0
    sides: Literal["periodic", "no-slip", "free-slip"] = "periodic"
    top: Literal["no-slip", "free-slip", "outlet"] = "no-slip"
    precision: Literal["float32", "float64"] = "float32"
    rates: RatesName | None = None
    interpolation: Literal["linear", "central-linear"] = "linear"
    symmetry: Literal["none", "quarter"] | None = None


FilmForm = Literal["none", "lost_to_grid", "source_abstract_eq3", "nguyen_ladd_2002", "brenner_1961_difference"]


class FilmModel(Record):
    """The lubrication force added below the cut-off, constant below the ``floor``, in m.

    ``lost_to_grid`` is what the grid lacks of the film, which fixes its cut-off
    (:func:`lbm.spheres.film.lost_to_grid`); the other forms have one to choose, ``cut_off_cells``, by default 1.
    At the floor sphere and wall touch; by default it is the larger of the stated roughnesses.
    With ``tangential`` the film also resists sliding and turning at the wall, below the same cut-off.
    """

    form: FilmForm = "none"
    cut_off_cells: Positive | None = None
    floor: Length | None = None
    tension: Annotated[Positive, measured("Pa")] | None = None
    """Tension in Pa at which the film cavitates as the sphere leaves (``cavitating_film``); else it holds."""
    tangential: bool = False

    @property
    def cut_off(self) -> float:
        """Cut-off in cells."""
        if self.form == "lost_to_grid":
            return 0.5
        return 1.0 if self.cut_off_cells is None else self.cut_off_cells


ContactMode = Literal["effective", "dry", "soft_linear", "soft_hertz"]


class ContactModel(Record):
    """What happens at the wall.

    ``effective``: e_eff of the motion outside the film, by a rebound ``law`` with ``parameters`` or as
    ``measured``, one value a bounce, "record" taking those of the record. ``dry``: e_dry at the film's floor.
    ``soft_linear``, ``soft_hertz``: a contact of e_dry stretched over ``duration_steps``. None has friction: along
    the wall the sphere feels the fluid alone.

    ``edge_d`` is the edge of the film in diameters within which e_eff stands for every viscous force, so that the
    sphere falls freely: by default the one that the law's constants belong to, else 0.1. ``law_edge_d`` says which
    that is where the law does not; at another edge than its own a law is converted by the point particle.

    ``added_mass`` is the fluid that is reversed with the sphere, over the fluid it displaces: 0.803 in potential
    flow about a sphere that touches a wall. By default it is what the lattice makes of that at its resolution.
    """

    mode: ContactMode
    law: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)
    measured: Literal["record"] | Annotated[tuple[Restitution, ...], Field(min_length=1)] | None = None
    edge_d: EdgeOfFilm | None = None
    law_edge_d: EdgeOfFilm | None = None
    duration_steps: Positive | None = None
    added_mass: Annotated[float, Field(ge=0, le=MOST_ADDED_MASS, strict=True)] | None = None


class Span(Record):
    """When the run ends: ``after_contact`` s after the first contact, or ``duration`` s after the release.

    A case without ``[contact]`` ends where the sphere would touch the wall. ``snapshot_interval`` in s.
    """

    after_contact: Duration | None = None
    duration: Duration | None = None
    snapshot_interval: Duration | None = None


class Study(Record):
    """What a case is there to show; for the reports alone: it decides nothing of the run, and no base hands it on.

    ``varies`` says in words what the case has otherwise than the case ``against``. Cases of the same words against
    the same one are a group of the table of what the result depends on; groups stand by ``order``, those without
    one last. With ``unknown`` nobody knows which of the values varied is right: the runs of such cases make the
    band that is drawn about the run of the case ``against``. ``series`` names the simulated series of Fig. 1 that
    its impacts join: its rebound is no input.
    """

    varies: str | None = None
    against: str | None = None
    order: Positive | None = None
    unknown: bool = False
    series: str | None = None


class Case(Record):
    """A whole case.

    ``title``, ``note`` and ``study`` are for readers; ``prediction`` says that no measured track exists.
    """

    name: Name
    title: str = ""
    note: str = ""
    record: str | None = None
    prediction: bool = False
    study: Study | None = None
    fluid: Fluid
    sphere: Sphere
    wall: Wall | None = None
    gravity: Acceleration = 9.81
    release: Release
    numerics: Numerics | None = None
    film: FilmModel = FilmModel()
    contact: ContactModel | None = None
    run: Span

    @property
    def conditions(self) -> Conditions:
        """Fluid, sphere, wall and gravity."""
        return Conditions(fluid=self.fluid, sphere=self.sphere, wall=self.wall, gravity=self.gravity)

    @property
    def floor(self) -> float | None:
        """Gap in m at which sphere and wall touch; None where nobody states one."""
        stated = [b.roughness for b in (self.sphere, self.wall) if b is not None and b.roughness]
        return self.film.floor if self.film.floor is not None else max(stated, default=None)

    @property
    def quartered(self) -> bool:
        """Whether a quarter of the box is computed for the whole."""
        chosen = self.numerics.symmetry if self.numerics is not None else None
        return chosen == "quarter" if chosen is not None else not self.release.along

    @property
    def reference_speed(self) -> float | None:
        """The speed in m/s that the lattice speed stands for."""
        given = self.numerics.reference_speed if self.numerics is not None else None
        return given if given is not None else self.release.speed

    @property
    def rates(self) -> RatesName:
        """Relaxation rates of the resolved run: as chosen, else by the grid Reynolds number of the speed.

        Up to :data:`QUIET_TO` "balanced-by-place", which have walls and surfaces in their place, beyond it
        "dhumieres-by-place", which are the quietest in fast flow.
        """
        n, speed = self.numerics, self.reference_speed
        if n is not None and n.rates is not None:
            return n.rates
        if n is None or speed is None:
            return "balanced-by-place"
        reynolds = speed * self.sphere.diameter * self.fluid.density / self.fluid.viscosity
        return "balanced-by-place" if reynolds / n.cells_per_diameter <= QUIET_TO else "dhumieres-by-place"
