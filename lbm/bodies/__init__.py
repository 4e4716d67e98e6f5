"""Bodies in the fluid: the protocol, and a body that stands still.

Read :mod:`~lbm.bodies.body` (what the flow asks of a body), :mod:`~lbm.bodies.reflection` (populations at a curved
surface), :mod:`~lbm.bodies.fixed_body`. Spheres that move are in :mod:`lbm.spheres`.
"""

from lbm.bodies.body import Body
from lbm.bodies.fixed_body import FixedBody

__all__ = [
    "Body",
    "FixedBody",
]
