"""The report of a fit: figure, tables, page and the record itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.files import write_folder
from restitution.tables.writing import rows_text

if TYPE_CHECKING:
    from restitution.calibration.result.fit_result import FitResult


def write(
    folder: str | Path,
    result: FitResult,
    template: str = "fit.html.j2",
    more: Mapping[str, str | bytes] | None = None,
    out: str | None = None,
    **content: object,
) -> list[str]:
    """Write the report into ``folder``; returns the names of the files.

    ``more`` are further files, ``out`` is a second place for the record itself; ``content`` is what a ``template``
    that extends the fit's own needs besides.
    """
    from restitution.report.fits import plot
    from restitution.report.page import render

    drawing = plot.draw(result)
    page = render(
        template,
        title=f"Fit of {result.law.name or result.law.text}",
        command="restitution fit DATA --report FOLDER",
        fit=result,
        figure=drawing.svg,
        alternative=_alternative(result),
        equation_latex=_latex(result),
        rises=_separable(result),
        influenced=_influenced(result),
        **content,
    )
    files = {
        "figure.svg": drawing.svg,
        "figure.png": drawing.png,
        "parameters.csv": _parameters(result),
        "impacts.csv": _impacts(result),
        "fit.json": result.to_json(),
        **(more or {}),
        "index.html": page,
    }
    write_folder(folder, files, {} if out is None else {out: result.to_json()})
    return list(files)


def _latex(result: FitResult) -> str | None:
    """The law's equation; a formula of the user's own is shown as it was written."""
    from restitution import laws

    law = laws.get(result.law.name) if result.law.name else None
    return law.latex() if law is not None and law.formula else None


def _separable(result: FitResult) -> str:
    """In words, whether the quoted errors explain the distances from the law."""
    g = result.goodness
    if g.chi_square is None or g.p_value is None:
        return "Errors of e_eff are not given for all impacts: whether they explain the distances is not known."
    verdict = "explain" if g.p_value > 0.05 else "do not explain"
    return (
        f"By the quoted errors alone chi square is {g.chi_square:.1f} for {g.degrees_of_freedom} degrees of "
        f"freedom (p = {g.p_value:.2g}): they {verdict} the distances from the law."
    )


def _alternative(result: FitResult) -> str:
    """What the figure shows, in words with its own numbers."""
    measured = [p for p in result.points if p.e_eff is not None]
    low, high = min(p.stokes for p in measured), max(p.stokes for p in measured)
    return (
        f"{len(measured)} measured e_eff against the Stokes number from {low:.3g} to {high:.3g}, the fitted law "
        f"with its 95 % band, and below the residuals over their standard deviations, the largest "
        f"{result.goodness.largest_pull:.1f}"
    )


def _influenced(result: FitResult) -> list[str]:
    """Parameters of which it is known how each impact moves them."""
    return list(dict.fromkeys(name for p in result.points for name in p.influence))


def _parameters(result: FitResult) -> str:
    headings = ("parameter", "value", "sigma", "unit", "low_68", "high_68", "low_95", "high_95", "prior")
    rows = [
        (p.name, p.value, p.sigma, p.unit, *p.intervals["68%"], *p.intervals["95%"], p.prior)
        for p in result.parameters
    ]
    return rows_text(headings, rows)


def _impacts(result: FitResult) -> str:
    columns = (
        "file",
        "row",
        "source",
        "stokes",
        "stokes_sigma",
        "e_eff",
        "e_eff_sigma",
        "e_eff_upper",
        "predicted",
        "residual",
        "sigma",
        "pull",
    )
    moved = _influenced(result)
    rows = [[*(getattr(p, name) for name in columns), *(p.influence.get(m) for m in moved)] for p in result.points]
    return rows_text((*columns, *(f"influence_{name}" for name in moved)), rows)
