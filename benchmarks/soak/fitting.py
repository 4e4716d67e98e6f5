"""Kept fits, formulas and options of fit and predict."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.impacts import FIT
from benchmarks.soak.inputs import LAW, PAIR
from benchmarks.soak.outcome import Attempt, Outcome, either, sound
from benchmarks.soak.running import Workshop
from benchmarks.soak.trying import Judge, may, names, tried

FLUID_REST = "viscosity=0.01"


def fit_files(random: Random) -> Iterator[Attempt]:
    """Edits of fit.json through ``predict`` and ``design``."""
    ways = (("predict", "edited.json", *PAIR, "--st", "30,150"), ("design", "edited.json", "--e-dry", "0.97"))
    wrong = [
        (("parameters", 0, "value"), -5.0), (("covariance",), [[1.0]]), (("covariance",), []), (("covariance",
        0, 0), -1.0),
        (("parameters",), []), (("points",), []), (("speed_definition",), "xx"), (("law", "convention"), "xx"),
        (("stokes_range",), [300.0, 9.0]), (("parameters", 0, "degrees_of_freedom"), -3.0),
        (("parameters", 0, "degrees_of_freedom"), 0.0), (("parameters", 0, "name"), "Q"),
        (("parameters", 0, "intervals"), {}), (("format",), "restitution-fit/9"), (("parameters", 0, "bounds"),
        [200.0, 0.0]),
    ]  # fmt: skip

    def edit(place: tuple, value: object, way: tuple[str, ...], judge: Judge) -> Attempt:
        def make(shop: Workshop) -> Outcome:
            shop.write("impacts.csv", inputs.IMPACTS)
            if (made := sound(shop.command(*FIT))).kind != "clean":
                return made
            content = json.loads((shop.folder / "fit.json").read_text())
            spot = place or random.choice(list(inputs.places(content)))
            shop.write("edited.json", json.dumps(inputs.edited(content, spot, value)))
            return judge(shop.command(*way))

        return Attempt(f"fit.json {'.'.join(map(str, place)) or 'edited'} {value!r:.20} {way[0]}", make)

    for (place, value), way in product(wrong, ways):
        yield edit(place, value, way, names("edited.json"))
    for text, way in product(("[" * 5000, "", "[]", "null", '{"a": 1, "a": 2}', '{"a": NaN}', "9" * 5000), ways):
        yield tried(f"fit.json {text[:9]!r} {way[0]}", {"edited.json": text}, way, names("edited.json"))
    while True:
        yield edit((), random.choice((*inputs.WORSE_JSON, ..., 0, -1, 1.0, "st", "K")), random.choice(ways), may())


def predict_options(_: Random) -> Iterator[Attempt]:
    """Options of ``predict``."""
    values = ("1_0", "１０", "nan", "1e999", "-3", "3,,4", "", "inf", "0x1", "1e-400", "x")
    options = [(*PAIR, "--st", value) for value in values]
    options += [("--fluid", f"density=935,density=2,{FLUID_REST}", "--sphere", inputs.FLUID[1], "--st", "3")]
    options += [
        ("--fluid", "density=935", "--sphere", inputs.FLUID[1], "--st", "3"),
        ("--e-dry", "0.97", "--st", "9" * 400),
    ]
    for option in options:
        yield tried(
            f"predict {option[-1][:12]!r}",
            {"impacts.csv": inputs.IMPACTS},
            ("predict", "fit.json", *option),
            names(),
            FIT,
        )


def formulas(random: Random) -> Iterator[Attempt]:
    """Formulas of the user's own: nothing is run but mathematics."""
    bad = [
        "__import__('os').system('touch ran')", "e_dry.__class__", "St**St**St**St**St", "(" * 3000 + "St",
        "lambda: St",
        "f'{St}'", "(a:=St)", "e_dry*exp(-a/St", "exp", "St.real", "[St]", "{St}", "St if St else 1",
        "open('ran','w')",
        "e_dry*exp(-a/St)\0", "９*St", "x" * 100_000, "eval('1')", "a" * 300 + "*St", "St;St", "import os",
        "e_dry*9**9**9",
        "factorial(99999)*St", "sum(St)", "St @ St", "St % a", "1/0*St", "St==St", "a.b", "not St", "St and a",
        "`St`",
        "e_dry*sqrt(-St)*a", "St\n", "#", "", "e_dry", "'x'", "1j*St*a", "None", "True*St", "...", "print(St)",
        "St<a",
    ]  # fmt: skip
    for text in bad:
        yield Attempt(f"formula {text[:20]!r}", lambda shop, text=text: formula(shop, text))
    while True:
        text = inputs.spoiled("e_dry*exp(-(a/St)**n)", random).decode("utf-8", "replace").replace("\0", "")
        yield Attempt(f"formula {text[:20]!r}", lambda shop, text=text: formula(shop, text))


def formula(shop: Workshop, text: str) -> Outcome:
    """A formula may be fitted or refused; nothing else may come of it."""
    shop.write("impacts.csv", inputs.IMPACTS)
    bounds = ("--bounds", "a=5:100", "--bounds", "n=0.3:3")
    outcome = either(shop.command("fit", "impacts.csv", "--law", text, *bounds))
    if (shop.folder / "ran").exists():
        return Outcome("silent", "the formula was executed")
    return outcome


def fit_options(_: Random) -> Iterator[Attempt]:
    """Options of ``fit`` that mean nothing, and those that mean something."""
    bad = [
        ("--fix", "K=-5"), ("--fix", "K=1_0"), ("--fix", "K=18", "--fix", "K=19"), ("--fix", "K=18", "--free",
        "K"),
        ("--prior", "K=1e308+-1e308"), ("--prior", "K=18+-１"), ("--prior", "K=18"), ("--prior", "K=18+-0"),
        ("--law-stokes", "zz"), ("--law-stokes", "st"), ("--posterior", "--seed", "-1"), ("--separate",
        "e_dry=source"),
        ("--separate", "e_dry=material"), ("--separate", "K=weight"), ("--bounds", "K=nan:3"), ("--bounds",
        "K=3:1"), ("--bounds", "K=1"),
        ("--bounds", "Q=1:3"), ("--fix", "Q=1"), ("--free", "Q"), ("--e-dry", "2"), ("--e-dry", "nan"),
        ("--stokes", "xx"),
        ("--speed", "xx"), ("--edge", "-1"), ("--conditions", "none.toml"), ("--out", "no/such/f.json"),
        ("--report", "impacts.csv/r"),
        ("--report", ""), ("--out", "impacts.csv"), ("--posterior", "--seed", "x"), ("--wake", "on"), ("--fix",
        "K"), ("--column", "stokes"),
        ("--prior", "K=nan+-1"),
    ]  # fmt: skip
    for option in bad:
        yield tried(
            f"fit {' '.join(option)}",
            {"impacts.csv": inputs.IMPACTS},
            ("fit", "impacts.csv", *LAW, *option),
            names(),
        )
