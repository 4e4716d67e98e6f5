"""Files of users and options, spoiled by hand and at random: refused by name, or used with finite results."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.inputs import LAW, PAIR, STATED
from benchmarks.soak.outcome import Attempt, Outcome, either, noted, refused, sound
from benchmarks.soak.running import Done, Workshop

Judge = Callable[[Done], Outcome]


def tried(
    name: str, files: dict[str, str | bytes], command: Iterable[str], judge: Judge, before: Iterable[str] = ()
) -> Attempt:
    """A command on files, after another one that makes what it needs."""

    def make(shop: Workshop) -> Outcome:
        for file, content in files.items():
            shop.write(file, content)
        if before:
            made = sound(shop.command(*before))
            if made.kind != "clean":
                return made
        return judge(shop.command(*command))

    return Attempt(name, make)


def names(*texts: str, left: Iterable[str] = ()) -> Judge:
    """Refused, with these in what is said."""
    return lambda done: refused(done, texts, left)


def may(*texts: str) -> Judge:
    """Refused with these in what is said, or used."""
    return lambda done: either(done, texts)


IMPACTS_OF = ("impacts", "track.csv", "--conditions", "conditions.toml", "--out", "out.csv")


def tracks(random: Random) -> Iterator[Attempt]:
    """Camera tracks."""
    good = inputs.track()
    about = {"conditions.toml": inputs.CONDITIONS}
    for cell, column in product(inputs.WORSE, (0, 1)):
        bad = {"track.csv": inputs.with_cell(good, 7, column, cell)} | about
        # an empty cell, or nan, is a lost frame
        yield tried(f"track cell {cell[:9]!r}", bad, IMPACTS_OF, may("track.csv"))
    floods = {"rows": "time_s,gap_m\n" + "".join(f"{k},{k}x\n" for k in range(100_000)),
              "columns": ",".join(f"c{k}" for k in range(200_000)) + "\n", "empty": "", "header": "time_s,gap_m\n",
              "digits": f"time_s,gap_m\n0,{'9' * 5000}\n",
              "backwards": "\n".join(good.splitlines()[:1] + good.splitlines()[:0:-1])}  # fmt: skip
    for name, text in floods.items():
        yield tried(f"track {name}", {"track.csv": text} | about, IMPACTS_OF, names("track.csv", left=["out.csv"]))
    scaled = "time_s,gap_m\n" + "".join(
        f"{t},{float(gap) * 1e200:g}\n" for t, gap in (line.split(",") for line in good.splitlines()[1:])
    )
    yield tried("track of gaps of 1e200 m", {"track.csv": scaled} | about, IMPACTS_OF, may("track.csv"))
    while True:
        yield tried(
            "track at random", {"track.csv": inputs.spoiled(good, random)} | about, IMPACTS_OF, may("track.csv")
        )


def conditions(random: Random) -> Iterator[Attempt]:
    """Conditions in TOML."""
    track = {"track.csv": inputs.track()}
    for change, field in (("density = 7800.0", "density = 800.0"), ("viscosity = 0.01", "viscosity = 10.0"),
                          ("viscosity = 0.01", "viscosity = 1e-12"), ("diameter = 0.003",
                          "diameter = 3.0")):  # fmt: skip
        text = inputs.CONDITIONS.replace(change, field)
        yield tried(f"conditions with {field}", {"conditions.toml": text} | track, IMPACTS_OF, noted)
    whole = {"deep": "a = " + "[" * 2000 + "]" * 2000, "dotted": "a." * 30_000 + "a = 1", "empty": "",
             "digits": f"a = {'9' * 5000}", "hexadecimal": f"a = 0x{'f' * 6000}", "twice": inputs.CONDITIONS * 2,
             "latin": inputs.CONDITIONS.replace("[", "# \udce9\n[", 1)}  # fmt: skip
    for name, text in whole.items():
        yield tried(
            f"conditions {name}",
            {"conditions.toml": text} | track,
            IMPACTS_OF,
            names("conditions.toml", left=["out.csv"]),
        )
    lines = [line.split(" = ")[0] for line in inputs.CONDITIONS.splitlines() if " = " in line]
    choices = list(product(lines, inputs.WORSE_TOML))
    random.shuffle(choices)
    for field, value in choices[:20]:
        text = re.sub(rf"\b{field} = .*", f"{field} = {value}", inputs.CONDITIONS, count=1)
        yield tried(
            f"conditions {field} = {value[:9]}",
            {"conditions.toml": text} | track,
            IMPACTS_OF,
            names("conditions.toml"),
        )
    while True:
        text = inputs.spoiled(inputs.CONDITIONS, random)
        yield tried("conditions at random", {"conditions.toml": text} | track, IMPACTS_OF, may("conditions.toml"))


def cases(random: Random) -> Iterator[Attempt]:
    """Cases in TOML, through the point particle, and through the solver where they are to be refused."""
    both = (("bounce", "case.toml", "--out", "out"), ("simulate", "case.toml", "--out", "out"))
    changes = {
        'name = "../outside"\n': "", 'name = "/tmp/outside"\n': "", 'name = ""\n': "", 'name = "a\\u0000b"\n': "",
        f'base = "{"x" * 300}"\n': "", "speed = 1e300": "speed = 0.5", "height_d = 1e308": "height_d = 7.0",
        f"density = {'9' * 5000}": "density = 1150", "after_contact = -1": "after_contact = 0.05",
        'law = "eq5"': 'law = "legendre_2005"', 'mode = "soft"': 'mode = "effective"',
        'mode = "effective"\nadded_mass = 1e9': 'mode = "effective"',
        "cells_per_diameter = 0": "cells_per_diameter = 6",
        "density = 1.0": "density = 7800", "viscosity = 0.0": "viscosity = 0.05", "gap_d = nan": "gap_d = 2.0",
    }  # fmt: skip
    for (new, old), command in product(changes.items(), both):
        text = inputs.CASE.replace(old, new, 1) if old else new + inputs.CASE
        if command[0] == "bounce" and new.startswith(('mode = "effective', "cells_")):
            continue  # not asked by the point particle, which says so
        yield tried(
            f"{command[0]} {new.strip()[:30]!r}",
            {"case.toml": text},
            command,
            names("case.toml", left=["out", "../outside"]),
        )
    too_long = inputs.CASE.replace("after_contact = 0.05", "after_contact = 1e9")
    yield tried("bounce of 1e9 s", {"case.toml": too_long}, both[0], names("case.toml"))
    slow = inputs.CASE.replace("viscosity = 0.05", "viscosity = 10.0").replace(
        'kind = "drive"\ngap_d = 2.0\nspeed = 0.5\nramp = 0.008', 'kind = "rest"\ngap_d = 2.0').replace(
        "lattice_speed = 0.05", "lattice_speed = 0.05\nreference_speed = 0.5")  # fmt: skip
    yield tried("simulate that never arrives", {"case.toml": slow}, both[1], noted)
    while True:
        text = inputs.spoiled(inputs.CASE, random)
        yield tried("case at random", {"case.toml": text}, both[0], may("case.toml"))


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


FLUID_REST = "viscosity=0.01"


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


def packages(random: Random) -> Iterator[Attempt]:
    """Data packages and schemas, edited."""
    from restitution import datasets

    content = json.loads((datasets.folder() / "datapackage.json").read_text())
    resource = content["resources"][0]
    small = content | {"resources": [resource]}
    path = resource["path"]
    files = {path: (datasets.folder() / path).read_bytes()}
    files |= {f"schemas/{p.name}": p.read_bytes() for p in (datasets.folder() / "schemas").iterdir()}
    validate = ("data", "validate", ".")
    yield tried("package that is good", files | {"datapackage.json": json.dumps(small)}, validate, sound)
    for value in ("a\0b", "", "../x", "/etc/passwd", "a\nb", "http://example.org/x.csv", 3):
        text = json.dumps(inputs.edited(small, ("resources", 0, "path"), value))
        yield tried(
            f"package path {value!r:.12}", files | {"datapackage.json": text}, validate, names("datapackage.json")
        )
    twice = json.dumps(small)[:-1] + ', "resources": []}'
    yield tried(
        "package with resources twice", files | {"datapackage.json": twice}, validate, names("datapackage.json")
    )
    schema = json.loads((datasets.folder() / "schemas" / "trajectory.json").read_text())
    for rules in ({"strictly_increasing": ["nothing"]}, {"unique": [["time_s", "nothing"]]}):
        text = json.dumps(schema | {"restitution:rules": rules})
        yield tried(
            f"schema {rules}",
            files | {"datapackage.json": json.dumps(small), "schemas/trajectory.json": text},
            validate,
            names("trajectory.json"),
        )
    repeated = json.dumps(schema | {"fields": schema["fields"] + schema["fields"][:1]})
    yield tried(
        "schema with a field twice",
        files | {"datapackage.json": json.dumps(small), "schemas/trajectory.json": repeated},
        validate,
        names("trajectory.json"),
    )
    yield tried(
        "package nested deep", files | {"datapackage.json": "[" * 5000}, validate, names("datapackage.json")
    )
    spots = list(inputs.places(small))
    while True:
        text = json.dumps(inputs.edited(small, random.choice(spots), random.choice((*inputs.WORSE_JSON, ...))))
        yield tried("package edited", files | {"datapackage.json": text}, validate, may())
        text = inputs.spoiled(files["schemas/trajectory.json"], random)
        yield tried(
            "schema at random",
            files | {"datapackage.json": json.dumps(small), "schemas/trajectory.json": text},
            validate,
            may(),
        )
