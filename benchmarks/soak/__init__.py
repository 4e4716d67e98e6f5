"""Attempts to break the toolkit, counted: kills, full disks, damaged and hostile files, two processes at once.

Read :mod:`.outcome` (what an attempt may come to), :mod:`.running` (how a command is tried), :mod:`.trying`, then
the areas: :mod:`.kills`, :mod:`.places`, :mod:`.runs`, :mod:`.tracks`, :mod:`.cases`, :mod:`.impacts`,
:mod:`.fitting`, :mod:`.fits`, :mod:`.packages`, :mod:`.flights`, :mod:`.exports`, :mod:`.sweeps`. Each area is a
record with a generator of attempts from a seed; :mod:`.areas` lists all of them, with what an earlier revision
came to.

    python -m benchmarks.soak --write         # as many as 25 minutes hold, kept in benchmarks/soak.json
    python -m benchmarks.soak --seconds 60    # a few of each area
"""
