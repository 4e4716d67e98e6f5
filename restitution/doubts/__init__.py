"""What a record is held against before its numbers are believed.

Input that cannot be used is refused; input that can be used but contradicts what every such record obeys gives its
result and a :class:`~.doubt.Doubt` that names the likely mistake. Read
:mod:`.doubt`; :mod:`.mistracked` (frames that no flight passes through), :mod:`.clock` (frames repeated,
renumbered, smoothed), :mod:`.filled` (made up), :mod:`.pieces` (of two rates or two spheres),
:mod:`.place` (the coordinate, the wall, holes), :mod:`.stated` (conditions by themselves);
:mod:`.falls` (what the flights of a track say of gravity), :mod:`.pace` (clock, fluid and sphere by it),
:mod:`.motion` (a track against its conditions), :mod:`.meeting` (whether both sides of a contact meet at the
wall, and none in its image), :mod:`.record` (all of a record);
:mod:`.copies` (impacts told twice), :mod:`.film_loss` (impacts against all measured ones).
"""

from restitution.doubts.copies import of_copies
from restitution.doubts.doubt import Doubt, refuse
from restitution.doubts.film_loss import of_gain, of_impacts
from restitution.doubts.meeting import Meeting, of_meetings
from restitution.doubts.mistracked import Cleaned, cleaned
from restitution.doubts.motion import of_track
from restitution.doubts.pace import of_speed
from restitution.doubts.place import holes
from restitution.doubts.record import of_record
from restitution.doubts.stated import of_conditions, of_light_rebound

__all__ = [
    "Cleaned",
    "Doubt",
    "Meeting",
    "cleaned",
    "holes",
    "of_conditions",
    "of_copies",
    "of_gain",
    "of_impacts",
    "of_light_rebound",
    "of_meetings",
    "of_record",
    "of_speed",
    "of_track",
    "refuse",
]
