"""Impacts from what is known of whole flights: the times of contact, as a microphone hears them, or the apexes.

Read :mod:`.table` (the file), :mod:`.free` (flights without drag), :mod:`.drag` (flights of the point particle),
:mod:`.impacts` (rows of the table of impacts, with errors).
"""

from restitution.flights.impacts import FlightImpacts, impacts_of
from restitution.flights.table import Flights, is_flights, read_flights

__all__ = ["FlightImpacts", "Flights", "impacts_of", "is_flights", "read_flights"]
