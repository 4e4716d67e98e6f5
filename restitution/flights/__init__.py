"""Impacts from what is known of whole flights: the times of contact, as a microphone hears them, or the apexes.

Read :mod:`.table` (the file), :mod:`.free` (flights without drag), :mod:`.drag` (flights of the point particle),
:mod:`.impacts` (rows of the table of impacts, with errors).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from restitution.flights.table import Flights, is_flights, read_flights

if TYPE_CHECKING:
    from restitution.flights.impacts import FlightImpacts, impacts_of

__all__ = ["FlightImpacts", "Flights", "impacts_of", "is_flights", "read_flights"]


def __getattr__(name: str) -> object:
    """What is handed on, loaded when it is first asked for: with it come the forces and their compiler."""
    if name in ("FlightImpacts", "impacts_of"):
        from restitution.flights import impacts

        return getattr(impacts, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
