"""Rows are measured one by one: what diverges fails, what cannot be had is not evaluated, what is there stays."""

import pytest

from restitution.validation.measure import measure_all, measured
from restitution.validation.row import Kind, NotEvaluatedError, Row, near


def row(name, measure):
    return Row(name, "q", Kind.ANALYTICAL, "s", (near("a", 1.0, absolute=0.1),), "t", measure)


def raising(error):
    def measure():
        raise error

    return measure


@pytest.mark.parametrize("error", [RuntimeError("no steady state"), ZeroDivisionError("of nothing")])
def test_a_flow_that_gives_no_number_fails(error):
    found = measured(row("r", raising(error)))
    assert found.values == {"a": None}
    assert str(error) in found.why


@pytest.mark.parametrize(
    "error", [NotEvaluatedError("no kept run"), ValueError("of another kind"), OSError("gone")]
)
def test_what_cannot_be_had_is_not_evaluated(error):
    found = measured(row("r", raising(error)))
    assert found.values is None
    assert str(error) in found.why


def test_a_stopped_run_goes_on_where_it_was(tmp_path):
    calls = []

    def counted(name, stop=False):
        def measure():
            calls.append(name)
            if stop and calls.count(name) == 1:
                raise KeyboardInterrupt
            return {"a": 1.0 + len(name)}

        return measure

    rows = {name: row(name, counted(name, name == "second")) for name in ("first", "second", "third")}
    with pytest.raises(KeyboardInterrupt):
        measure_all(rows, tmp_path)
    found = measure_all(rows, tmp_path, resume=True)
    assert calls == ["first", "second", "second", "third"]
    assert [found[name].values["a"] for name in rows] == [6.0, 7.0, 6.0]
    measure_all(rows, tmp_path)
    assert calls[4:] == ["first", "second", "third"]
