"""From a track to its impacts.

Read :mod:`~restitution.impacts.branch` (the way in and out), :mod:`~restitution.impacts.speed` (which speed is
meant), :mod:`~restitution.impacts.find` (impacts with their errors), :mod:`~restitution.impacts.bounces` (apexes
and the times between contacts), :mod:`~restitution.impacts.shipped` (impacts of the shipped records).
"""

from restitution.impacts.find import Impacts, find_impacts

__all__ = [
    "Impacts",
    "find_impacts",
]
