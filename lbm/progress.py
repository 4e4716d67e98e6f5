"""Progress of a run on the terminal: steps, million lattice-cell updates per second, time left."""

from __future__ import annotations

import sys
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

_UPDATES_PER_REFRESH = 2e7  # cell updates between two looks at the clock: a fraction of a second


class Progress:
    """Context in which a run reports itself; silent unless ``shown``."""

    def __init__(self, shown: bool, steps: int, cells: int):
        self._cells = cells
        self._refresh = max(2, 2 * int(_UPDATES_PER_REFRESH / cells / 2))
        self._console = Console(file=sys.stderr)
        self._bar = None
        if shown:
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
        if self._bar is not None:
            self._bar.stop()

    def compiling(self) -> None:
        """Say that the first run of a new version will take longer."""
        self._console.print("compiling kernels, once for this version ...")

    def compiled(self, seconds: float) -> None:
        """Say that kernels had to be compiled."""
        self._console.print(f"compiling took {seconds:.1f} s; later runs load the kernels from the cache")

    def stop(self, step: int) -> list[int]:
        """Where to stop and refresh, if anything is shown."""
        return [] if self._bar is None else [step + self._refresh]

    def advance(self, steps: int) -> None:
        """Account for ``steps`` made."""
        if self._bar is not None:
            task = self._bar.tasks[0]
            speed = task.speed
            mlups = "-" if not speed else f"{speed * self._cells / 1e6:.0f}"
            self._bar.update(self._task, advance=steps, mlups=mlups)
