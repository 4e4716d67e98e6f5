"""Short shipped cases that are run, not read: falls and rebounds that a change of the program shows in at once."""

from __future__ import annotations

from restitution.cases.reading import read_case
from restitution.impacts.bounces import modelled
from restitution.validation.rebound import Errors, quantities, references, settling_references, settling_values
from restitution.validation.row import Depth, Kind, Row, Values
from restitution.validation.rows.contact import finished
from restitution.validation.rows.rebounds import BY_LAW, KNOWN, content_of


def flown(case: str) -> Values:
    """The quantities of a shipped case, run to its end."""
    import numpy as np

    given = read_case(case)
    run = finished(given)
    motion = run.motion().iloc[:: run.setup.rows_apart]
    if given.contact is None:
        return settling_values(motion.vz_m_s.to_numpy(), given.record)
    time, gap = motion.time_s.to_numpy(), motion.gap_m.to_numpy()
    contacts = np.array([c.time_s - run.contacts[0].time_s for c in run.contacts])
    return quantities(modelled(time, gap, contacts, given.conditions), given.record, given)


def _row(name: str, errors: Errors, depth: Depth) -> Row:
    case = read_case(name)
    settles = case.contact is None

    def truth():
        return settling_references(case.record, False) if settles else references(case.record, errors)

    return Row(
        f"flight-{name}", f"case {name}, run", Kind.MEASURED, case.record, truth,
        f"as of {'settling' if settles else 'rebound'}-{name}", flown, {"case": name}, depth, "as named",
        KNOWN.get(name, {}), content_of(case),
    )  # fmt: skip


ROWS = (
    _row("li_drop1", Errors(), Depth.QUICK),
    _row("li_drop2_imposed", BY_LAW, Depth.QUICK),
    _row("li_drop3", Errors(), Depth.FULL),
    _row("gondret_st27", Errors(), Depth.DEFAULT),
    _row("tencate_e3", Errors(), Depth.DEFAULT),
)
