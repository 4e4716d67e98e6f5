"""From observations to parameters and their intervals.

Read :mod:`.parameters`, :mod:`.rebound_model` and :mod:`.formula` (what is fitted), :mod:`.plan` (what is free),
:mod:`.likelihood`, :mod:`.first_guess` and :mod:`.maximum`, :mod:`.curvature` (exact derivatives) and
:mod:`.profile` (intervals of what is hardly told apart), :mod:`.identifiability` (what the data cannot tell),
:mod:`.small_sample`, :mod:`.draws` and :mod:`.posterior` (intervals), :mod:`.fitting` (all of it).
"""
