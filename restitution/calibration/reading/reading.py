"""How files are read for a fit: what their numbers mean where they do not say so themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from restitution.conditions import Conditions
from restitution.foreign.settings import Settings
from restitution.stokes import Speed

TRACK_COLUMNS = {"time_s": "time", "gap_m": "position", "velocity_m_s": "velocity"}
"""Columns of a track and the keys of settings that name them."""


@dataclass(frozen=True)
class Reading:
    """Definitions and conditions for all files of a fit. ``columns`` maps columns of the schema to the files' own.

    ``stokes`` is the convention of the Stokes number, ``speed`` the definition of the impact speed; None: the
    files state it.
    """

    stokes: str | None = None
    speed: Speed | None = None
    edge: float | None = None
    """Of the film in diameters, for the speed ``far``; None: the files state it, or it is
    :data:`~restitution.stokes.H_FILM`."""
    columns: Mapping[str, str] = field(default_factory=dict)
    conditions: Conditions | None = None
    e_sigma: float | None = None
    """Standard error of each e_eff that states none; None: that of the others, or as the scatter says."""
    unphysical: bool = False
    """Admit e_eff above 1 or below 0."""
    axes: tuple[str, str] = ("stokes", "e_eff")
    """Which columns x and y of a digitised plot are."""
    dry: bool = True
    """Whether the caller states e_dry, or asks for none: a table without it is else asked for it with all else."""
    track: Settings = field(default_factory=Settings)
    """What the numbers of tracks mean, where their files do not say it."""

    @property
    def settings(self) -> Settings:
        """Those of tracks, their columns mapped as ``columns`` says."""
        names = {key: self.columns[name] for name, key in TRACK_COLUMNS.items() if name in self.columns}
        return Settings(**names).over(self.track)
