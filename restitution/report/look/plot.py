"""The picture of a track: the whole of it above, the contacts from near and the velocity below."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.report.drawing import Drawing, save, style
from restitution.report.look.view import Touch, View

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_POINTS = 1600
"""Symbols of one panel: of a longer record the lowest and the highest frame of every stretch are drawn."""
_LATE = 1e2
"""Times in s from which the axis counts from the first second of the record."""
_APART = 0.05
"""Part of an axis that two labels must be apart."""
_IN_AIR = 0.05
"""Part of the way seen by which a contact lies above the wall that is drawn where it is."""
_COLUMNS, _BELOW = 125, 155
"""Characters of a line of the title, and of the remarks."""
_FRAME = {"ls": "none", "marker": "o", "mfc": "white", "mec": "black", "mew": 0.7}
_BOX = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
_READ = {"color": "#0072B2", "lw": 2.0}


def draw(view: View, title: str, remarks: Sequence[str] = ()) -> Drawing:
    """The picture; ``title`` says what it is of, ``remarks`` are written below, each a paragraph."""
    from matplotlib.figure import Figure

    lines = [line for text in remarks for line in textwrap.wrap(text, _BELOW, subsequent_indent="   ")]
    below = 0.19 * len(lines) + 0.1 if lines else 0.01
    with style():
        figure = Figure(figsize=(9.6, 7.4 + below), layout="constrained")
        top, bottom = np.ravel(figure.subfigures(2, 1, height_ratios=(7.4, below)))
        axes = _Axes(view)
        if view.track.quantity == "gap":
            panels = top.subplot_mosaic([["all", "all"], ["near", "speed"]], height_ratios=(1.35, 1))
            axes.gap(panels["all"], None)
            axes.near(panels["near"])
            axes.speed(panels["speed"])
            panels["all"].legend(fontsize=8, loc="upper right", ncols=2)
        else:
            panels = {"all": top.subplots()}
            axes.velocities(panels["all"])
            panels["all"].legend(fontsize=8, loc="upper right", ncols=2)
        top.suptitle("\n".join(textwrap.wrap(title, _COLUMNS)), fontsize=9.5, x=0.01, ha="left")
        if lines:
            bottom.text(0.012, 0.99, "\n".join(lines), fontsize=8.5, va="top", ha="left")
        return save(figure, dpi=120)


class _Axes:
    """The panels over one clock, in one unit of length."""

    def __init__(self, view: View):
        self.view = view
        time, value = view.track.time_s, view.track.value
        first = float(time[0])
        self.zero = float(np.floor(first)) if abs(first) >= _LATE else 0.0
        long = view.track.quantity == "gap" and np.max(np.abs(value)) >= 1.0
        self.scale, self.unit = (1.0, "m") if long or view.track.quantity == "velocity" else (1e3, "mm")

    def gap(self, ax: Axes, window: tuple[float, float] | None) -> None:
        """Frames, wall, contacts, what they were read as and apexes; ``window`` is that in time, None: all."""
        view, k = self.view, self.scale
        level = (view.level or 0.0) * k
        t, y = view.track.time_s - self.zero, view.track.value * k
        within = slice(None) if window is None else (t >= window[0]) & (t <= window[1])
        shown = thinned(t[within], y[within])
        size = 3.2 if len(shown[0]) < 400 else 2.0
        ax.plot(*shown, **_FRAME, ms=size, label=self._frames(len(shown[0])), zorder=2)
        if len(view.left_out.time_s):
            at = view.left_out.time_s - self.zero
            ax.plot(at, view.left_out.value * k, "x", color="black", ms=7, mew=1.6, label="left out", zorder=4)
        for number, branch in enumerate(view.branches):
            time = np.linspace(branch.begin, branch.end, 60)
            look = _READ | ({"ls": (0, (4, 1.2))} if branch.rebound else {"ls": "-"})
            name = ("rebound" if branch.rebound else "approach") + " as read by impacts"
            first = all(b.rebound != branch.rebound for b in view.branches[:number])
            label = name if first else None
            ax.plot(time - self.zero, branch.value(time, "gap") * k, **look, label=label, zorder=3)
        for number, flight in enumerate([f for f in view.flights if np.isfinite(f.top_m)]):
            time, gap = flight.parabola()
            label = None if number else f"parabola of a flight's upper half{self._free_fall()}"
            ax.plot(time - self.zero, gap * k, color="black", lw=1.1, ls=":", label=label, zorder=3.5)
            ax.plot(flight.top_s - self.zero, flight.top_m * k, "_", color="black", ms=14, mew=1.4, zorder=4)
        ax.axhspan(level - 1e3, level, facecolor="#eeeeee", edgecolor="#999999", hatch="////", lw=0, zorder=0)
        rest = (
            f"wall, where it rests ({level:.2g} {self.unit})".replace("-", "\N{MINUS SIGN}")
            if view.level is not None
            else "wall"
        )
        ax.axhline(level, color="black", lw=1.0, label=rest, zorder=1)
        self._touches(ax, [self._height(touch, level) for touch in view.touches])
        ax.set_ylabel(f"{self._name()}  [{self.unit}]")
        ax.set_xlabel(self._clock())
        low, high = min(level, float(np.min(shown[1]))), max(level, float(np.max(shown[1])))
        span = high - low or 1.0
        ax.set_ylim(low - 0.17 * span, high + 0.3 * span)
        if window is None:
            self._apexes(ax)

    def near(self, ax: Axes) -> None:
        """The contacts from near: the lower flights, and the edge of the film."""
        view, k = self.view, self.scale
        level = (view.level or 0.0) * k
        if not view.touches:
            ax.set_axis_off()
            ax.text(0.5, 0.5, "no contact was found", ha="center", va="center")
            return
        times = [touch.time_s - self.zero for touch in view.touches]
        long = (times[-1] - times[0]) or 0.4 * np.ptp(view.track.time_s)
        window = (times[0] - 0.12 * long, times[-1] + 0.25 * long)
        self.gap(ax, window)
        tops = sorted((f.top_m * k - level for f in view.flights if np.isfinite(f.top_m)), reverse=True)
        height = tops[min(1, len(tops) - 1)] if tops else 0.2 * float(np.max(view.track.value) * k - level)
        film = 0.0 if view.film_m is None else view.film_m * k
        height = max(1.5 * height, 2.5 * film)
        if film:
            ax.axhline(level + film, color="black", lw=1.0, ls=(0, (1, 3)))
        ax.set_xlim(*window)
        ax.set_ylim(level - 0.24 * height, level + height)
        if np.min(view.track.value) * k > level + height:
            ax.text(0.5, 0.5, "no frame is near the wall", transform=ax.transAxes, ha="center")
        above = f"; dotted: the film of {film:.2g} {self.unit}, speeds are of frames above" if film else ""
        ax.set_title(f"near the wall{above}", loc="left", fontsize=9)
        ax.locator_params(axis="x", nbins=5)

    def speed(self, ax: Axes) -> None:
        """Slopes of the gap, and the terminal speed."""
        time, slope = self.view.velocity()
        ax.plot(time - self.zero, slope, **_FRAME, ms=2.6)
        ax.axhline(0, color="black", lw=0.8)
        self._terminal(ax, slope)
        ax.set_ylabel("mean velocity  [m/s]")
        ax.set_xlabel(self._clock())
        ax.set_title("velocity, away from the wall", loc="left", fontsize=9)

    def velocities(self, ax: Axes) -> None:
        """A record of velocities: frames, contacts, what they were read as."""
        view = self.view
        shown = thinned(view.track.time_s - self.zero, view.track.value)
        ax.plot(*shown, **_FRAME, ms=3.2, label=self._frames(len(shown[0])), zorder=2)
        if len(view.left_out.time_s):
            ax.plot(view.left_out.time_s - self.zero, view.left_out.value, "x", color="black", label="left out")
        for number, branch in enumerate(view.branches):
            time = np.linspace(branch.begin, branch.end, 60)
            first = all(b.rebound != branch.rebound for b in view.branches[:number])
            name = ("rebound" if branch.rebound else "approach") + " as read by impacts"
            look = _READ | ({"ls": (0, (4, 1.2))} if branch.rebound else {"ls": "-"})
            value = branch.value(time, "velocity")
            ax.plot(time - self.zero, value, **look, label=name if first else None, zorder=3)
        ax.axhline(0, color="black", lw=0.8)
        low, high = ax.get_ylim()
        ax.set_ylim(low - 0.12 * (high - low), high + 0.25 * (high - low))
        self._terminal(ax, view.track.value)
        self._touches(ax, [ax.get_ylim()[0] + 0.09 * (high - low)] * len(view.touches))
        ax.set_ylabel("velocity, away from the wall  [m/s]")
        ax.set_xlabel(self._clock())

    def _terminal(self, ax: Axes, seen: NDArray) -> None:
        speed = self.view.terminal
        if speed is None or not len(seen):
            return
        ax.axhline(-speed, color="black", lw=1.0, ls=(0, (6, 2)))
        low, high = ax.get_ylim()
        at = ax.get_xlim()[1]
        ax.text(at, -speed, f"terminal speed {speed:.2g} m/s", fontsize=7.5, ha="right", va="bottom")
        ax.set_ylim(min(low, -1.15 * speed), high)

    def _touches(self, ax: Axes, heights: Sequence[float]) -> None:
        """A triangle at each contact with its number and e; hollow where impacts have no row of it."""
        last_number = last_e = -np.inf
        span = np.ptp([touch.time_s for touch in self.view.touches]) if len(self.view.touches) > 1 else 1.0
        for touch, level in zip(self.view.touches, heights, strict=True):
            at = touch.time_s - self.zero
            face = "black" if touch.read else "white"
            ax.plot(at, level, "^", ms=7, mfc=face, mec="black", zorder=5)
            if (at - last_number) < 0.02 * span:
                continue
            words = touch.e if at - last_e > 2.4 * _APART * np.ptp(self.view.track.time_s) else ""
            text = f"{touch.number}" + (f"\n{words}" if words else "")
            look = {"textcoords": "offset points", "ha": "center", "va": "top", "fontsize": 8, "clip_on": True}
            ax.annotate(text, (at, level), xytext=(0, -6), bbox=_BOX, zorder=6, **look)
            last_number, last_e = at, at if words else last_e

    def _height(self, touch: Touch, level: float) -> float:
        """Where a contact is drawn: at the wall, or in mid-air where its frame is."""
        value, span = touch.value * self.scale, np.ptp(self.view.track.value) * self.scale
        return value if value - level > _IN_AIR * span else level

    def _apexes(self, ax: Axes) -> None:
        """Height and acceleration of the flights that are wide enough for it."""
        wide, last = np.ptp(self.view.track.time_s), -np.inf
        for flight in self.view.flights:
            if not np.isfinite(flight.top_m) or flight.top_s - last < 3 * _APART * wide:
                continue
            text = f"{flight.top_m * self.scale:.3g} {self.unit}\n−{-flight.acceleration:.3g} m/s²"
            look = {"textcoords": "offset points", "ha": "center", "va": "bottom", "fontsize": 8}
            at = (flight.top_s - self.zero, flight.top_m * self.scale)
            ax.annotate(text, at, xytext=(0, 5), **look)
            last = flight.top_s

    def _free_fall(self) -> str:
        fall = self.view.free_fall
        return "" if fall is None else f" (free fall: −{fall:.3g} m/s²)"

    def _frames(self, shown: int) -> str:
        n = len(self.view.track.time_s)
        return f"{n} frames" if shown >= n else f"{n} frames ({shown} drawn)"

    def _name(self) -> str:
        return "gap" if self.view.conditions is not None else "height"

    def _clock(self) -> str:
        return f"time after {self.zero:.0f} s  [s]" if self.zero else "time  [s]"


def thinned(time: NDArray, value: NDArray, most: int = MOST_POINTS) -> tuple[NDArray, NDArray]:
    """The lowest and the highest frame of every stretch, at most ``most`` in all, so that no outlier is lost."""
    if len(time) <= most:
        return time, value
    edges = np.linspace(0, len(time), most // 2 + 1).astype(int)
    kept = {i + f(value[i:j]) for i, j in pairwise(edges) for f in (np.argmin, np.argmax)}
    at = np.array(sorted(map(int, kept)))
    return time[at], value[at]
