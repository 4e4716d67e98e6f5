"""Fig. 1: e_eff against St, measured, simulated and by the laws.

Read :mod:`.content` (what is shown), :mod:`.scores`, :mod:`.verdict` and :mod:`.trajectories` (what the data say
of the laws), :mod:`.rebounds` and :mod:`.rebounds_plot` (what simulated rebounds say of them), :mod:`.plot`,
:mod:`.page`, and :mod:`.report`, which puts them together.
"""
