"""Two verdicts a row and a status: what fails, what is known, what was not evaluated."""

import math

import pytest

from restitution.validation.row import Kind, NotEvaluatedError, Row, at_least, at_most, near
from restitution.validation.scorecard import Judged, Result
from restitution.validation.verdict import Held, Verdict, against_baseline, against_truth, status

PASS, MISS, FAIL, NOT = Verdict.PASS, Verdict.KNOWN_MISS, Verdict.FAIL, Verdict.NOT_EVALUATED


def row(*references, known=None, measure=dict, case=None):
    return Row("r", "q", Kind.ANALYTICAL, "s", references, "t", measure, case or {}, known=known or {})


@pytest.mark.parametrize(
    ("reference", "value", "expected"),
    [
        (near("a", 2.0, relative=0.01), 2.0199, PASS),
        (near("a", 2.0, relative=0.01), 2.021, FAIL),
        (near("a", 2.0, relative=0.01), math.nan, FAIL),
        (near("a", -2.0, relative=0.01), -2.019, PASS),
        (at_most("a", 1e-9), -1e-9, PASS),
        (at_most("a", 1e-9), 2e-9, FAIL),
        (at_most("a", 0.0), 0.0, PASS),
        (at_most("a", 0.0), math.nan, FAIL),
        (at_least("a", 0.5), 0.7, PASS),
        (at_least("a", 0.5), 0.4, FAIL),
    ],
)
def test_a_value_is_held_against_its_reference(reference, value, expected):
    assert against_truth(row(reference), {"a": value}) == {"a": expected}


def test_what_is_known_to_miss_is_said_and_must_be_in_the_baseline():
    r = row(near("a", 1.0, absolute=0.1), known={"a": "coarse"})
    assert against_truth(r, {"a": 1.3}) == {"a": MISS}
    assert against_baseline(r, {"a": 1.3}, None) == {"a": NOT}
    assert against_baseline(r, {"a": 1.3}, {"a": Held(1.3001, 1e-3)}) == {"a": PASS}
    worse, nearer = 1.31, 1.2
    for moved in (worse, nearer):
        assert against_baseline(r, {"a": moved}, {"a": Held(1.3, 1e-3)}) == {"a": FAIL}


def test_a_bound_is_held_by_itself_where_the_baseline_has_the_row():
    bound = row(at_most("a", 1.0))
    assert against_baseline(bound, {"a": 0.5}, {}) == {"a": PASS}
    assert against_baseline(bound, {"a": 0.5}, None) == {"a": NOT}
    known = row(at_most("a", 1.0), known={"a": "noise"})
    assert against_baseline(known, {"a": 1.5}, None) == {"a": NOT}
    assert against_baseline(known, {"a": 1.8}, {"a": Held(1.5, 0.01)}) == {"a": FAIL}


@pytest.mark.parametrize(
    ("was", "now", "expected"),
    [(0.5, 0.5 + 1e-7, PASS), (0.5, 0.51, FAIL), (0.5, 0.49, FAIL), (0.5, 1.1, FAIL), (1e-5, -9e-5, PASS)],
)
def test_a_magnitude_with_a_bound_must_be_what_it_was_and_a_nought_need_not(was, now, expected):
    assert against_baseline(row(at_most("a", 1.0)), {"a": now}, {"a": Held(was, 1e-12)}) == {"a": expected}


def test_no_value_never_passes():
    r = row(near("a", 1.0, absolute=0.1), at_most("b", 1.0))
    assert set(against_truth(r, None).values()) == {NOT}
    assert set(against_baseline(r, None, {"a": Held(1.0, 1.0)}).values()) == {NOT}
    assert against_truth(r, {"a": 1.0})["b"] is NOT


@pytest.mark.parametrize(
    ("verdicts", "strict", "expected"),
    [
        ([(PASS, PASS)], False, 0),
        ([(MISS, PASS)], False, 0),
        ([(MISS, PASS)], True, 1),
        ([(PASS, PASS), (FAIL, PASS)], False, 1),
        ([(PASS, FAIL)], False, 1),
        ([(PASS, NOT)], False, 3),
        ([(NOT, NOT), (FAIL, PASS)], False, 1),
        ([], False, 3),
    ],
)
def test_the_status_of_a_scorecard(verdicts, strict, expected):
    assert status(verdicts, strict) == expected


def test_the_worst_value_speaks_for_the_row():
    r = row(near("a", 1.0, absolute=0.1), near("b", 1.0, absolute=0.1))
    judged = Judged.of(
        r, Result(key=r.key, values={"a": 1.0, "b": None}), {"a": Held(1.0, 0.1), "b": Held(1.0, 0.1)}
    )
    assert (judged.truth, judged.baseline, judged.fails) == (FAIL, FAIL, True)


def test_the_key_is_that_of_the_case():
    one, other, same = (row(measure=math.hypot, case={"cells": n}) for n in (8, 10, 8))
    assert one.key == same.key != other.key


def test_a_row_without_one_of_its_values_is_not_evaluated():
    with pytest.raises(NotEvaluatedError, match="b"):
        row(near("a", 1.0), near("b", 1.0), measure=lambda: {"a": 1.0}).values()
