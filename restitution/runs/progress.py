"""How a run stands: time of about how much, gap, speed of the solver, time left.

A bar on a terminal; elsewhere, as in the log of a batch job, a plain line now and then.
"""

from __future__ import annotations

import sys
import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

_SECONDS_PER_LINE = 15.0


class RunProgress:
    """Context in which a run reports itself on the standard error; silent unless ``shown``."""

    def __init__(self, name: str, cells: int, shown: bool):
        self._name, self._cells, self._shown = name, cells, shown
        self._start = self._last = time.perf_counter()
        self._steps, self._state = 0, ""
        self._first: tuple[float, float] | None = None
        console = Console(file=sys.stderr)
        self._bar = None
        if shown and console.is_interactive:
            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.fields[state]}"),
                TimeRemainingColumn(),
            )
            self._bar = Progress(*columns, console=console)
            self._task = self._bar.add_task(name, total=None, state="")

    def __enter__(self) -> RunProgress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.stop()
        elif self._shown and self._steps:
            self._line("" if kind is None else ", stopped")

    def update(self, steps: int, time_s: float, expected_s: float, gap_d: float) -> None:
        """Account for ``steps`` made, which led to ``time_s`` since the release."""
        self._steps += steps
        now = time.perf_counter()
        speed = self._steps * self._cells / 1e6 / max(now - self._start, 1e-9)
        share = time_s / max(expected_s, time_s)
        begin = self._first is None
        if self._first is None:  # a resumed run begins far on: its pace is counted from here
            self._first = now, time_s
        self._state = f"t = {time_s:.4g} of about {expected_s:.3g} s, gap {gap_d:.2f} d, {speed:.3g} MLUPS"
        if self._bar is not None:
            change = self._bar.reset if begin else self._bar.update
            change(self._task, total=1.0, completed=share, state=self._state)
        elif self._shown and now - self._last >= _SECONDS_PER_LINE:
            self._last = now
            since, way = now - self._first[0], time_s - self._first[1]
            self._line(f", {since * (expected_s - time_s) / way:.0f} s left" if way > 0 else "")

    def _line(self, end: str) -> None:
        print(f"{self._name}: {self._state}{end}", file=sys.stderr)  # noqa: T201
