"""The targets by name: what each is, what it takes, and the text it gets."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass, field

from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.export.closure import Closure
from restitution.export.dem import Request, lammps, liggghts, yade
from restitution.export.drops import PROGRAMS, Program
from restitution.export.impacts import Impacts, impacts_of
from restitution.export.languages import LANGUAGES, source_code
from restitution.export.solvers import FILM_CODES, FilmRequest, film_code, mfix, openfoam, openlb
from restitution.export.tables import csv_table, json_record


@dataclass(frozen=True)
class Options:
    """What a user says beside law and target."""

    derivative: bool = False
    bare: bool = False
    conditions: Conditions | None = None
    e_dry: float | None = None
    request: Request = field(default_factory=lambda: Request(0, None, 0.02, (20.0, 1000.0)))
    film: FilmRequest = field(default_factory=FilmRequest)


@dataclass(frozen=True)
class Target:
    """``takes``: which options it needs, in words. ``text`` makes the file's content.

    ``program``: where what it delivers can be measured.
    """

    key: str
    title: str
    takes: str
    text: Callable[[Closure, Options], str]
    program: Program | None = None


def _language(key: str) -> Target:
    language = LANGUAGES[key]
    return Target(
        key,
        f"{language.title}: functions and a self-check; {language.version}",
        "[--derivative]",
        lambda closure, options: source_code(closure, key, options.derivative),
    )


def _impacts(key: str, title: str, takes: str, text: Callable[[Impacts, Request], str]) -> Target:
    """A target that takes the impacts of one pair."""

    def make(closure: Closure, options: Options) -> str:
        return text(impacts_of(closure, options.conditions, options.e_dry, key), options.request)

    return Target(key, title, f"--fluid --sphere, {takes}", make, PROGRAMS.get(key))


def _dem(key: str, title: str, text: Callable[[Impacts, Request], str]) -> Target:
    return _impacts(key, title, "--level 0 --speed V [--within] or --level 1, 2 [--st-range]; [--drop-test]", text)


def _film(key: str) -> Target:
    title = FILM_CODES[key][0]
    takes = "a film law; --fluid --sphere --cells N, where the law takes them --speed V --modulus E"
    return Target(
        key,
        title,
        takes,
        lambda closure, options: film_code(key, closure, options.conditions, options.e_dry, options.film),
    )


TARGETS: dict[str, Target] = {
    target.key: target
    for target in (
        *map(_language, LANGUAGES),
        Target(
            "csv",
            "table of impact speed, St, e_eff and interval for one pair",
            "--fluid --sphere [--bare]",
            lambda closure, options: csv_table(closure, options.conditions, options.e_dry, options.bare),
        ),
        Target(
            "json",
            "all that is known of the law, and a table to check by",
            "[--derivative]",
            lambda closure, options: json_record(closure, options.derivative),
        ),
        _dem("lammps", "LAMMPS granular: constant e; 1: no tension; 2: e(St), Python", lammps),
        _dem(
            "liggghts",
            "LIGGGHTS, CFDEMcoupling: constant e; 1: viscous, refitted; 2: e(St), C++",
            liggghts,
        ),
        _dem("yade", "YADE: constant e; 1: its lubrication law, refitted; 2: e(St), Python", yade),
        _impacts(
            "openfoam",
            "OpenFOAM parcels: rebound at walls",
            "--level 0 --speed V [--within] [--drop-test] or --level 2",
            openfoam,
        ),
        _impacts("mfix", "MFIX keys: constant e", "--level 0 --speed V [--within]", mfix),
        _impacts("openlb", "OpenLB contacts: function of the speed at contact", "--level 2", openlb),
        *map(_film, FILM_CODES),
    )
}


def target(key: str) -> Target:
    """The target of that name; raises :class:`InputError` naming the known ones."""
    if key in TARGETS:
        return TARGETS[key]
    near = difflib.get_close_matches(key, TARGETS, n=1)
    hint = f"did you mean {near[0]}? " if near else ""
    raise InputError(Defect(f"is no target; {hint}known: {', '.join(TARGETS)}", field="--to", value=key))
