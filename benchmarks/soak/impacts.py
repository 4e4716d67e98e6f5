"""Tables of impacts and digitised plots, spoiled by hand and at random."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.inputs import LAW, STATED
from benchmarks.soak.outcome import Attempt, Outcome, either, sound
from benchmarks.soak.running import Done
from benchmarks.soak.trying import may, names, tried

FIT = ("fit", "impacts.csv", *LAW, "--out", "fit.json")


def impact_tables(random: Random) -> Iterator[Attempt]:
    """Tables of impacts."""
    for cell, column in product(inputs.WORSE[:-1], (4, 6, 7)):
        # an empty cell is a value that is not given
        judge = names("impacts.csv", left=["fit.json"]) if cell else may("impacts.csv")
        yield tried(
            f"impact cell {cell[:9]!r}",
            {"impacts.csv": inputs.with_cell(inputs.IMPACTS, 2, column, cell)},
            FIT,
            judge,
        )
    for column, cell in ((2, "fast"), (3, "xx"), (4, "-3"), (6, "3"), (8, "-0.1"), (9, "maybe"), (7, "1.7")):
        yield tried(
            f"impact {cell}",
            {"impacts.csv": inputs.with_cell(inputs.IMPACTS, 2, column, cell)},
            FIT,
            names("impacts.csv"),
        )
    yield tried(
        "validate what fit takes", {"impacts.csv": inputs.IMPACTS}, ("data", "validate", "impacts.csv"), sound
    )
    for source in (
        "lab $\\frac{$",
        "\x1b[31mred",
        "<script>alert(1)</script>",
        "x" * 100_000,
        "日本",
        "$$",
        "a\tb",
    ):
        text = inputs.IMPACTS.replace("lab A", source)
        yield tried(f"source {source[:12]!r}", {"impacts.csv": text}, (*FIT, "--report", "report"), shown)
    while True:
        yield tried(
            "impacts at random", {"impacts.csv": inputs.spoiled(inputs.IMPACTS, random)}, FIT, may("impacts.csv")
        )


def shown(done: Done) -> Outcome:
    """A user's text on page and terminal: as text."""
    if not done.out.replace("\n", "").isprintable():
        return Outcome("silent", "control characters are printed raw")
    page = done.folder / "report" / "index.html"
    if page.exists() and "<script>" in page.read_text("utf-8"):
        return Outcome("silent", "a script is on the page")
    return either(done)


def digitized(random: Random) -> Iterator[Attempt]:
    """Digitised plots, CSV and JSON."""
    tables = {"ragged": "10,0.3\n50,0.6\n60\n70,0.7\n", "odd": "D,,E,\nX,Y,X,Y\n10,0.3,5\n50,0.6\n80,0.7\n",
              "three columns": "D,\nX,Y\n30,0.3,1\n60,0.6,2\n90,0.7,3\n",
              "decimal commas": "10,0,3\n20,0,4\n40,0,5\n",
              "two sets": "D,,E,\nX,Y,X,Y\n10,0.3,20,0.4\n50,0.6,60,9.9\n",
              "digits": f"10,0.1\n{'9' * 5000},0.5\n40,0.5\n"}  # fmt: skip
    command = ("fit", "plot.csv", *LAW, *STATED, "--out", "fit.json")
    for name, text in tables.items():
        yield tried(f"plot {name}", {"plot.csv": text}, command, names("plot.csv", left=["fit.json"]))
    content = inputs.project()
    command_json = ("fit", "plot.json", *LAW, *STATED, "--out", "fit.json")
    yield tried("project nested deep", {"plot.json": '{"a":' * 5000}, command_json, names("plot.json"))
    spots = list(inputs.places(content))
    while True:
        yield tried("plot at random", {"plot.csv": inputs.spoiled(inputs.PLOT, random)}, command, may("plot.csv"))
        text = json.dumps(inputs.edited(content, random.choice(spots), random.choice((*inputs.WORSE_JSON, ...))))
        yield tried("project edited", {"plot.json": text}, command_json, may("plot.json"))
