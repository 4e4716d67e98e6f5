"""Files that are no text of columns under names.

:mod:`~restitution.foreign.formats.kinds` knows them; :mod:`~restitution.foreign.formats.workbook` (spreadsheets;
:mod:`~restitution.foreign.formats.spreadsheet_cells`, :mod:`~restitution.foreign.formats.excel_2003`) and
:mod:`~restitution.foreign.formats.arrays` (NumPy, MATLAB) and :mod:`~restitution.foreign.formats.json_table`
give text;
:mod:`~restitution.foreign.formats.blocks` (many small tables below each other),
:mod:`~restitution.foreign.formats.zones` (files for plots, LabVIEW's measurements),
:mod:`~restitution.foreign.formats.openptv` (a file a frame),
:mod:`~restitution.foreign.formats.stopwatch` (times side by side) give names and rows, as do
:mod:`~restitution.foreign.formats.digitised` (curves of a plot), :mod:`~restitution.foreign.formats.markup`
(XML) and :mod:`~restitution.foreign.formats.hdf5`: :mod:`~restitution.foreign.formats.spots`.
"""
