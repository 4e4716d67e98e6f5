"""The comparison reports: each gathers tables, draws figures and fills one self-contained page.

:mod:`.fig1` (e_eff against St), :mod:`.fig2` (the bouncing sphere in time), :mod:`.delivered` (e that other
programs deliver), :mod:`.fits` (a user's own fit) and :mod:`.look` (a user's own track) each have a content, plots
and a page; :mod:`.records`, :mod:`.drawing` and :mod:`.page` are what they share.
"""
