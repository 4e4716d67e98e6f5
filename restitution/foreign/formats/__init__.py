"""Files that are no text of columns under names.

:mod:`~restitution.foreign.formats.blocks` (many small tables below each other),
:mod:`~restitution.foreign.formats.zones` (files for plots, LabVIEW's measurements),
:mod:`~restitution.foreign.formats.openptv` (a file a frame),
:mod:`~restitution.foreign.formats.stopwatch` (times side by side),
:mod:`~restitution.foreign.formats.digitised` (curves of a plot), :mod:`~restitution.foreign.formats.markup`
(XML), :mod:`~restitution.foreign.formats.hdf5`; these two give :mod:`~restitution.foreign.formats.spots`.
"""
