"""Figure 1: e_eff / e_dry against the Stokes number, measured impacts and laws; what the report is made of.

The impacts come from the shipped trajectories through :mod:`restitution.impacts`. The figure takes the speeds
extrapolated to contact, which keeps the weak bounces: the speed of the motion outside the film loses those that
stay below 0.1 d. All three definitions are tabulated, since the choice moves e_eff.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from restitution import datasets, laws
from restitution.impacts.shipped import impacts_of
from restitution.laws.source_abstract_eq4 import READINGS
from restitution.report.fig1 import scores as comparison
from restitution.report.fig1.rebounds import Rebounds
from restitution.report.fig1.rebounds import gather as gather_rebounds
from restitution.stokes import MEASURED_SPEEDS, Speed

if TYPE_CHECKING:
    import pandas as pd

    from restitution.conditions import Conditions
    from restitution.datasets.package import Resource
    from restitution.report.fig1.trajectories import Trajectories
    from restitution.report.fig1.verdict import Judgement
    from restitution.runs.kept import KeptRun

SPEED = Speed.CONTACT
SIMULATED_BY_ABSTRACT = "gondret2002_st152"
"""The record whose bounces the simulation of the source abstract used ("solid squares" of its Fig. 1)."""
OTHERS = ("legendre_2005", "barnocky_davis_1988", "two_way_lubrication", "ehd_composite")


@dataclass(frozen=True)
class Predicted:
    """A kept run whose rebound is no input, and the series that its case says it is of."""

    series: str
    run: KeptRun


@dataclass(frozen=True)
class Fig1:
    """The tables behind the figure. ``every`` has the impacts under all three definitions of speed.

    ``simulated`` are the kept runs of this package's solver whose impacts are among them.
    """

    impacts: pd.DataFrame
    every: pd.DataFrame
    scores: pd.DataFrame
    conditions: dict[str, Conditions]
    notes: list[str]
    judgements: list[Judgement]
    trajectories: Trajectories
    simulated: dict[str, Predicted] = field(default_factory=dict)
    rebounds: Rebounds | None = None
    """Those of the committed sweeps, which are in none of the tables above."""

    @property
    def measured(self) -> pd.DataFrame:
        return self.impacts[self.impacts.kind == "measured"]

    def judgement(self, speed: Speed) -> Judgement:
        """What the rebounds support under one definition of speed."""
        return next(j for j in self.judgements if j.definition == str(speed))


def gather(speed: Speed = SPEED, runs: str | Path | None = None, rebounds: str | Path | None = None) -> Fig1:
    """Impacts of all shipped trajectories that have any, and the scores of the laws against the measured ones.

    ``runs`` is the folder of kept simulations: those of a series add to the figure and enter no score; nor do
    those of ``rebounds``, a table of simulated ones.
    """
    simulated = {} if runs is None else predicted(Path(runs))
    every, scores, conditions, notes, judgements, trajectories = _everything()
    own = [p.run for p in simulated.values()]
    rows = [row | _provenance_of_run(run) for run in own for row in run.impacts.to_dict("records")]
    if rows:
        import pandas as pd

        every = pd.concat([every, pd.DataFrame(rows, columns=every.columns)], ignore_index=True)
    impacts = every[every.speed_definition == str(speed)].reset_index(drop=True)
    own_rebounds = None if rebounds is None else gather_rebounds(str(rebounds))
    return Fig1(
        impacts, every, scores, conditions, notes[str(speed)], judgements, trajectories, simulated, own_rebounds
    )


@cache
def _everything() -> tuple:
    """What does not depend on the definition of speed that the figure takes: shipped data do not change."""
    import pandas as pd

    from restitution.report.fig1 import trajectories as fig1_trajectories
    from restitution.report.fig1.verdict import judge

    resources = [r for r in map(datasets.resource, datasets.names()) if r.table == "trajectory"]
    resources = [r for r in resources if r.conditions.sphere.e_dry is not None]
    conditions = {r.name: r.conditions for r in resources}
    known = [laws.get(name) for name in (*READINGS, *OTHERS)]
    tables, scores, notes = [], [], {}
    for definition in MEASURED_SPEEDS:
        rows: list[dict] = []
        notes[str(definition)] = []
        for r in resources:
            impacts = impacts_of(r.name, definition)
            rows += [row | _provenance(r) for row in impacts.rows]
            notes[str(definition)] += [f"{r.name}: {note}" for note in impacts.notes]
        columns = [*datasets.schema("impact").columns, *_provenance(resources[0])]
        tables.append(pd.DataFrame(rows, columns=columns))
        measured = tables[-1][tables[-1].kind == "measured"]
        scores.append(comparison.score(known, measured, conditions).assign(speed_definition=str(definition)))
    every = pd.concat(tables, ignore_index=True)
    judgements = judge(every, conditions, (*READINGS, *OTHERS))
    whole = fig1_trajectories.gather()
    return every, pd.concat(scores, ignore_index=True), conditions, notes, judgements, whole


def predicted(folder: Path) -> dict[str, Predicted]:
    """Kept runs with impacts whose cases, shipped or a user's own, state a series (``[study]``)."""
    from restitution import cases
    from restitution.runs.kept import own_runs, read_run

    names, found = cases.names(), {}
    for case in map(cases.read_case, names):
        if case.study is not None and case.study.series is not None:
            found[case.name] = case.study.series, read_run(case, folder)
    for run in own_runs(folder, names):
        if run.case.study is not None and run.case.study.series is not None:
            found[run.case.name] = run.case.study.series, run
    return {name: Predicted(series, run) for name, (series, run) in found.items() if run and len(run.impacts)}


def _provenance(r: Resource) -> dict[str, object]:
    return {
        "used_in_simulation": r.name == SIMULATED_BY_ABSTRACT,
        "experiment": r.experiment.cite,
        "doi": r.experiment.doi,
        "figure": r.experiment.figure,
        "digitised_by": r.digitised_by,
        "data": r.path,
        "sha256": r.hash.removeprefix("sha256:"),
    }


def _provenance_of_run(run: KeptRun) -> dict[str, object]:
    return {
        "used_in_simulation": False,
        "experiment": "this package, resolved simulation",
        "doi": "none",
        "figure": "none",
        "digitised_by": "not digitised",
        "data": f"{run.case.name}/trajectory.csv",
        "sha256": f"run of physics {run.about.physics}, code {run.about.code_hash}",
    }
