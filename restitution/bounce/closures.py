"""What a bouncing sphere is modelled with: the closure of each force, and how it is released."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.drive import Drive
from restitution.bounce.wake import OwnWake
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.laws.brenner_1961 import Brenner1961
from restitution.laws.cavitation import ATMOSPHERE
from restitution.laws.drag import STANDARD, DragLaw
from restitution.laws.film import YangHunt2008
from restitution.laws.history import DorganLoth2007, HistoryLaw
from restitution.laws.rebound import ReboundLaw
from restitution.laws.resistance import ResistanceLaw
from restitution.stokes import H_FILM, Speed

ROUGHNESS = 1e-4
"""Film limit in radii where nobody states a roughness: that of Gondret's spheres (Biegert et al. 2017)."""


@dataclass(frozen=True)
class Closures:
    """One closure for each force; None switches a force off.

    The viscous loss near the wall is accounted for in one of two ways, never in both:

    - with a ``rebound`` law or ``measured`` values the film, gap < ``film`` d, is a black box: no viscous force
      acts inside, only gravity and added mass, and e_eff multiplies the speed with which the motion outside, so
      carried on, meets the wall. That is the ``far`` speed of :mod:`restitution.impacts.speed`;
    - with neither, all forces act down to the gap ``contact``, where the sphere rebounds with the dry restitution.
      On its way out the film holds no more than ``tension`` (:mod:`restitution.laws.cavitation`).
      ``lubrication=False`` keeps the resistance of the wall at its value at the edge of the film.
    """

    drag: DragLaw | None = field(default_factory=STANDARD)
    wall: ResistanceLaw | None = field(default_factory=Brenner1961)
    """Adds 6 pi mu r v (lambda - 1) to the drag, so that the sum is Brenner's at small Re."""
    added_mass: Literal["wall", "free"] | None = "wall"
    """``wall``: exact C_M(h) of potential flow; ``free``: 1/2 at any gap."""
    history: HistoryLaw | None = field(default_factory=DorganLoth2007)
    """The default is the kernel said to hold at the Re of measured rebounds, up to a few hundred."""
    drag_factor: float = 1.0
    history_factor: float = 1.0
    """By which drag and history force are multiplied: what a fit may leave open of them."""
    wake: OwnWake | None = None
    """The fluid that an approach leaves moving, met by the rebound: empirical; off by default."""
    rebound: ReboundLaw | None = None
    measured: tuple[float, ...] | None = None
    """e_eff of bounce 1, 2, ... in place of a law; after the last of them the sphere rests."""
    lubrication: bool | None = None
    """Whether the film is resolved; by default where there is no e_eff, by law or measured."""
    tension: float = ATMOSPHERE
    """Tension in Pa at which a resolved film cavitates while the sphere leaves; inf: it holds any."""
    e_dry: float | None = None
    """Dry restitution, by default that of the conditions."""
    contact: float | None = None
    """Gap in m at which the bodies touch, by roughness or elastic film; by default the conditions' roughness."""
    reduced_modulus: float | None = None
    """E* of the two bodies in Pa: the contact gap is then at least the elastohydrodynamic one (Yang & Hunt 2008)
    at the speed with which the sphere enters the film."""
    film: float | None = None
    """Edge of the film in diameters, by default that of the law, else 0.1. A law's constants belong to it: the
    wider the film, the more of the loss is in e_eff (``python -m benchmarks.film_edges``)."""

    def __post_init__(self) -> None:
        own = getattr(self.rebound, "edge", None)
        if self.film is None:
            object.__setattr__(self, "film", H_FILM if own is None else own)
        elif own is not None and own != self.film:
            rule = (
                f"is not the edge of the film that {self.rebound.name} belongs to, {own:g} d: leave it out, or "
                "convert the law by restitution.bounce.law_at"
            )
            raise InputError(Defect(rule, field="film", value=f"{self.film:g}"))
        if self.lubrication is None:
            object.__setattr__(self, "lubrication", not self.black_box)
        if self.rebound is not None and self.measured is not None:
            raise InputError(
                Defect(
                    "stands beside a rebound law: give the one or the other",
                    field="measured",
                    value=self.rebound.name,
                )
            )
        for n, e in enumerate(self.measured or (), 1):
            if not 0 <= e <= 1:
                raise InputError(Defect(f"must lie in [0, 1] at bounce {n}", field="measured", value=f"{e:g}"))
        if self.black_box and self.lubrication:
            raise InputError(
                Defect(
                    "counts the loss in the film twice beside a resolved film: leave the one or the other out",
                    field="rebound" if self.rebound is not None else "measured",
                    value=getattr(self.rebound, "name", None),
                )
            )
        if self.rebound is not None and self.rebound.speed is Speed.FILM_EDGE:
            raise InputError(
                Defect(
                    "is meant for the speed at the edge of the elastic film, which the far speed is not; "
                    "ehd_composite takes the film outside it into account",
                    field="rebound",
                    value=self.rebound.name,
                )
            )
        bounds = {
            "e_dry": (0.0, 1.0), "contact": (0.0, math.inf),
            "reduced_modulus": (1.0, math.inf), "tension": (1.0, math.inf), "film": (0.0, 10.0),
            "drag_factor": (0.0, 10.0), "history_factor": (0.0, 10.0),
        }  # fmt: skip
        for name, (low, high) in bounds.items():
            value = getattr(self, name)
            if value is not None and not low <= value <= high:  # also NaN
                raise InputError(Defect(f"must lie in [{low:g}, {high:g}]", field=name, value=f"{value:g}"))

    @property
    def black_box(self) -> bool:
        """Whether e_eff stands for the film, by a law or as measured."""
        return self.rebound is not None or self.measured is not None

    def contact_gap(self, conditions: Conditions, speed: float = 0.0) -> float:
        """Gap in m at which bodies that enter the film with ``speed`` touch; 0 where e_eff stands for the film."""
        if self.black_box:
            return 0.0
        rough = self.film_limit(conditions)
        if self.reduced_modulus is None or speed <= 0:
            return rough
        elastic = YangHunt2008()(speed, conditions.fluid.viscosity, self.reduced_modulus, conditions.sphere.radius)
        return max(rough, float(elastic))

    def film_limit(self, conditions: Conditions) -> float:
        """Gap in m that asperities leave: ``contact``, or the greatest roughness stated, or 1e-4 r."""
        if self.contact is not None:
            return self.contact
        stated = [
            b.roughness for b in (conditions.sphere, conditions.wall) if b is not None and b.roughness is not None
        ]
        return max(stated, default=ROUGHNESS * conditions.sphere.radius) or ROUGHNESS * conditions.sphere.radius

    def dry(self, conditions: Conditions) -> float:
        """The dry restitution; raises :class:`InputError` where nobody states one."""
        e = self.e_dry if self.e_dry is not None else conditions.sphere.e_dry
        if e is None:
            raise InputError(Defect("must be stated: the rebound needs a dry restitution", field="sphere.e_dry"))
        return e

    def describe(self) -> dict[str, str]:
        """Each closure by name, for tables and records."""
        return {f.name: str(getattr(getattr(self, f.name), "name", getattr(self, f.name))) for f in fields(self)}


@dataclass(frozen=True)
class Release:
    """How the sphere starts: ``gap`` in m, ``speed`` in m/s towards the wall.

    ``developed``: the sphere has moved at this speed for so long that its wake is steady and the history force
    zero; otherwise the fluid was at rest until the start. By default developed where the speed is not zero.
    ``drive``: the sphere was moved up to here; the speed and what the history force remembers follow from it.
    """

    gap: float
    speed: float = 0.0
    developed: bool | None = None
    drive: Drive | None = None

    def __post_init__(self) -> None:
        if self.drive is not None:
            object.__setattr__(self, "speed", float(self.drive.velocity(self.drive.duration)))
        for name, low in (("gap", 0.0), ("speed", -math.inf)):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= low):
                raise InputError(
                    Defect(f"must be a number, at least {low:g}", field=f"release.{name}", value=f"{value:g}")
                )
        if self.developed is None:
            object.__setattr__(self, "developed", self.speed != 0)

    def lagged(self, rates: NDArray) -> NDArray:
        """The velocities in m/s at which the history terms of ``rates`` (1/s) start."""
        if self.drive is not None:
            return self.drive.lagged(rates)
        return np.full(len(rates), -self.speed if self.developed else 0.0)
