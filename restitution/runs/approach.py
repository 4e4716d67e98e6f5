"""The way of a sphere to the film, which cases that differ in film and contact alone have in common.

Film and contact act from the edge of the film on (:meth:`lbm.spheres.Spheres.take_film_and_contact` holds every
step against that). So the approach is run once, without either, up to well above the widest edge of all that share
it; each case then goes on from its checkpoint bit for bit as if it had come the whole way (``fork`` of
:func:`restitution.runs.simulate.simulate`). Which cases share an approach is found from what the solver is told of
them (:func:`restitution.runs.validity.key.approach_key`), not from the names of their keys.
"""

from __future__ import annotations

from pathlib import Path

from restitution.cases.case import Case
from restitution.errors import InputError
from restitution.files import write_folder
from restitution.locks import sole_writer
from restitution.runs.resolved import ResolvedRun, owner_of
from restitution.runs.stand import CHECKPOINT, Stand
from restitution.runs.validity.key import approach_key

APPROACH = "approach.h5"
_HALVED = 2.2
"""The steps until a run is looked at next halve the gap, and somewhat more where the sphere gains speed."""
_CELLS, _STEPS = 0.1, 3.0
"""Before the edge, where film and contact are asked already (``matters`` of :mod:`lbm.spheres.wall_motion`)."""


def run_approach(case: Case, edge: float, folder: str | Path) -> bool:
    """Run the approach of ``case`` to above ``edge`` d and leave its checkpoint in ``folder``.

    One that was stopped is continued. False where there is none: the sphere is released too near to the wall, or
    twice as fast as the reference speed, so that the run is not looked at before it is in the film.
    Errors as in :func:`restitution.runs.simulate.simulate`.
    """
    folder = Path(folder)
    write_folder(folder, {})
    with sole_writer(folder):
        if (folder / APPROACH).exists():
            return True
        run, stand = _begin(case, folder)
        if owner_of(stand.path) == stand.key:
            try:
                stand.restore()
            except InputError:  # it cannot be read on
                run, stand = _begin(case, folder)
        try:
            while not run.finished and run.gap_d > _HALVED * (edge + run.in_d(_CELLS, _STEPS)):
                run.advance()
                stand.frames.look(run)
                stand.save_now_and_then()
            too_far = run.finished or run.gap_d < edge + run.in_d(_CELLS, _STEPS)
            if too_far or run.simulation.steps == 0:
                return False
            stand.save()
        except BaseException:
            stand.leave()
            raise
        stand.path.replace(folder / APPROACH)
    return True


def _begin(case: Case, folder: Path) -> tuple[ResolvedRun, Stand]:
    run = ResolvedRun(case)
    run.leave_walls_out()
    return run, Stand(run, approach_key(case), folder / CHECKPOINT)
