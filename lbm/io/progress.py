"""Progress of a run: steps, million lattice-cell updates per second, time left.

A bar on a terminal or in a notebook; elsewhere, as in the log of a batch job, a plain line now and then.
"""

from __future__ import annotations

import sys
import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

_UPDATES_PER_REFRESH = 2e7  # cell updates between two looks at the clock: a fraction of a second
_SECONDS_PER_LINE = 10.0


class Progress:
    """Context in which a run reports itself; silent unless ``shown``."""

    def __init__(self, shown: bool, steps: int, cells: int):
        self._shown, self._steps, self._cells = shown, steps, cells
        self._refresh = max(2, 2 * int(_UPDATES_PER_REFRESH / cells / 2))
        self._console = Console(file=sys.stderr)
        self._done = 0
        self._start = self._last_line = time.perf_counter()
        self._bar = None
        if shown and (self._console.is_interactive or self._console.is_jupyter):
            self._bar = Bar(
                TextColumn("lbm"),
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("{task.fields[mlups]} MLUPS"),
                TimeRemainingColumn(),
                console=self._console,
            )
            self._task = self._bar.add_task("steps", total=steps, mlups="-")

    def __enter__(self) -> Progress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        failed_at_once = kind is not None and not self._done
        if self._bar is not None:
            self._bar.live.transient = failed_at_once
            self._bar.stop()
        elif self._shown and not failed_at_once:
            self._line("" if kind is None else ", stopped")

    def compiling(self) -> None:
        """Say that the first run of a new version will take longer."""
        self._console.print("compiling kernels ...")

    def compiled(self, seconds: float, kept: bool) -> None:
        """Say that kernels had to be compiled, and whether they are ``kept`` on the disk."""
        later = "later runs load the kernels from the cache" if kept else "later processes compile again"
        self._console.print(f"compiling took {seconds:.1f} s; {later}")
        self._start = time.perf_counter()

    def stop(self, step: int) -> list[int]:
        """Where to stop and refresh, if anything is shown."""
        return [step + self._refresh] if self._shown else []

    def advance(self, steps: int) -> None:
        """Account for ``steps`` made."""
        self._done += steps
        if self._bar is not None:
            speed = self._bar.tasks[0].speed
            mlups = "-" if not speed else f"{speed * self._cells / 1e6:.0f}"
            self._bar.update(self._task, advance=steps, mlups=mlups)
        elif (
            self._shown and time.perf_counter() - self._last_line >= _SECONDS_PER_LINE and self._done < self._steps
        ):
            left = (self._steps - self._done) * (time.perf_counter() - self._start) / max(self._done, 1)
            self._line(f", {left:.0f} s left")

    def _line(self, end: str) -> None:
        now = time.perf_counter()
        self._last_line = now
        mlups = self._done * self._cells / 1e6 / max(now - self._start, 1e-9)
        self._console.print(f"lbm {self._done}/{self._steps} steps, {mlups:.3g} MLUPS{end}", highlight=False)
