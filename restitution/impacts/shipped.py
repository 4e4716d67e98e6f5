"""Impacts of the shipped records, whose tables do not change: each is evaluated once a process."""

from __future__ import annotations

from functools import cache

from restitution import datasets
from restitution.impacts.find import Impacts, find_impacts
from restitution.stokes import H_FILM, Speed


@cache
def impacts_of(record: str, speed: Speed, h_film: float = H_FILM) -> Impacts:
    """Impacts of a shipped record under one definition of speed, as :func:`find_impacts` gives them, St as ``st``.

    What is returned is shared: rows are to be read, not changed.
    """
    r = datasets.resource(record)
    return find_impacts(
        datasets.load_track(record), r.conditions, speed, record=record, kind=r.kind, h_film=h_film
    )
