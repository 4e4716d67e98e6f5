"""A fit in words."""

from __future__ import annotations

from restitution.calibration.result.fit_result import Estimated, FitResult, sources
from restitution.stokes import Speed


def speed_in_words(result: FitResult) -> str:
    """The definition of the impact speed, with the edge of the film where it has one."""
    if result.speed_definition != Speed.FAR or result.edge_d is None:
        return result.speed_definition
    return f"{result.speed_definition}, edge of the film {result.edge_d:g} d"


def describe(result: FitResult) -> list[tuple[str, str]]:
    """The fit in words, as names and what is to be said of each."""
    g = result.goodness
    facts = [
        ("law", f"{result.law.name or 'own formula'}: {result.law.text}"),
        ("Stokes number", f"{result.stokes_convention} in the data, {result.law.convention} in the law"),
        ("impact speed", speed_in_words(result)),
        ("impacts", f"{g.measured} with a rebound, {g.censored} without; sources: {len(sources(result))}"),
    ]
    facts += [(name, f"{value:g} (fixed)") for name, value in result.fixed.items()]
    for p in result.parameters:
        unit = "" if p.unit == "1" else f" {p.unit}"
        words = ", ".join(f"{level} {p.interval_in_words(level)}" for level in p.intervals)
        prior = f"; prior {p.prior}" if p.prior.startswith("normal") else ""
        error = f" +- {_sigma(p)}" if p.mean else ""  # of a standard deviation near zero it would mislead
        facts.append((p.name, f"{p.shown_value:.5g}{unit}{error} ({words}{prior})"))
    for name, (mean, sigma) in result.offsets.items():
        facts.append(("offset", f"{name}: {mean:+.3f} +- {sigma:.3f}"))
    if g.chi_square is not None:
        p_value = "" if g.p_value is None else f", p = {g.p_value:.2g}"
        facts.append(
            ("chi square", f"{g.chi_square:.1f} of {g.degrees_of_freedom} by the quoted errors alone{p_value}")
        )
    facts.append(("largest pull", f"{g.largest_pull:.1f} standard deviations, scatter included"))
    if chain := result.posterior:
        words = f"{chain.walkers} walkers, {chain.steps} steps, seed {chain.seed}, converged"
        facts.append(("posterior", f"{words} (autocorrelation time {max(chain.autocorrelation_time):.0f})"))
        for j, name in enumerate(chain.names):
            ends = ", ".join(f"{level} {x[j][0]:.5g} to {x[j][1]:.5g}" for level, x in chain.intervals.items())
            facts.append((f"  {name}", f"median {chain.median[j]:.5g} ({ends}; prior {chain.priors[name]})"))
    facts += [("note", note) for note in result.notes]
    facts += [("doubt", doubt) for doubt in result.doubts]
    return facts


def _sigma(p: Estimated) -> str:
    return "not known" if p.sigma is None else f"{p.sigma:.2g}"
