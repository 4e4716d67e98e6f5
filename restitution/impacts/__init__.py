"""From a track to its impacts.

Read :mod:`~restitution.impacts.branch` (the way in and out), :mod:`~restitution.impacts.speed` (which speed is
meant), :mod:`~restitution.impacts.find` (impacts with their errors), :mod:`~restitution.impacts.bounces` (apexes
and the times between contacts), :mod:`~restitution.impacts.shipped` (impacts of the shipped records).
"""

from restitution.impacts.bounces import Bounces, filmed, modelled
from restitution.impacts.find import Impacts, find_impacts

__all__ = [
    "Bounces",
    "Impacts",
    "filmed",
    "find_impacts",
    "modelled",
]
