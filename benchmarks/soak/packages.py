"""Data packages and schemas, edited."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.outcome import Attempt, sound
from benchmarks.soak.trying import may, names, tried


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
