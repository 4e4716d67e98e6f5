"""The fluid: where populations lie, and what a time step does to them.

Read :mod:`~lbm.fluid.stencil`, :mod:`~lbm.fluid.moments` and :mod:`~lbm.fluid.equilibrium` (the method),
:mod:`~lbm.fluid.collision` (one cell), :mod:`~lbm.fluid.lattice` (the map of populations to memory, faces folded
in), :mod:`~lbm.fluid.places` (which rates hold where), :mod:`~lbm.fluid.kernels` (a step),
:mod:`~lbm.fluid.fields` (density and velocity).
:mod:`~lbm.fluid.memory` and :mod:`~lbm.fluid.cache` are about the machine.
"""
