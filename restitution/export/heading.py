"""What every exported file says of the law in it: the words, before any comment sign."""

from __future__ import annotations

import textwrap

from restitution import __version__
from restitution.export.closure import Closure
from restitution.stokes import Speed, convention

WIDTH = 108
"""Characters of a line, before the comment sign."""
_SPEEDS = {
    Speed.FAR: "of the motion outside the film, carried to the wall",
    Speed.CONTACT: "extrapolated to the instant of contact",
    Speed.WINDOW: "mean slope over a stated number of frames beside the contact",
    Speed.FILM_EDGE: "at the edge of the elastohydrodynamic film",
    Speed.UNSTATED: "the source does not say which: take the speed before the film acts, and say so",
}


def heading(closure: Closure, target: str, version: str = "") -> list[str]:
    """The lines of the heading, ASCII only, none longer than :data:`WIDTH`."""
    facts = [
        f"{closure.title}  [{closure.name}], written by restitution {__version__} for {target}"
        + (f" ({version})" if version else ""),
        f"law: {closure.text}" if closure.closed else f"law: no closed formula; {closure.text}",
        f"what: {closure.meaning}",
        *(
            f"parameter: {c.name} = {c.value:.9g}{'' if c.unit == '1' else f' {c.unit}'} ({c.origin})"
            + (f"; {c.interval}" if c.interval else "")
            for c in closure.constants
        ),
        *closure.identity,
        *(_impact(closure) if closure.rebound else ("arguments: SI, or dimensionless; all positive, else NaN",)),
        _range(closure),
        f"reference: {closure.reference}",
        f"status: {closure.status}",
    ]
    lines = []
    for fact in facts:
        plain = " ".join(fact.split()).encode("ascii", "backslashreplace").decode()
        lines += textwrap.wrap(plain, WIDTH, subsequent_indent="    ", break_long_words=True)
    return [line.rstrip("\\ ") for line in lines]


def _impact(closure: Closure) -> tuple[str, ...]:
    return (
        f"Stokes number: {closure.convention} = {convention(closure.convention).definition}",
        f"speed: normal relative speed, {closure.speed}: {_SPEEDS[closure.speed]}. It is that of the impact, not "
        "the instantaneous speed during contact",
        _edge(closure),
        "mass and radius: at a wall those of the sphere, m* = m, r* = r; of two equal spheres m/2 and r/2, so "
        "that St doubles at the same relative speed; of unequal ones m1 m2/(m1+m2) and r1 r2/(r1+r2). For pairs "
        "this is lubrication theory (St ~ m* v/r*^2), not a statement of the law's source",
        "e_eff stands for the whole viscous loss: use it where nothing else resolves or models the film, "
        "or the loss is counted twice",
    )


def _edge(closure: Closure) -> str:
    if closure.edge is None:
        return "edge of the film: not stated; the wider the film e_eff stands for, the lower e_eff"
    return (
        f"edge of the film: {closure.edge:g} d. Within it the sphere falls freely, in and out; of another edge "
        "the constants are others ('restitution predict --edge')"
    )


def _range(closure: Closure) -> str:
    low, high = closure.validity
    source = f" ({closure.validity_source})" if closure.validity_source else ""
    beyond = "outside, the formula goes on and the in_range flag is 0"
    if closure.rebound:
        beyond += "; e_eff is held within 0 and e_dry, is 0 for St <= 0, NaN for e_dry outside (0, 1]"
    return f"range: {low:.6g} <= {closure.variables[0]} <= {high:.6g}{source}; {beyond}"
