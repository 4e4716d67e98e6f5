"""Did a change spoil the solver? A scorecard of what is known, with two verdicts a row and a status for a gate.

Read :mod:`~restitution.validation.row` (what a row is), :mod:`~restitution.validation.rows` (the rows themselves),
:mod:`~restitution.validation.rebound` (a trajectory against its record), :mod:`~restitution.validation.verdict`
(what is said of a row), then how a scorecard comes about: :mod:`~restitution.validation.measure`,
:mod:`~restitution.validation.baseline`, :mod:`~restitution.validation.scorecard`,
:mod:`~restitution.validation.page` with :mod:`~restitution.validation.plot`.

:mod:`~restitution.validation.trajectory` scores a trajectory of somebody else's solver, as
:mod:`~restitution.validation.trajectory_file` reads it, :mod:`~restitution.validation.trajectory_page` shows
several; :func:`assert_trajectory` is for tests.
"""

from restitution.validation.trajectory import assert_trajectory, case_of, score

__all__ = ["assert_trajectory", "case_of", "score"]
