"""How a sweep stands while it goes on: a bar with the time left on a terminal, a line now and then in a log."""

from __future__ import annotations

import sys
import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from restitution.campaigns.driver import Progress as Standing

_SECONDS_PER_LINE = 15.0


class SweepProgress:
    """Context in which a sweep reports itself on the standard error."""

    def __init__(self, name: str):
        self._name = name
        self._began = self._last = time.monotonic()
        self._first: int | None = None
        console = Console(file=sys.stderr)
        self._bar = None
        if console.is_interactive:
            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("{task.fields[state]}"),
                TimeRemainingColumn(),
            )
            self._bar = Progress(*columns, console=console, speed_estimate_period=3600.0)
            self._task = self._bar.add_task(name, total=None, state="")

    def __enter__(self) -> SweepProgress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.stop()

    def update(self, now: Standing) -> None:
        """Show where the sweep stands."""
        if self._first is None:  # runs that were over before: the pace is counted from here
            self._first = now.over
        state = f"{now.under_way} under way"
        if self._bar is not None:
            self._bar.update(self._task, total=now.runs, completed=now.over, state=state)
        elif time.monotonic() - self._last >= _SECONDS_PER_LINE:
            self._last = time.monotonic()
            made, since = now.over - self._first, self._last - self._began
            left = f", {since * (now.runs - now.over) / made:.0f} s left" if made else ""
            self.say(f"{self._name}: {now.over} of {now.runs} runs, {state}{left}")

    def say(self, text: str) -> None:
        """A line that stays."""
        if self._bar is not None:
            self._bar.console.print(text, markup=False, highlight=False)
        else:
            print(text, file=sys.stderr, flush=True)  # noqa: T201
