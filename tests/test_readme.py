"""The README's example runs as printed, and what it lists exists."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from restitution.cli import build_parser

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


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

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
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


def test_the_scores_of_figure_2_are_those_of_its_report():
    scores = pd.read_csv(ROOT / "reports" / "fig2" / "scores.csv").set_index("case")
    told = README[README.index("At ten cells a diameter") : README.index("[page](reports/fig2")]
    first, second, rms = "apex_1_error", "apex_2_error", "rms_gap_d"
    wanted = [
        (mode, column, cells)
        for mode in ("_imposed", "")
        for column, cells in ((first, 10), (second, 10), (rms, 10))
    ] + [(mode, first, cells) for mode in ("_imposed", "") for cells in (16, 20)]
    values = [scores.at[f"gondret_st152_{cells}{mode}", column] for mode, column, cells in wanted]
    numbers = re.findall(r"[+-]\d\.\d|\d\.\d+(?= d)", told)
    assert numbers == [
        f"{v:.3f}" if c == rms else f"{100 * v:+.1f}" for v, (_, c, _) in zip(values, wanted, strict=True)
    ]
