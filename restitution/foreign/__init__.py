"""Files as cameras, trackers, spreadsheets and solvers write them, made into the project's own tables.

Read :mod:`~restitution.foreign.file_text` (lines), :mod:`~restitution.foreign.number_text` (numbers),
:mod:`~restitution.foreign.layout` (cells), :mod:`~restitution.foreign.heading` (names and units),
:mod:`~restitution.foreign.sections` (tables one below another), :mod:`~restitution.foreign.programs` (marks of
programs), :mod:`~restitution.foreign.formats` (what is no text of columns), :mod:`~restitution.foreign.table` (the
table), :mod:`~restitution.foreign.settings` (what its numbers mean), :mod:`~restitution.foreign.player` (times of
a film played slowly), :mod:`~restitution.foreign.completed` and :mod:`~restitution.foreign.asking` (what is left
open), :mod:`~restitution.foreign.track` (the track), :mod:`~restitution.foreign.self_named` (headers that say it
all), :mod:`~restitution.foreign.long_track` (a long one).

Tables of the project's own are read strictly, by :mod:`restitution.tables`; what is read here ends there too, so
that the same rules hold and name the same rows.
"""

from restitution.foreign.settings import Settings, read_settings
from restitution.foreign.table import ForeignTable, read_foreign
from restitution.foreign.track import ForeignTrack, read_track

__all__ = ["ForeignTable", "ForeignTrack", "Settings", "read_foreign", "read_settings", "read_track"]
