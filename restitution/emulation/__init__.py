"""A solver calibrated by its own runs: which of its sub-grid parameters bring it closest to measured records.

Read :mod:`.runs_table` (a table of runs, of any solver), :mod:`.flown` (the flight of one run), :mod:`.registered`
(flights as vectors that change smoothly with the parameters), :mod:`.emulator` (their principal components by
Gaussian processes), :mod:`.emulator_check` (how well it predicts runs it has not seen), :mod:`.likelihood` (how
probable the frames of a record are), :mod:`.simulated` (whether runs are of its fluid and sphere),
:mod:`.emulated` (all of that for one record), :mod:`.held_out` (records predicted, before and after, and whether
they come closer), :mod:`.told` (what a posterior says, and what is doubtful), :mod:`.calibration`,
:mod:`.solver_file` (``solver.json``, and its values in a case), :mod:`.plot` and :mod:`.page`.
"""

from restitution.emulation.calibration import Calibration, calibrate
from restitution.emulation.runs_table import Runs, read_runs
from restitution.emulation.solver_file import SolverFit, read_solver

__all__ = ["Calibration", "Runs", "SolverFit", "calibrate", "read_runs", "read_solver"]
