"""The README's example runs as printed, and what it lists exists."""

import re
from pathlib import Path

import numpy as np
import pytest

from restitution.cli import build_parser

README = (Path(__file__).parent.parent / "README.md").read_text()


PRINTED = (
    r"(?s).*K.*e_dry.*St.*eq4_.*\n",
    r"\[[^\]]+\] \[[^\]]+\]\n",
)
EXAMPLES = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.mark.parametrize(("code", "printed"), list(zip(EXAMPLES, PRINTED, strict=True)))
def test_python_examples_run(code, printed, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some write files
    exec(compile(code, "README.md", "exec"), {"np": np})  # the second of a section goes on from the first
    assert re.fullmatch(printed, capsys.readouterr().out)


def test_every_runtime_dependency_has_its_line():
    import tomllib

    project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())["project"]
    wanted = [
        *project["dependencies"],
        *project["optional-dependencies"]["dev"],
        *project["optional-dependencies"]["bench"],
        *project["optional-dependencies"]["emulator"],
    ]
    table = README.split("## Dependencies")[1]
    for requirement in wanted:
        assert re.match(r"[a-z0-9]+", requirement)[0] in table


def test_commands_of_the_table_are_known():
    choices = next(a.choices for a in build_parser()._actions if a.dest == "command")
    assert set(re.findall(r"\| `restitution ([\w-]+)", README)) == set(choices)
