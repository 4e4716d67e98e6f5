"""A baseline is renewed with a reason, whole, from a program that is committed; what is not one is refused."""

import json

import pytest

from restitution.errors import InputError
from restitution.validation import baseline as module
from restitution.validation.baseline import SAFETY, Baseline, blessed, read_baseline
from restitution.validation.row import Kind, Row, near
from restitution.validation.scorecard import Result


def row(name="one", cells=8):
    references = (near("a", 1.0, absolute=0.1),)
    return Row(name, "q", Kind.ANALYTICAL, "s", references, "t", lambda cells: {"a": 1.0}, {"cells": cells})


def result(r, value=1.02):
    return Result(key=r.key, values=None if value is None else {"a": value}, why="" if value else "diverged")


@pytest.fixture(autouse=True)
def committed(monkeypatch):
    monkeypatch.setattr(module, "_committed", lambda: ("0123456789ab", ""))


SPREAD = {"one": {"a": 1e-6}, "two": {"a": 0.0}}


def bless(rows, spread=SPREAD, reason="first", before=None, **values):
    results = {r.name: result(r, values.get(r.name, 1.02)) for r in rows}
    return blessed({r.name: r for r in rows}, results, spread, reason, before, {"one": row(), "two": row("two")})


def test_tolerances_are_five_times_the_measured_spread_at_least():
    made = bless([row(), row("two")])
    assert made.rows["one"].values["a"].tolerance == pytest.approx(SAFETY * 1e-6)
    assert SAFETY >= 5
    assert 0 < made.rows["two"].values["a"].tolerance < 1e-10  # the digits that are kept


def test_a_baseline_comes_back_as_it_was_written(tmp_path):
    path = tmp_path / "baseline.json"
    made = bless([row()])
    path.write_text(made.text())
    assert read_baseline(path) == made
    assert made.held(row())["a"].value == 1.02
    assert made.held(row(cells=10)) is None  # another case
    assert made.held(row("two")) is None


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda text: text[: len(text) // 2], "JSON"),
        (lambda text: text.replace("1.02", "1.03"), "edited"),
        (lambda text: text.replace('"version": 1', '"version": 7'), "version"),
        (lambda text: "[]", "no baseline"),
        (lambda text: "", "JSON"),
    ],
)
def test_what_is_no_baseline_is_refused(tmp_path, change, named):
    path = tmp_path / "baseline.json"
    path.write_text(change(bless([row()]).text()))
    with pytest.raises(InputError, match=named):
        read_baseline(path)


def test_rows_that_are_not_renewed_stay_with_their_own_reason():
    before = bless([row(), row("two")], reason="first")
    after = bless([row("two")], reason="second", before=before, two=1.05)
    assert {name: r.reason for name, r in after.rows.items()} == {"one": "first", "two": "second"}
    assert after.rows["two"].values["a"].value == 1.05


def test_nothing_is_renewed_without_a_value_a_spread_or_a_reason(monkeypatch):
    for how in ({"one": None}, {"spread": {}}, {"reason": "  "}):
        with pytest.raises(InputError):
            bless([row()], **how)
    monkeypatch.setattr(module, "_committed", lambda: ("0123456789ab", "M lbm/rates.py"))
    with pytest.raises(InputError, match=r"lbm/rates\.py"):
        bless([row()])


def test_the_file_is_json_with_the_spread_beside_each_value():
    content = json.loads(bless([row()]).text())
    assert content["rows"]["one"]["values"]["a"] == {"value": 1.02, "spread": 1e-6, "tolerance": 5e-6}
    assert isinstance(Baseline.model_validate({k: v for k, v in content.items() if k != "seal"}), Baseline)
