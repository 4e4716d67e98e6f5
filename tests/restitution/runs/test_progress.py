"""How a run reports itself."""

import re
from types import SimpleNamespace

import pytest

from restitution.cases.reading import read_case
from restitution.runs import progress as run_progress
from restitution.runs.resolved import ResolvedRun


def test_the_time_left_of_a_resumed_run_is_counted_from_where_it_resumed(monkeypatch, capsys):
    clock = iter(range(1000))
    monkeypatch.setattr(run_progress.time, "perf_counter", lambda: float(next(clock)))
    monkeypatch.setattr(run_progress, "_SECONDS_PER_LINE", 1.0)
    with run_progress.RunProgress("run", cells=1000, shown=True) as progress:
        for step in range(20):
            progress.update(10, 8.0 + 0.05 * step, 10.0, 1.0)  # a twentieth of the last fifth each second
    left = [float(s) for s in re.findall(r"(\d+) s left", capsys.readouterr().err)]
    # 10 - 8.05 at 0.05 a second
    assert left[0] == pytest.approx(39, abs=1)
    assert left[-1] == pytest.approx((10 - 8.95) / 0.05, abs=1)


def test_a_sphere_that_sinks_slower_than_thought_has_its_bounces_still_before_it():
    case = read_case("li_drop1")
    late = SimpleNamespace(case=case, contacts=[], time_s=3.0)
    assert ResolvedRun.expected_s.fget(late) == pytest.approx(3.0 + case.run.after_contact)
