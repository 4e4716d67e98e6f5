"""Between lattice and SI units: one object, one table of dimension exponents."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from lbm import arguments
from lbm.errors import InputError, OutsideRangeWarning

__all__ = ["DIMENSIONS", "FlowScales", "Scales"]

DIMENSIONS: dict[str, tuple[int, int, int]] = {
    "length": (1, 0, 0),
    "time": (0, 1, 0),
    "mass": (0, 0, 1),
    "velocity": (1, -1, 0),
    "acceleration": (1, -2, 0),
    "frequency": (0, -1, 0),
    "kinematic viscosity": (2, -1, 0),
    "density": (-3, 0, 1),
    "dynamic viscosity": (-1, -1, 1),
    "pressure": (-1, -2, 1),
    "force": (1, -2, 1),
    "force density": (-2, -2, 1),
    "torque": (2, -2, 1),
    "energy": (2, -2, 1),
}
"""Exponents of length, time and mass of each quantity."""


@dataclass(frozen=True)
class Scales:
    """What one lattice unit is in SI.

    Parameters
    ----------
    cell_m : length of a cell in m.
    step_s : time step in s.
    density_kg_m3 : of the fluid at rest, which is lattice density 1.

    Raises
    ------
    InputError
        For what is not a positive number.
    """

    cell_m: float
    step_s: float
    density_kg_m3: float = 1.0

    def __post_init__(self) -> None:
        for name in ("cell_m", "step_s", "density_kg_m3"):
            arguments.positive(name, getattr(self, name))

    def unit(self, quantity: str) -> float:
        """SI value of one lattice unit of ``quantity`` (a key of :data:`DIMENSIONS`)."""
        if not isinstance(quantity, str) or quantity not in DIMENSIONS:
            raise InputError(f"quantity {arguments.shown(quantity)} unknown; known: {', '.join(DIMENSIONS)}")
        length, time, mass = DIMENSIONS[quantity]
        return self.cell_m**length * self.step_s**time * (self.density_kg_m3 * self.cell_m**3) ** mass

    def si(self, value, quantity: str):
        """``value`` in lattice units, a number or array, in SI."""
        return _numbers(value) * self.unit(quantity)

    def lattice(self, value, quantity: str):
        """``value`` in SI, a number or array, in lattice units."""
        return _numbers(value) / self.unit(quantity)


@dataclass(frozen=True)
class FlowScales:
    """A flow and its resolution, with the numbers that say whether the method can hold it.

    Built by :meth:`from_conditions`.

    Attributes
    ----------
    scales : :class:`Scales`.
    speed, length, viscosity : in lattice units: cells a step, cells, cells^2 a step.
    """

    scales: Scales
    speed: float
    length: float
    viscosity: float

    @classmethod
    def from_conditions(
        cls,
        *,
        length_m: float,
        speed_m_s: float,
        viscosity_m2_s: float,
        density_kg_m3: float,
        cells: float,
        lattice_speed: float = 0.05,
    ) -> FlowScales:
        """Scales from physical conditions and a resolution.

        Parameters
        ----------
        length_m, speed_m_s, viscosity_m2_s, density_kg_m3 : float
            Of the flow, in SI; the viscosity is the kinematic one.
        cells : float
            Cells per ``length_m``.
        lattice_speed : float
            What ``speed_m_s`` becomes, in cells a step; it sets the time step.

        Raises
        ------
        InputError
            For what cannot run; what runs inaccurately is warned of, both by :meth:`check`.
        """
        given = {
            "length_m": length_m,
            "speed_m_s": speed_m_s,
            "viscosity_m2_s": viscosity_m2_s,
            "density_kg_m3": density_kg_m3,
            "cells": cells,
            "lattice_speed": lattice_speed,
        }
        for name, value in given.items():
            arguments.positive(name, value)
        cell = length_m / cells
        scales = Scales(cell, lattice_speed * cell / speed_m_s, density_kg_m3)
        flow = cls(scales, lattice_speed, cells, scales.lattice(viscosity_m2_s, "kinematic viscosity"))
        flow.check()
        return flow

    @property
    def reynolds(self) -> float:
        """Re = speed length / viscosity."""
        return self.speed * self.length / self.viscosity

    @property
    def mach(self) -> float:
        """Ma = speed sqrt(3)."""
        return self.speed * math.sqrt(3)

    @property
    def relaxation_time(self) -> float:
        """Relaxation time of the stress, tau = 3 viscosity + 1/2."""
        return 3 * self.viscosity + 0.5

    @property
    def grid_reynolds(self) -> float:
        """Re of one cell, speed / viscosity."""
        return self.speed / self.viscosity

    def describe(self) -> dict[str, float]:
        """Re, Ma, relaxation time, grid Reynolds number, cell and step."""
        return {
            "Re": self.reynolds,
            "Ma": self.mach,
            "relaxation time": self.relaxation_time,
            "grid Re": self.grid_reynolds,
            "cell_m": self.scales.cell_m,
            "step_s": self.scales.step_s,
        }

    def check(self) -> None:
        """Refuse what cannot run, warn of what runs inaccurately; the limits are the table below.

        ==================  ===========  ==========================
        number              accurate     refused
        ==================  ===========  ==========================
        Ma                  <= 0.2       > 0.5
        relaxation time     0.505 - 2    (<= 0.5 cannot occur here)
        grid Re             <= 20        > 200
        ==================  ===========  ==========================

        The bounds are rules of thumb of practice (Kruger et al., The Lattice Boltzmann Method, 2017, ch. 7),
        not sharp limits.
        """
        state = ", ".join(f"{name} = {value:.4g}" for name, value in list(self.describe().items())[:4])
        slower = "lower lattice_speed (smaller time step)"
        finer = "more cells (finer grid)"
        if self.mach > 0.5:
            raise InputError(f"lattice_speed = {self.speed:g} is too high ({state}): {slower}, to about 0.05")
        if self.grid_reynolds > 200:
            raise InputError(f"grid Reynolds number {self.grid_reynolds:.4g} is too high ({state}): {finer}")
        advice = []
        if self.mach > 0.2:
            advice.append(f"Ma above 0.2: {slower}")
        if self.relaxation_time < 0.505:
            advice.append(f"relaxation time below 0.505: {finer} or a higher lattice_speed")
        if self.relaxation_time > 2:
            advice.append(f"relaxation time above 2: {slower} or fewer cells")
        if self.grid_reynolds > 20:
            advice.append(f"grid Re above 20: {finer}")
        if advice:
            warnings.warn(f"{'; '.join(advice)} ({state})", OutsideRangeWarning, stacklevel=3)


def _numbers(value):
    """``value`` itself if it is a number or an array of numbers, else as such an array."""
    if isinstance(value, np.ndarray | np.generic | float | int) and np.asarray(value).dtype.kind in "iuf":
        return value
    return arguments.array("value", value)
