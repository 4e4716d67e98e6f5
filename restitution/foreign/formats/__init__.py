"""Files that are no text of columns under names.

:mod:`~restitution.foreign.formats.blocks` (many small tables below each other),
:mod:`~restitution.foreign.formats.stopwatch` (times side by side), :mod:`~restitution.foreign.formats.markup`
(XML), :mod:`~restitution.foreign.formats.hdf5`; these two give :mod:`~restitution.foreign.formats.spots`.
"""
