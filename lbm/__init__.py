"""A compact lattice-Boltzmann solver: D3Q19, multiple relaxation times, updated in place.

Everything is in lattice units (cell, time step, rest density 1); :mod:`lbm.scales` leads to SI and back::

    from lbm import Rates, Simulation

    flow = Simulation((64, 64, 64), Rates.two_relaxation_times(viscosity=0.02), faces={"z": "no-slip"})
    flow.set_flow(velocity=...)
    flow.run(1000, progress=True)
    rho, u = flow.fields()

The package knows nothing of :mod:`restitution`.
"""

from lbm.bodies.body import Body
from lbm.bodies.fixed_body import FixedBody
from lbm.errors import DivergenceError, InputError, OutputError, OutsideRangeWarning
from lbm.faces.records import FreeSlip, Inlet, NoSlip, Outlet, Periodic
from lbm.flow import Flow
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace
from lbm.scales import FlowScales, Scales
from lbm.simulation import Simulation

__all__ = [
    "Body", "DivergenceError", "FixedBody", "Flow", "FlowScales", "FreeSlip", "Inlet", "InputError", "NoSlip",
    "Outlet", "OutputError", "OutsideRangeWarning", "Periodic", "Rates", "RatesByPlace", "Scales", "Simulation",
]  # fmt: skip
