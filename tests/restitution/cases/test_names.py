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
