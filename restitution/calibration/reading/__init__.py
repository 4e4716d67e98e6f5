"""From files to observations.

Read :mod:`.observations` (what is known of impacts) with
:mod:`.shared_errors` (what those of a record share), :mod:`.reading` (what the reader of a file is told),
:mod:`.impact_table` and :mod:`.impact_checks` (a table of impacts), :mod:`.track_impacts` (a track),
:mod:`.digitizer` (a digitised plot), :mod:`.impact_data` (any of them); :mod:`.template` is the file to fill in.
"""
