"""Flows whose answer is known.

:mod:`~lbm.problems.flows` has the exact solutions without a sphere, handed on here; :mod:`~lbm.problems.spheres`
sets up flows around spheres and measures what references are given for, :mod:`~lbm.problems.bouncing_spheres`
those that fall and bounce, :mod:`~lbm.problems.impulsive_start` a sphere set moving at once,
:mod:`~lbm.problems.held_sphere` one held in a stream. :mod:`~lbm.problems.cavity` is
the cube with a moving lid, :mod:`~lbm.problems.momentum` what must be conserved, :mod:`~lbm.problems.roofline` the
speed over the memory's.
"""

from lbm.problems.flows import PROBLEMS, Case, Preset, Problem

__all__ = [
    "PROBLEMS",
    "Case",
    "Preset",
    "Problem",
]
