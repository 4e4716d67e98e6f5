"""Fig. 2: the bouncing sphere in time, kept runs beside the records.

Read :mod:`.content` (what is shown), :mod:`.studies` (which cases vary what), :mod:`.scores`, :mod:`.point_lines`
(the point particle), :mod:`.bands` (what is not known); then what is said:
:mod:`.findings` and :mod:`.sensitivity` (what follows), :mod:`.solver` with :mod:`.checks`, :mod:`.bounce_table`,
:mod:`.unbounded` (drag and history without a wall), :mod:`.page`, :mod:`.plot`; last :mod:`.report`, which puts
them together.
"""
