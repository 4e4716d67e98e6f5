"""The report of a fit.

Read :mod:`.report` and :mod:`.plot` (impacts), :mod:`.trajectories` (whole trajectories), :mod:`.design_plot`.
"""
