"""Where cases come from: a TOML file of the user's, or one shipped with the package, by name.

A file may name a ``base``, a shipped case or a file beside it, whose keys it then replaces one by one. A section
that says anew of which kind it is (``form`` of a film, ``mode`` of a contact, ``kind`` of a release) replaces that
of the base as a whole, its keys depending on it. What the base says to readers (``title``, ``note``, ``study``) is
of the base alone.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from restitution import datasets
from restitution.cases.case import Case
from restitution.cases.rules import defects
from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import read_toml

FOLDER = Path(__file__).parent / "shipped"
TEMPLATE = Path(__file__).parent / "template.toml"
"""An example with every key explained."""
_KIND = {"film": "form", "contact": "mode", "release": "kind"}
_OWN = ("title", "note", "study")
_DEEPEST = 5


def names() -> list[str]:
    """The names of the shipped cases."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def read_case(given: str | Path) -> Case:
    """A case to be run.

    Parameters
    ----------
    given : path of a TOML file, or the name of a shipped case (:func:`names`).

    Returns
    -------
    The case, complete: keys of its ``base`` and conditions of its ``record`` filled in.

    Raises
    ------
    InputError : naming every field that is wrong, and every combination that cannot be run.
    """
    path = find(given)
    case = case_of(content_of(path), str(path))
    _check_study(case, path)
    return case


def content_of(given: str | Path) -> dict[str, Any]:
    """The keys of a case file over those of its base, as they were written; ``name`` is that of the file."""
    path = find(given)
    content = _content(path)
    content.setdefault("name", path.stem)
    return content


def case_of(content: dict[str, Any], file: str, runnable: bool = True) -> Case:
    """A case of its keys, the conditions of its record filled in.

    Raises :class:`InputError` naming every field of ``file`` that is wrong and, where it is to be ``runnable``,
    every combination that cannot be run.
    """
    content = dict(content)
    _with_record(content, file)
    try:
        case = Case.model_validate(content)
    except ValidationError as error:
        raise InputError(*defects_of(error, file)) from None
    found = defects(case, file) if runnable else []
    if found:
        raise InputError(*found)
    return case


def find(given: str | Path) -> Path:
    """The file of a case: as given, or the shipped one of that name."""
    path = Path(given)
    if not str(given).strip():
        raise InputError("name a case: a TOML file or a shipped one ('restitution cases list')")
    if _is(path.is_file):
        return path
    known = names()
    if str(given) in known:
        return FOLDER / f"{given}.toml"
    if _is(path.is_dir):
        raise InputError(Defect("is a folder; name the case's TOML file", file=str(given)))
    near = difflib.get_close_matches(path.stem, known, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(near)}?" if near else "'restitution cases list' names those"
    if (case := of_record().get(plain(str(given)))) is not None:
        hint = f"{case.record} is a record, its case is {case.name}"
    raise InputError(Defect(f"is no file and no shipped case; {hint}", file=str(given)))


@cache
def of_record() -> dict[str, Case]:
    """The first shipped case with a contact of each record, by the names a record goes by (:func:`plain`)."""
    known: dict[str, Case] = {}
    for case in map(read_case, names()):
        if case.record and case.contact is not None:
            for short in (case.record, re.sub(r"(?<=[a-z])\d{4}_", "_", case.record)):
                known.setdefault(plain(short), case)
    return known


def plain(name: str) -> str:
    """A name in lower case, dashes for strokes."""
    return name.lower().replace("_", "-")


def _content(path: Path, depth: int = 0) -> dict[str, Any]:
    """The keys of a file over those of its base."""
    content = read_toml(path)
    base = content.pop("base", None)
    if base is None:
        return content
    if not isinstance(base, str) or depth == _DEEPEST:
        rule = "must be the name of a case" if depth < _DEEPEST else f"more than {_DEEPEST} bases deep: a circle?"
        raise InputError(Defect(rule, file=str(path), field="base", value=str(base)))
    try:
        below = _content(_named_in(path, base), depth + 1)
    except InputError as error:
        if error.defects[0].file != base:
            raise  # it is about what stands in the base
        raise InputError(Defect(error.defects[0].rule, file=str(path), field="base", value=base)) from None
    return over(below, content)


def _named_in(path: Path, name: str) -> Path:
    """The file of the case that the file ``path`` names: one beside it, or a shipped one."""
    beside = path.parent / f"{name.removesuffix('.toml')}.toml"
    return beside if _is(beside.is_file) else find(name)


def _is(asked: Callable[[], bool]) -> bool:
    """What a path says it is; one whose name is too long for any raises instead."""
    try:
        return asked()
    except OSError:
        return False


def _check_study(case: Case, path: Path) -> None:
    """Refuse a study against a case that is not there."""
    if case.study is None or case.study.against is None:
        return
    try:
        _named_in(path, case.study.against)
    except InputError as error:
        rule, against = error.defects[0].rule, case.study.against
        raise InputError(Defect(rule, file=str(path), field="study.against", value=against)) from None


def over(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """``above`` over the keys of a base, sections key by key but those that say anew of which kind they are."""
    merged = {key: value for key, value in below.items() if key not in _OWN}
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = {**merged[key], **value} if both and _KIND.get(key) not in value else value
    return merged


def nested(change: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys as the tables that they stand for."""
    found: dict[str, Any] = {}
    for name, value in change.items():
        *sections, key = name.split(".")
        place = found
        for section in sections:
            place = place.setdefault(section, {})
        if isinstance(value, dict) and isinstance(place.get(key), dict):
            place[key] |= value
        else:
            place[key] = value
    return found


def _with_record(content: dict[str, Any], file: str) -> None:
    """Fill fluid, sphere, wall and gravity, and what the record states of the release, from the case's record."""
    name = content.get("record")
    if not isinstance(name, str):
        return
    try:
        record = datasets.resource(name)
    except InputError as error:
        raise InputError(Defect(str(error), file=file, field="record")) from None
    if record.conditions is None:
        rule = "is a reference table, not a record with fluid and sphere"
        raise InputError(Defect(rule, file=file, field="record", value=name))
    stated = record.conditions.model_dump(include={"fluid", "sphere", "wall", "gravity"}, exclude_none=True)
    for key, value in stated.items():
        given = content.get(key)
        if isinstance(value, dict) and isinstance(given, dict):
            content[key] = {**value, **given}
        else:
            content.setdefault(key, value)
    release = content.get("release")
    if not isinstance(release, dict):
        return
    if "release_gap_m" in record.quoted:
        gap = record.quoted["release_gap_m"] / record.conditions.sphere.diameter
        content["release"] = release = {"gap_d": round(gap, 6), **release}
    if release.get("kind") == "drive" and record.conditions.impact is not None:
        content["release"] = {"speed": record.conditions.impact.speed, **release}
