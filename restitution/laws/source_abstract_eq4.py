"""Equation (4) of the source abstract, e_eff of a sphere on a wall: the readings of a text that survives in part.

What is left of the printed equation is "er 18(1 + e)" on one line, e being the dry restitution; the abstract
adds that the law is semi-empirical, rests on the lubrication approximation, depends on the particle Stokes
number at impact and agrees with the measured rebounds. Nobody has the rest, so none of these is *the*
equation. Ranked by the evidence:

1. ``eq4_exponential``: within 0.003 of the published Legendre correlation at e = 0.97 (35.46 against 35);
   (1 + e) is the two-way lubrication factor; practically zero at St = 10, 0.93 e at 500; fits the geometry of
   what survives. About two in three, by judgement.
2. ``eq4_exponential_over_e``: the same within 3 % for steel and glass, different for softer materials.
3. ``eq4_rational``: fits the few shipped rebounds as well or better, but rebounds at any St, against the
   observation that there is none below St of about 10 (Joseph et al. 2001). About one in eight.
4. ``eq4_linear`` and ``eq4_linear_relative``: no rebound below St of about 36, although the rebound at
   St = 27 is on record. Kept so that a report can show that the data reject them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status, parameter
from restitution.laws.rebound import ReboundLaw

_REFERENCE = (
    "Source abstract, Eq. (4), surviving in part (extended abstract on lubrication correction and effective "
    "restitution in lattice-Boltzmann simulation; authors and venue not identified)"
)
_INDEPENDENT = "an earlier comparison of the readings, made without this package, to three digits"


def _K() -> float:
    return parameter(18.0, (0.0, 200.0), "1", "prefactor of (1 + e_dry)", "the surviving '18(1 + e)' of Eq. (4)")


@dataclass(frozen=True)
class _Eq4(ReboundLaw):
    """What the readings share."""

    validity: ClassVar = (10.0, 1000.0)
    validity_source: ClassVar = "range of the experiments it is meant for; the abstract states none"
    reference: ClassVar = _REFERENCE
    status: ClassVar = Status.RECONSTRUCTED


@dataclass(frozen=True)
class Eq4Exponential(_Eq4):
    """e_eff = e_dry exp[-K (1 + e_dry) / St], K = 18: the first-ranked reading."""

    name: ClassVar = "eq4_exponential"
    title: ClassVar = "Eq. (4), exponential reading"
    formula: ClassVar = "e_dry*exp(-K*(1 + e_dry)/St)"
    evidence: ClassVar = "equals the published Legendre correlation within 0.003 at e_dry = 0.97; rank 1"
    checks: ClassVar = (
        CheckValue({"St": 152.8, "e_dry": 0.97}, 0.769, 6e-4, _INDEPENDENT),
        CheckValue({"St": 27.0, "e_dry": 0.97}, 0.261, 6e-4, _INDEPENDENT),
    )
    K: float = _K()


@dataclass(frozen=True)
class Eq4ExponentialOverE(_Eq4):
    """e_eff = e_dry exp[-K (1 + e_dry) / (e_dry St)], K = 18."""

    name: ClassVar = "eq4_exponential_over_e"
    title: ClassVar = "Eq. (4), exponential reading with e in the exponent's denominator"
    formula: ClassVar = "e_dry*exp(-K*(1 + e_dry)/(e_dry*St))"
    evidence: ClassVar = "a variant of the first reading; the exponent is 36.6/St at e_dry = 0.97; rank 2"
    checks: ClassVar = (
        CheckValue({"St": 36.557, "e_dry": 0.97}, 0.35684, 1e-4, "0.97/e where the exponent is 1, by hand"),
    )
    K: float = _K()


@dataclass(frozen=True)
class Eq4Rational(_Eq4):
    """e_eff = e_dry / [1 + K (1 + e_dry) / St], K = 18: no threshold, a rebound at any St."""

    name: ClassVar = "eq4_rational"
    title: ClassVar = "Eq. (4), rational reading"
    formula: ClassVar = "e_dry/(1 + K*(1 + e_dry)/St)"
    evidence: ClassVar = "fits the few shipped rebounds well, but gives 0.21 at St = 10; rank 3"
    checks: ClassVar = (
        CheckValue({"St": 152.8, "e_dry": 0.97}, 0.787, 6e-4, _INDEPENDENT),
        CheckValue({"St": 23.1, "e_dry": 0.97}, 0.383, 6e-4, _INDEPENDENT),
    )
    K: float = _K()


@dataclass(frozen=True)
class Eq4Linear(_Eq4):
    """e_eff = max(0, e_dry - K (1 + e_dry) / St), K = 18: no rebound below St = 36.6, which the data reject."""

    name: ClassVar = "eq4_linear"
    title: ClassVar = "Eq. (4), linear reading (rejected by the data)"
    formula: ClassVar = "Max(0, e_dry - K*(1 + e_dry)/St)"
    evidence: ClassVar = "rejected: no rebound at St = 27, where one is on record"
    checks: ClassVar = (
        CheckValue({"St": 152.8, "e_dry": 0.97}, 0.738, 6e-4, _INDEPENDENT),
        CheckValue({"St": 27.0, "e_dry": 0.97}, 0.0, 0.0, _INDEPENDENT),
    )
    K: float = _K()


@dataclass(frozen=True)
class Eq4LinearRelative(_Eq4):
    """e_eff = max(0, e_dry [1 - K (1 + e_dry) / St]), K = 18: no rebound below St = 35.5."""

    name: ClassVar = "eq4_linear_relative"
    title: ClassVar = "Eq. (4), linear reading of the ratio (rejected by the data)"
    formula: ClassVar = "Max(0, e_dry*(1 - K*(1 + e_dry)/St))"
    evidence: ClassVar = "rejected: no rebound at St = 27, where one is on record"
    checks: ClassVar = (
        CheckValue({"St": 152.8, "e_dry": 0.97}, 0.745, 6e-4, _INDEPENDENT),
        CheckValue({"St": 44.6, "e_dry": 0.97}, 0.199, 6e-4, _INDEPENDENT),
    )
    K: float = _K()


READINGS: tuple[str, ...] = tuple(
    law.name for law in (Eq4Exponential, Eq4ExponentialOverE, Eq4Rational, Eq4Linear, Eq4LinearRelative)
)
"""Their names, by rank."""
