"""What of a case cannot be run, said field by field; each rule is stated once, here."""

from __future__ import annotations

import math
from collections.abc import Iterator

from restitution import laws
from restitution.cases.case import Case
from restitution.errors import Defect, InputError

FEWEST_CELLS = 6.0
"""Cells a diameter below which the surface of a sphere is no sphere any more."""
_SMALL = 1e-4
"""Speed over the terminal one of Stokes, below which a series is more exact than a logarithm."""
MOST_MACH = 0.5
"""Speed over that of sound, 1/sqrt(3) cells a step, at which a drive cannot be run; from 0.2 on one is doubted."""
HEADROOM_D = 1.0
"""Least distance between sphere and top of the box, in diameters."""


ALONG = ("chaoui_feuillebois_2003", "dance_maxey_2003_rotation", "dance_maxey_2003_coupling_force")
"""Laws of the resistances along the wall; the coupling torque is 3/4 of the coupling force, by reciprocity."""
LARGEST_EPS = 0.13
"""Gap over radius up to which each of them is within 5 % of the exact table, but for the coupling: 0.05, and a
fifth low at 0.13."""


def defects(case: Case, file: str) -> list[Defect]:
    """Everything wrong with a case whose single fields are valid."""
    rules = (
        _fall,
        _release,
        _span,
        _film,
        _along,
        _contact,
        _study,
        *((_resolution, _box) if case.numerics else ()),
    )
    return [
        Defect(rule, file=file, field=field, value=None if value is None else f"{value}")
        for check in rules
        for field, value, rule in check(case)
    ]


Finding = tuple[str, object, str]


def _fall(case: Case) -> Iterator[Finding]:
    if case.sphere.density <= case.fluid.density:
        yield (
            "sphere.density",
            f"{case.sphere.density:g}",
            f"must exceed fluid.density = {case.fluid.density:g}: the sphere would not fall",
        )


def _release(case: Case) -> Iterator[Finding]:
    r = case.release
    for name in ("speed", "ramp"):
        given = getattr(r, name)
        if r.kind == "drive" and given is None:
            yield f"release.{name}", None, "is missing: the drive needs it"
        if r.kind == "rest" and given is not None:
            yield f"release.{name}", f"{given:g}", "is not used by a release from rest: leave it out"
    if r.kind == "rest" and r.along:
        yield "release.along", f"{r.along:g}", "needs the drive: a release from rest has no speed"
    if r.kind == "drive" and r.gap_d <= r.free_below_d:
        yield (
            "release.gap_d",
            f"{r.gap_d:g}",
            f"must exceed free_below_d = {r.free_below_d:g}: no way for the drive",
        )


def _span(case: Case) -> Iterator[Finding]:
    if case.contact is not None and case.run.after_contact is None and case.run.duration is None:
        yield "run.after_contact", None, "is missing: give it, or run.duration"
    if case.contact is None and case.run.after_contact is not None:
        yield (
            "run.after_contact",
            f"{case.run.after_contact:g}",
            "needs a [contact]; without one the run ends there",
        )


def _film(case: Case) -> Iterator[Finding]:
    if case.film.form == "lost_to_grid" and case.film.cut_off_cells is not None:
        yield "film.cut_off_cells", f"{case.film.cut_off_cells:g}", "is not to choose: lost_to_grid has its own"
    if case.film.tension is not None and case.film.form == "none":
        yield "film.tension", f"{case.film.tension:g}", "needs a film that it can tear: film.form is 'none'"
    touches = case.contact is not None and case.contact.mode != "effective"
    if case.floor is None and (case.film.form != "none" or case.film.tangential or touches):
        yield "film.floor", None, "is missing, and no roughness is stated: give the gap in m at which they touch"
    elif case.floor is not None and case.numerics is not None:
        cell = case.sphere.diameter / case.numerics.cells_per_diameter
        if case.floor >= case.film.cut_off * cell:
            cut_off = case.film.cut_off
            rule = f"must lie below the cut-off of {cut_off:g} cells = {cut_off * cell:.3g} m"
            field = "film.floor"
            if case.film.floor is None:
                field = f"{'sphere' if case.sphere.roughness == case.floor else 'wall'}.roughness"
                rule += "; the film ends at the roughness where no film.floor is given"
            yield field, f"{case.floor:g}", rule


def _along(case: Case) -> Iterator[Finding]:
    if not case.film.tangential or case.numerics is None:
        return
    eps = 2 * case.film.cut_off / case.numerics.cells_per_diameter
    if eps > LARGEST_EPS:
        rule = (
            f"resistances along the wall hold to gap/r = {LARGEST_EPS:g}, the cut-off is at {eps:.3g}: more cells"
        )
        yield "film.tangential", "true", rule


def _contact(case: Case) -> Iterator[Finding]:
    c = case.contact
    if c is None:
        return
    if case.sphere.e_dry is None and (c.mode != "effective" or c.law is not None):
        yield "sphere.e_dry", None, f"is missing: the contact mode {c.mode!r} needs it"
    effective = c.mode == "effective"
    if effective and (c.law is None) == (c.measured is None):
        yield "contact.law", None, "give either law or measured with the mode 'effective'"
    if effective and case.film.form != "none":
        rule = "must be 'none' with contact.mode = 'effective', whose e_eff has the film's loss in it already"
        yield "film.form", case.film.form, rule
    if c.measured == "record" and case.record is None:
        yield "contact.measured", "record", "needs the case to name a record"
    used = {"law", "parameters", "measured", "edge_d", "law_edge_d"} if effective else set()
    used |= {"duration_steps"} if c.mode.startswith("soft") else set()
    for name in ("law", "parameters", "measured", "edge_d", "law_edge_d", "duration_steps"):
        if name not in used and getattr(c, name):
            yield f"contact.{name}", getattr(c, name), f"is not used by the mode {c.mode!r}: leave it out"
    if c.mode.startswith("soft") and c.duration_steps is None:
        yield "contact.duration_steps", None, f"is missing: the mode {c.mode!r} needs it"
    if effective and c.law_edge_d is not None and c.law is None:
        yield "contact.law_edge_d", f"{c.law_edge_d:g}", "needs a law: measured values are those of contact.edge_d"
    if effective and c.law is not None:
        yield from _law(c.law, c.parameters, c.law_edge_d)


def _study(case: Case) -> Iterator[Finding]:
    study, contact = case.study, case.contact
    if study is None:
        return
    for name, other in (("varies", "against"), ("against", "varies"), ("order", "varies")):
        if getattr(study, name) is not None and getattr(study, other) is None:
            yield f"study.{other}", None, f"is missing: study.{name} is given"
    if study.unknown and study.against is None:
        yield "study.against", None, "is missing: study.unknown says that the run belongs to the band of another"
    if study.against == case.name:
        yield "study.against", case.name, "is the case itself"
    if study.series is not None and (contact is None or contact.mode == "effective"):
        rule = "is of rebounds that are predicted: give a [contact] whose mode is not 'effective'"
        yield "study.series", study.series, rule


def _law(name: str, parameters: dict[str, float], edge_d: float | None) -> Iterator[Finding]:
    try:
        law = laws.get_rebound(name, **parameters)
    except InputError as error:
        yield "contact.law", name, str(error)
        return
    if edge_d is not None and law.edge not in (None, edge_d):
        yield "contact.law_edge_d", f"{edge_d:g}", f"is not that of {name}, {law.edge:g} d: leave it out"


def _resolution(case: Case) -> Iterator[Finding]:
    n = case.numerics
    if n.cells_per_diameter < FEWEST_CELLS:
        yield (
            "numerics.cells_per_diameter",
            f"{n.cells_per_diameter:g}",
            f"resolves no sphere: at least {FEWEST_CELLS:g}, and 10 for figures to be trusted",
        )
    if case.reference_speed is None:
        yield (
            "numerics.reference_speed",
            None,
            "is missing: a release from rest does not give the speed to scale by",
        )
    elif case.release.speed is not None:
        fastest = math.hypot(case.release.speed, case.release.along)
        mach = math.sqrt(3) * n.lattice_speed * fastest / case.reference_speed
        if mach > MOST_MACH and fastest > case.reference_speed:
            yield (
                "release.along" if case.release.along else "release.speed",
                f"{fastest:g} m/s",
                f"would be {mach:.3g} of the speed of sound: numerics.lattice_speed = {n.lattice_speed:g} "
                f"stands for {case.reference_speed:g} m/s; set numerics.reference_speed to the "
                "fastest speed of the sphere",
            )
    if case.film.cut_off > n.cells_per_diameter / 2:
        yield (
            "film.cut_off_cells",
            f"{case.film.cut_off:g}",
            "is more than a radius: lubrication is a film's",
        )


def _box(case: Case) -> Iterator[Finding]:
    n, gap = case.numerics, case.release.gap_d
    if n.width_d < 2:
        yield "numerics.width_d", f"{n.width_d:g}", "is too narrow: at least 2 diameters"
    if n.symmetry == "quarter" and case.release.along:
        yield (
            "numerics.symmetry",
            n.symmetry,
            "needs a fall along the axis: leave release.along out, or take 'none'",
        )
    if gap + 1 + HEADROOM_D > n.height_d:
        rule = (
            f"puts the top of the sphere at {gap + 1:g} d of numerics.height_d = {n.height_d:g}: "
            f"leave {HEADROOM_D:g} d above it"
        )
        yield "release.gap_d", f"{gap:g}", rule
    needed = rebound_height_d(case) + 1 + HEADROOM_D
    if needed > n.height_d:
        reach = f"which under the drag of Stokes reaches {needed:.1f} d with room above"
        rule = f"cannot hold the rebound, {reach}: raise it"
        yield "numerics.height_d", f"{n.height_d:g}", rule


def rebound_height_d(case: Case) -> float:
    """Gap in diameters to which the first rebound could rise at most.

    It starts with e times the speed v of the drive, or of the fall without drag. Against weight and the drag of
    Stokes, the least there is, a speed u rises by u tau - g tau^2 ln(1 + u/(g tau)), tau = (rho_p + rho_f/2)
    d^2/(18 mu), g the free-fall acceleration; for large tau that is u^2/(2 g).
    """
    c, d = case.contact, case.sphere.diameter
    if c is None:
        return 0.0
    e = max(c.measured) if isinstance(c.measured, tuple) else case.sphere.e_dry or 1.0
    fall, fluid = case.conditions.free_fall, case.fluid
    if fall <= 0:
        return 0.0
    u = e * (math.sqrt(2 * fall * case.release.gap_d * d) if case.release.speed is None else case.release.speed)
    slowing = fall * (case.sphere.density + 0.5 * fluid.density) * d**2 / (18 * fluid.viscosity)
    x = u / slowing
    rise = 0.5 - x / 3 if x < _SMALL else (x - math.log1p(x)) / x**2
    return u**2 * rise / fall / d
