"""Fig. 2: the bouncing sphere in time, kept runs beside the records.

Read :mod:`.content` (what is shown), :mod:`.scores`, :mod:`.point_lines` (the point particle),
:mod:`.sensitivity`, :mod:`.solver` with :mod:`.checks`, and :mod:`.findings` (what follows), :mod:`.plot`,
:mod:`.page`.
"""
