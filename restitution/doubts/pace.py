"""Clock and unit of length by free fall, fluid and sphere by the terminal speed: see :mod:`.falls`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts import falls
from restitution.doubts.doubt import Doubt
from restitution.doubts.stated import HEAVIEST, LIGHT
from restitution.tracks import GRAVITY, Contacts, Track

if TYPE_CHECKING:
    from restitution.conditions import Conditions

SLOW, FAST = 0.65, 2.5
"""Parts of free fall between which the sphere accelerates about its apex, whatever the errors: up to twice as much
where a wake three times as strong as that of the shipped records outlasts the rise."""
MOST_BY_WAKE = 1.2
"""Where the sphere seems faster than its terminal speed as well: no wake that was measured adds a fifth."""
LEAST, MOST = 0.95, 1.04
"""The same where lengths and densities are known to 2 % each. Nothing makes the acceleration less (all shipped
records have 0.95 or more within two errors), and a wake alone makes it more; so beyond three errors less is
doubtful, and more where the approach, which meets no wake, has more as well."""
FILM = 0.1
"""Edge of a film in diameters within which a sphere may fall freely, with the added mass of a touching one."""
_AT_CONTACT = 0.803
"""Added mass of a touching sphere over the displaced mass: (3/2) zeta(3) - 1."""
_DRAG = 0.1
"""Relative error of a law of drag."""
SLOW_AT_FIRST, FAST_AT_FIRST = 0.4, 2.5
"""The same of an approach, where added mass, history and drag differ more."""
BEYOND = 1.3
"""Times the terminal speed above which a sphere does not fall: laws of drag agree to a tenth."""
DRIVEN = 10.0
"""Times the terminal speed that a sphere which is driven into a wall, as by a pendulum, and rebounds is not at."""
_THINNEST = 2e-4
"""Viscosity in Pa s of pentane, below which a liquid is not looked for."""


def of_pace(track: Track, found: Contacts, conditions: Conditions, whole: bool) -> list[Doubt]:
    """Clock and unit by free fall, then fluid and sphere by the terminal speed; ``whole``: so is the approach."""
    g, terminal = abs(conditions.free_fall), _terminal(conditions)
    if g == 0:
        return []
    turning = falls.apexes(track, found)
    coming = falls.approach(track, found) if whole else None
    fast = falls.fastest(track, found)
    lighter = conditions.sphere.density < conditions.fluid.density
    if (share := _share(track, found, turning, coming, conditions, terminal, fast)) is not None:
        nothing = not found.contacts and share < _NOTHING_FALLS
        return [_lighter(share * g, conditions) if lighter else _clock(share, g, conditions, nothing)]
    if fast > BEYOND * terminal:
        return [_lighter(0.0, conditions) if lighter else _too_fast(fast, terminal, conditions, turning)]
    if coming is not None and coming.mean_speed < 0.5 * terminal:
        expected = g * (1 - coming.mean_speed / terminal)
        if coming.error < 0.2 * expected and coming.acceleration < 0.2 * expected:
            return [_lighter(0.0, conditions) if lighter else _too_slow(coming.mean_speed, terminal)]
    return []


def of_speed(speed: float, conditions: Conditions, by_stokes: bool = False) -> list[Doubt]:
    """An impact speed in m/s that is asked for and that no sphere comes to; ``by_stokes``: it follows from St, so
    that an error of the viscosity is in it too.
    """
    terminal, mu = _terminal(conditions), conditions.fluid.viscosity
    if not speed > DRIVEN * terminal:
        return []
    questions = []
    own = speed * (1e-3 if by_stokes else 1.0)
    if 1e-3 * mu > _THINNEST and own <= DRIVEN * _terminal(replace_in(conditions, viscosity=1e-3)):
        questions.append(f'is the viscosity, {mu:g} Pa s, in mPa s (cP)? viscosity = "{mu:g} mPa s"')
    if not by_stokes and speed <= 1e3 * BEYOND * terminal:
        questions.append(f'is the speed in mm/s? "{speed:g} mm/s"')
    message = (
        f"an impact at {speed:.3g} m/s is {speed / terminal:.2g} times as fast as the sphere falls in this fluid "
        f"({terminal:.2g} m/s): {' or '.join(questions) or 'are speed, viscosity, diameter and densities right?'}"
    )
    return [Doubt("speed", message)]


def _share(
    track: Track,
    found: Contacts,
    turning: list[falls.Fall],
    coming: falls.Fall | None,
    conditions: Conditions,
    terminal: float,
    fast: float,
) -> float | None:
    """By how much of free fall the sphere accelerates, where it cannot be so much or so little; else None."""
    g = abs(conditions.free_fall)
    if not turning:
        if coming is None or not coming.mean_speed < 0.5 * terminal:
            return None
        expected = g * (1 - coming.mean_speed / terminal)
        share = max(coming.acceleration, coming.error) / expected
        known = coming.error < 0.2 * expected and share > 0
        return share if known and not SLOW_AT_FIRST <= share <= FAST_AT_FIRST else None
    # Of the surest apex, mostly that of the highest flight, where a wake has the least part.
    surest = min(turning, key=lambda fall: fall.error / abs(fall.acceleration))
    share, error = surest.acceleration / g, surest.error / g
    if share <= 0:
        return None
    low = at_wall(conditions, surest.gap)
    if share < SLOW * low or share + 3 * error < LEAST * low:
        return share
    least = min(turning, key=lambda fall: fall.acceleration + 3 * fall.error)
    if (least.acceleration + 3 * least.error) / g > FAST:
        return share
    mean, sure = _mean(turning, g)
    if fast > BEYOND * terminal:  # a drag that is too strong hides in no apex
        return mean if mean - 3 * sure > MOST_BY_WAKE else None
    first = falls.begin_of_approach(track, found, terminal) if mean - 3 * sure > MOST else None
    if first is None or (drag := (first.mean_speed / terminal) ** _POWER) > _SLOW_DRAG:
        return None
    alike = (first.acceleration - 3 * first.error) / (g * (1 - drag)) - _DRAG * drag
    return mean if alike > MOST else None


def at_wall(conditions: Conditions, gap: float) -> float:
    """The least part of free fall that the added mass leaves a sphere ``gap`` (m) from the wall.

    There it is up to 0.803 of the displaced mass in place of 0.5, in a film whose loss an e_eff stands for all the
    way to its edge; with (r/(r + h))^2.5 between the two, that is potential flow within 0.01. Steel loses 3 %,
    nylon in water 15 %.
    """
    sphere, rho_f = conditions.sphere, conditions.fluid.density
    beyond = max(gap - FILM * sphere.diameter, 0.0)
    near = (0.5 * sphere.diameter / (0.5 * sphere.diameter + beyond)) ** 2.5
    return (sphere.density + 0.5 * rho_f) / (sphere.density + (0.5 + (_AT_CONTACT - 0.5) * near) * rho_f)


def _mean(turning: list[falls.Fall], g: float) -> tuple[float, float]:
    """The mean of all apexes and its error, in parts of free fall; without end where they do not agree."""
    share, error = (np.array([getattr(fall, x) for fall in turning]) / g for x in ("acceleration", "error"))
    weight = error**-2.0 / np.sum(error**-2.0)
    mean = float(weight @ share)
    alike = bool(np.all(np.abs(share - mean) < 3 * error))
    return mean, float(np.sum(error**-2.0) ** -0.5) if alike else math.inf


_SLOW_DRAG = 0.3
"""Part of the weight that drag carries in the slow begin of an approach, at most, for it to tell free fall."""
_POWER = 1.5
"""Of the speed, as which drag grows between the slow fall and that at Re of a few hundred: 1.2 to 1.8."""


_NEAR, _NEAR_EARTH = 0.15, 0.5
"""Relative error of an acceleration, and part of the earth's gravity, by which a stated one is in another unit."""
_NOTHING_FALLS = 1e-2
"""Part of free fall below which a coordinate without any contact is likely another one."""


def _clock(share: float, g: float, conditions: Conditions, nothing: bool = False) -> Doubt:
    rho_f, acceleration = conditions.fluid.density, share * g
    if (
        abs(share * conditions.gravity / GRAVITY - 1) < _NEAR
        and not _NEAR_EARTH < conditions.gravity / GRAVITY < 2
    ):
        words = (
            f"the sphere accelerates in free flight by {acceleration:.3g} m/s2, as it does where gravity is "
            f"{GRAVITY:g} m/s2, and {conditions.gravity:g} is stated: is that in m/s2?"
        )
        return Doubt("clock", words)
    density = ""
    if 0.2 < share < 3:
        density = ", or a density is wrong"
        if acceleration < conditions.gravity:
            density += f" (a sphere of {_density(acceleration, conditions):.3g} kg/m3 falls so in {rho_f:g} kg/m3)"
    of_fall = f"free fall under these conditions ({g:.3g} m/s2)"
    words = f"the sphere accelerates in free flight by {acceleration:.3g} m/s2, "
    if share < 1:
        words += (
            f"1/{1 / share:.3g} of {of_fall}: times are {math.sqrt(1 / share):.3g} times too long (a film played "
            f"slowly: --fps, --time-unit), or lengths {1 / share:.3g} times too small (--unit; dimensionless "
            f"numbers: --unit d){density}"
        )
    else:
        words += (
            f"{share:.3g} times {of_fall}: times are {math.sqrt(share):.3g} times too short (--fps, --time-unit), "
            f"or lengths {share:.3g} times too large (--unit, --pixel){density}"
        )
    if nothing:
        words += "; or is it another coordinate than the one along the wall (--column gap_m=NAME)"
    return Doubt("clock", words)


def _density(acceleration: float, conditions: Conditions) -> float:
    """Of the sphere that falls with it: g (rho_p - rho_f)/(rho_p + rho_f/2), solved for rho_p."""
    g, rho_f = conditions.gravity, conditions.fluid.density
    return rho_f * (g + acceleration / 2) / (g - acceleration)


def _lighter(acceleration: float, conditions: Conditions) -> Doubt:
    own, rho_f, falls_so = conditions.sphere.density, conditions.fluid.density, ""
    if 0 < acceleration < conditions.gravity and (solid := _density(acceleration, conditions)) < HEAVIEST:
        falls_so = f": it comes to the wall with {acceleration:.3g} m/s2, as one of {solid:.3g} kg/m3 does"
    return Doubt(
        "lighter",
        f"a sphere of {own:g} kg/m3 rises in a fluid of {rho_f:g} kg/m3, and this one does not move so{falls_so}: "
        "is its density in g/cm3 (kg/m3 are meant), or are both exchanged?",
    )


def _too_fast(fast: float, terminal: float, conditions: Conditions, turning: list[falls.Fall]) -> Doubt:
    """Of the mistakes that explain the speed, the smallest one."""
    fluid, sphere = conditions.fluid, conditions.sphere
    solid = _heavier(turning, conditions)
    mistakes = [] if solid is None else [solid]
    mistakes += [(replace_in(conditions, diameter=2), f"is the diameter, {sphere.diameter:g} m, the radius?")]
    if 1e-3 * fluid.viscosity > _THINNEST:
        words = (
            f'is the viscosity, {fluid.viscosity:g} Pa s, in mPa s (cP)? viscosity = "{fluid.viscosity:g} mPa s"'
        )
        mistakes.append((replace_in(conditions, viscosity=1e-3), words))
    if fluid.density < LIGHT and sphere.density < LIGHT:
        mistakes.insert(0, (replace_in(conditions, density=1e3), "are the densities in g/cm3 (kg/m3 are meant)?"))
    likely = [question for other, question in mistakes if fast < 1.1 * _terminal(other)]
    thin = _viscosity(fast, conditions)
    if thin and len(likely) < 2 and not any("viscosity" in question for question in likely):
        likely.append(f"{'or ' if likely else ''}is the viscosity, {fluid.viscosity:g} Pa s, {thin:.1g} at most?")
    if not likely:
        likely = [
            f"is the diameter, {sphere.diameter:g} m, {factor:g} times as large ({unit})?"
            for factor, unit in _UNITS
            if fast < 1.1 * _terminal(replace_in(conditions, diameter=factor))
        ]
    question = " ".join(likely[:2]) or _ALL_ASKED
    return Doubt(
        "speed",
        f"the sphere moves at {fast:.3g} m/s, {fast / terminal:.2g} times its terminal speed under these "
        "conditions "
        f"({terminal:.2g} m/s): {question}",
    )


_UNITS = ((10.0, "cm taken for mm"), (25.4, "inch taken for mm"))
"""Units of a diameter that are taken for one another."""


def _heavier(turning: list[falls.Fall], conditions: Conditions) -> tuple[Conditions, str] | None:
    """The conditions with the density of the sphere that all apexes tell, and the question, where that is surely
    greater than the stated one.
    """
    g = abs(conditions.free_fall)
    mean, error = _mean(turning, g) if turning else (1.0, math.inf)
    if not mean - 3 * error > MOST or not mean * g < conditions.gravity:
        return None
    own = conditions.sphere
    solid = _density(mean * g, conditions)
    low, high = (
        _density(min(x, 0.999 * conditions.gravity / g) * g, conditions) for x in (mean - error, mean + error)
    )
    if not own.density < solid < HEAVIEST:
        return None
    other = conditions.model_copy(update={"sphere": own.model_copy(update={"density": solid})})
    within = f"{low:.2g} to {min(high, HEAVIEST):.2g}"
    return (
        other,
        f"is the sphere heavier than {own.density:g} kg/m3 (after a contact it falls as one of {within})?",
    )


_ALL_ASKED = (
    "are the units of length and time right (--unit, --time-unit, --fps), and viscosity, diameter and densities? "
    "Or was the sphere lost and something else followed?"
)


def _viscosity(speed: float, conditions: Conditions) -> float | None:
    """The viscosity in Pa s with which the sphere falls as fast; None where it does not in any thinner liquid."""
    low, high = _THINNEST / conditions.fluid.viscosity, 1.0
    if low > high:
        return None
    if _terminal(replace_in(conditions, viscosity=low)) < speed:
        return None
    for _ in range(40):
        middle = math.sqrt(low * high)
        fast = _terminal(replace_in(conditions, viscosity=middle)) > speed
        low, high = (middle, high) if fast else (low, middle)
    return low * conditions.fluid.viscosity


def _too_slow(speed: float, terminal: float) -> Doubt:
    return Doubt(
        "speed",
        f"the sphere falls steadily at {speed:.3g} m/s, where it reaches {terminal:.2g} m/s under these "
        "conditions: is "
        'the viscosity too small (of a kinematic one write its unit, as in "10 cSt"), the diameter that '
        "of another "
        "sphere, or the vessel narrow?",
    )


def replace_in(
    conditions: Conditions, viscosity: float = 1, diameter: float = 1, density: float = 1
) -> Conditions:
    """The conditions with some numbers multiplied."""
    fluid, sphere = conditions.fluid, conditions.sphere
    own = {"density": density * fluid.density, "viscosity": viscosity * fluid.viscosity}
    of_sphere = {"density": density * sphere.density, "diameter": diameter * sphere.diameter}
    return conditions.model_copy(
        update={"fluid": fluid.model_copy(update=own), "sphere": sphere.model_copy(update=of_sphere)}
    )


def _terminal(conditions: Conditions) -> float:
    """The terminal speed; of a sphere lighter than the fluid that of its rise, inf where it neither falls
    nor rises.
    """
    from restitution.laws.drag import STANDARD, steady

    c = conditions
    weight = abs(c.sphere.density - c.fluid.density) * math.pi * c.sphere.diameter**3 / 6 * c.gravity
    if weight == 0:
        return math.inf
    return steady(STANDARD(), weight, c.sphere.diameter, c.fluid.density, c.fluid.viscosity)
