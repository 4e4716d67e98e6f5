"""The name of a case is that of the folder its results go to: no file may choose another place by it."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from restitution.cases.case import Name
from restitution.cli import main

NAME = TypeAdapter(Name)


@given(st.text() | st.text("./\\-a\0\n ", max_size=8))
def test_a_name_leads_nowhere_else(text):
    try:
        name = NAME.validate_python(text)
    except ValidationError:
        return
    place = Path("results") / name
    assert place.parent == Path("results")
    assert place.name == name
    assert name not in ("", ".", "..")
    assert len(f"{name}_point_particle".encode()) < 255


@pytest.mark.parametrize("name", ["../out", "/tmp/out", "a/b", "", "..", ".hidden", "a\\\\b", "a\\u0000", "-x"])
@pytest.mark.parametrize("command", ["bounce", "simulate"])
def test_a_case_cannot_choose_where_results_go(name, command, tmp_path, monkeypatch, capsys):
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    (tmp_path / "in" / "case.toml").write_text(f'base = "gondret_st152_10"\nname = "{name}"\n')
    assert main([command, "case.toml"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: case.toml: name")
    assert "plain name" in said
    assert [p.name for p in tmp_path.rglob("*")] == ["in", "case.toml"]


def test_a_record_stands_for_its_case(capsys):
    """By any name that `validate --case` takes; what it means is said apart from the answer."""
    answers = set()
    for asked in ("gondret_st152_10", "gondret-st152", "gondret2002_st152"):
        assert main(["cases", "show", asked]) == 0
        out, err = capsys.readouterr()
        answers.add(out)
        assert ("gondret_st152_10" in err) == (asked != "gondret_st152_10")
        assert main(["cases", "export", asked, "--to", "lethe"]) == 0
        answers.add(capsys.readouterr().out)
    assert len(answers) == 2


def test_what_is_no_case_says_where_cases_are_named(capsys):
    assert main(["cases", "show", "nosuch"]) == 2
    assert "cases list" in capsys.readouterr().err
    assert main(["simulate", "gondret-st152"]) == 2
    assert "gondret_st152_10" in capsys.readouterr().err


def test_an_inexact_lattice_of_ones_own_is_doubted_beside_its_numbers(tmp_path, capsys):
    (tmp_path / "mine.toml").write_text('base = "gondret_st152_10"\n')
    assert main(["cases", "show", str(tmp_path / "mine.toml")]) == 0
    out, err = capsys.readouterr()
    assert "relaxation time below" in out
    assert err == ""
