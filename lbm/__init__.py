"""D3Q19 lattice-Boltzmann solver: the place of the reference solver, which this version does not yet hold.

The package will know nothing of :mod:`restitution`: closures come to it as plain callables, and its runs
leave it as plain tables of the same schema as the measured data.
"""
