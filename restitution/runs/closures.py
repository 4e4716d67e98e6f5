"""The closures of a case as the plain callables that the resolved solver takes, in lattice units.

``r`` and gaps in cells, ``mu`` the dynamic viscosity in lattice units; forces are on the sphere. The signatures
are those of ``lbm.spheres.film`` and ``lbm.spheres.contact``.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from restitution import laws
from restitution.bounce.edges import LawAtEdge, carried, law_at
from restitution.cases.case import Case, FilmModel
from restitution.cases.rules import ALONG
from restitution.laws.cavitation import CavitatingFilm, film_edge
from restitution.laws.rebound import ReboundLaw
from restitution.laws.source_abstract_eq3 import lubrication_force
from restitution.runs.measured import measured_restitution
from restitution.stokes import H_FILM, Speed, StokesNumber

Normal = Callable[[float, float, float], float]
Tangential = Callable[[float, NDArray, NDArray, NDArray], tuple[NDArray, NDArray]]


def normal_force(
    film: FilmModel, *, r: float, mu: float, floor: float, tension: float | None, lost: Callable[[float], float]
) -> Normal | None:
    """The film's normal force, of gap, velocity away from the wall, and that at the cut-off.

    ``floor`` in cells, ``tension`` as a pressure; ``lost(gap)`` is what the grid lacks of the resistance 1/gap.
    """
    form, cut_off = film.form, film.cut_off
    if form == "none":
        return None
    if form == "source_abstract_eq3":

        def holding(gap: float, velocity: float, onset: float) -> float:
            return -float(lubrication_force(gap, -velocity, -onset, r=r, mu=mu, D0=cut_off, h_min=floor))

    elif form == "lost_to_grid":

        def holding(gap: float, velocity: float, onset: float) -> float:
            return -6 * math.pi * mu * r * r * velocity * lost(gap)

    else:
        law = laws.get(form, eps_c=cut_off / r, eps_min=floor / r)

        def holding(gap: float, velocity: float, onset: float) -> float:
            return float(-6 * math.pi * mu * r * velocity * law(gap / r, out_of_range="ignore"))

    return holding if tension is None else _torn(holding, r, mu, floor, tension)


def _torn(holding: Normal, r: float, mu: float, floor: float, tension: float) -> Normal:
    film = CavitatingFilm()

    def tearing(gap: float, velocity: float, onset: float) -> float:
        """The torn film's force less what the grid has of the film: the holding one's less what is added to it."""
        force = holding(gap, velocity, onset)
        if velocity <= 0:
            return force
        h = max(gap, floor)
        whole = float(film(h / r, film_edge(mu, velocity, r, tension), out_of_range="ignore"))
        in_grid = r / h + force / (6 * math.pi * mu * r * velocity)
        return min(0.0, -6 * math.pi * mu * r * velocity * (whole - in_grid))

    return tearing


def tangential_force(film: FilmModel, *, r: float, mu: float) -> Tangential | None:
    """Force and torque of the film on a sphere that slides and turns, less what they are at the cut-off::

        F = -6 pi mu r [l_t u - r l_cf (w x n)],   T = -8 pi mu r^2 [r l_r w - 3/4 l_cf (n x u)]

    u velocity and w spin along the wall, n its normal; l = law(gap/r) - law(cut_off/r), for each law of
    :data:`~restitution.cases.rules.ALONG`.
    """
    if not film.tangential:
        return None
    resistances = [laws.get(name) for name in ALONG]
    edge = film.cut_off / r
    at_edge = [float(law(edge, out_of_range="ignore")) for law in resistances]

    def along(gap: float, slip: NDArray, spin: NDArray, normal: NDArray) -> tuple[NDArray, NDArray]:
        sliding, turning, coupling = (
            float(law(gap / r, out_of_range="ignore")) - there
            for law, there in zip(resistances, at_edge, strict=True)
        )
        force = -6 * math.pi * mu * r * (sliding * slip - r * coupling * np.cross(spin, normal))
        torque = -8 * math.pi * mu * r**2 * (r * turning * spin - 0.75 * coupling * np.cross(normal, slip))
        return force, torque

    return along


def edge_of(case: Case) -> float:
    """The edge in diameters within which e_eff stands for the film: of the case, of its law, or 0.1."""
    c = case.contact
    if c.edge_d is not None:
        return c.edge_d
    own = None if c.law is None else c.law_edge_d or laws.get_rebound(c.law).edge
    return H_FILM if own is None else own


def effective_law(case: Case) -> ReboundLaw | LawAtEdge:
    """The law of a case as it is used at :func:`edge_of`."""
    c = case.contact
    return law_at(laws.get_rebound(c.law, **c.parameters), edge_of(case), c.law_edge_d)


def measured_values(case: Case, wake: bool | None = None) -> tuple[float, ...]:
    """The measured restitutions of a case; of a record those of its edge, see :mod:`restitution.runs.measured`."""
    c = case.contact
    return measured_restitution(case.record, edge_of(case), wake) if c.measured == "record" else c.measured


def rebound(case: Case, unit: float) -> Callable[[float, int], float]:
    """Rebound speed of an approach speed outside the film, both in units of ``unit`` m/s, and bounce number.

    Both are carried to the wall by the lattice's free fall, which has the added mass of a sphere far from it; the
    law is asked at the speed that the point particle, with the wall's, has there for the same speed at the edge.
    With measured values the sphere stays at the wall after the last of them.
    """
    conditions, edge = case.conditions, edge_of(case)
    if case.contact.law is None:
        measured = measured_values(case)
        return lambda v, count: v * (measured[count] if count < len(measured) else 0.0)
    law = effective_law(case)
    fallen = 2 * conditions.free_fall * edge * case.sphere.diameter

    def by_law(v: float, count: int) -> float:
        if v <= 0:
            return 0.0
        square = (v * unit) ** 2 - fallen
        at_wall = carried(conditions, math.sqrt(square), edge) if square > 0 else v * unit
        St = StokesNumber.from_speed(at_wall, conditions, "st", Speed.FAR).read_as(law.speed)
        return float(v * law(St, case.sphere.e_dry, conditions, out_of_range="ignore"))

    return by_law
