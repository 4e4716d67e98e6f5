"""The forces without a wall in the Fig. 2 report: drag laws on towed spheres, history laws on one that oscillates.

The comparison is :mod:`restitution.bounce.unbounded`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution import laws
from restitution.bounce import Closures, unbounded
from restitution.laws.drag import STANDARD
from restitution.report.drawing import Drawing, as_text, save, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS = (
    ("#000000", "-"),
    ("#D55E00", (0, (6, 2))),
    ("#0072B2", (0, (1, 1.2))),
    ("#009E73", (0, (8, 2, 1, 2))),
    ("#CC79A7", (0, (3, 1.5))),
    ("#777777", (0, (12, 3))),
)
"""Told apart by the dashes alone."""
RANGES = ((5.0, 20.0), (20.0, 100.0), (100.0, 300.0), (300.0, 1000.0))
_SYMBOLS = {"marker": "s", "ms": 3.5, "mfc": "white", "mec": "black", "ls": "none", "zorder": 4}


def draw() -> Drawing:
    """C_D over that of the standard drag curve against Re; C_D of the oscillating sphere against t/T."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(11.0, 4.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        _drag(left)
        _oscillation(right)
        return save(figure)


def _drag(ax: Axes) -> None:
    Re, C_D = unbounded.measured_drag()
    default, fine = STANDARD(), np.geomspace(*unbounded.REYNOLDS, 300)
    ax.plot(Re, 100 * (C_D / default(Re) - 1), label="Roos & Willmarth 1971, measured", **_SYMBOLS)
    names = [default.name, *(n for n in laws.names("drag") if n not in (default.name, "stokes_1851"))]
    for name, (colour, dashes) in zip(names, LOOKS, strict=False):
        away = 100 * (laws.get(name)(fine, out_of_range="ignore") / default(fine) - 1)
        ax.plot(
            fine, away, color=colour, ls=dashes, label=as_text(name + (", used" if name == default.name else ""))
        )
    ax.set_xscale("log")
    ax.set_ylim(-14, 18)
    ax.set_xlabel(r"Reynolds number  $Re = v d/\nu$  [-]")
    ax.set_ylabel(r"$C_D$ less that of the standard curve  [%]")
    ax.set_title("Drag of towed spheres", loc="left", fontsize=10)
    ax.legend(fontsize=7, loc="upper right")


def _oscillation(ax: Axes) -> None:
    phase, force = unbounded.reference_oscillation()
    ax.plot(phase, force, label="Schneiders et al. 2013, computed", **_SYMBOLS)
    default, fine = Closures(), np.linspace(0, 1, 300)
    names = [default.history.name, *(n for n in laws.names("history") if n != default.history.name), None]
    for name, (colour, dashes) in zip(names, LOOKS, strict=False):
        law = None if name is None else laws.get(name)
        total = unbounded.oscillation(default.drag, law, fine, unbounded.RE_OSCILLATING, unbounded.FREQUENCY)
        label = "no history force" if name is None else name + (", used" if name == default.history.name else "")
        ax.plot(fine, total, color=colour, ls=dashes, label=as_text(label))
    ax.set_ylim(-6.5, 10.5)
    ax.set_xlabel("time over period  $t/T$  [-]")
    ax.set_ylabel(r"force on the fluid over $\rho_f U^2/2\;\pi d^2/4$  [-]")
    ax.set_title(r"A sphere at $u = U\,\sin\,\omega t$, Re 40, $\omega d/U = 3.2$", loc="left", fontsize=10)
    ax.legend(fontsize=7, loc="upper right", ncols=2)


def drag_rows() -> list[dict]:
    """Bias and rms of each drag law by ranges of Re, in per cent, as texts."""
    default = STANDARD.name
    by_range = [{e.law: e for e in unbounded.drag_errors(*bounds)} for bounds in (unbounded.REYNOLDS, *RANGES)]
    return [
        {
            "law": name, "used": name == default,
            "errors": [f"{100 * errors[name].bias:+.1f}, {100 * errors[name].rms:.1f}" for errors in by_range],
        }
        for name in laws.names("drag")
    ]  # fmt: skip


def history_rows() -> list[dict]:
    """First harmonic and rms of each history law, the reference first, as texts."""
    in_velocity, in_acceleration = unbounded.amplitudes(*unbounded.reference_oscillation())
    rows = [
        {"law": "reference", "used": False, "u": f"{in_velocity:.3f}", "du": f"{in_acceleration:.3f}", "rms": ""}
    ]
    for e in unbounded.oscillation_errors():
        rows.append(
            {
                "law": e.history or "none", "used": e.history == Closures().history.name,
                "u": f"{e.in_velocity:.3f} ({100 * (e.in_velocity / in_velocity - 1):+.0f} %)",
                "du": f"{e.in_acceleration:.3f} ({100 * (e.in_acceleration / in_acceleration - 1):+.0f} %)",
                "rms": f"{100 * e.rms:.1f} %",
            }
        )  # fmt: skip
    return rows
