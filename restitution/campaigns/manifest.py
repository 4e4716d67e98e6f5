"""What has become of the runs of a sweep: ``manifest.jsonl``, a checked line an end, only ever appended to.

A line is written once the results it tells of are on the disk. Several drivers may append to one manifest: under a
lock, and after reading what the others have written, so that no run is finished twice, but one that is to be tried
again, its results being gone. A line that was cut or
changed does not agree with its check sum: it is left out and said, and its run, if it was finished, is found again
in its folder.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from restitution.errors import Defect, StoppedError

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

FILE = "manifest.jsonl"
FINISHED, DIVERGED, FAILED, LOST, RETRY = "finished", "diverged", "failed", "lost", "retry"
"""What a line may say: the run's end, that its worker died within it, that it is to be tried again."""
ATTEMPTS = 3
"""Attempts, or deaths of its worker in a row without getting further, after which a run is given up."""
_SUM = ', "sum": "'
_SUM_LENGTH = len(_SUM) + 8 + len('"}')


@dataclass(slots=True)
class Standing:
    """How a run stands: ``state`` of its last line, attempts that failed, deaths without progress."""

    state: str = ""
    message: str = ""
    seconds: float = 0.0
    attempts: int = 0
    deaths: int = 0

    @property
    def over(self) -> bool:
        """Whether nothing more is to be done for it."""
        return self.state in (FINISHED, DIVERGED) or max(self.attempts, self.deaths) >= ATTEMPTS

    @property
    def shown(self) -> str:
        """The state as a table has it."""
        if self.state in (LOST, RETRY) or (self.state == FAILED and not self.over):
            return FAILED if self.over else "to do"
        return self.state or "to do"

    def take(self, line: dict[str, Any]) -> None:
        """Account for one more line."""
        if self.state == FINISHED and line["state"] != RETRY:
            return
        self.state, self.message = line["state"], line.get("message", "")
        self.seconds = line.get("seconds", self.seconds)
        if self.state == FAILED:
            self.attempts = ATTEMPTS if line.get("final") else self.attempts + 1
        elif self.state == LOST:
            self.deaths = 0 if line.get("further") else self.deaths + 1
        elif self.state == RETRY:
            self.attempts = self.deaths = 0


@dataclass
class Manifest:
    """The manifest of a folder, as far as it was read; :meth:`refresh` reads on."""

    folder: Path
    standing: dict[str, Standing] = field(default_factory=dict)
    defects: list[Defect] = field(default_factory=list)
    _read: int = 0
    _rows: int = 0

    def __post_init__(self) -> None:
        self.refresh()

    @property
    def path(self) -> Path:
        return self.folder / FILE

    def of(self, run: str) -> Standing:
        """How a run stands."""
        return self.standing.get(run) or Standing()

    def refresh(self) -> None:
        """Read what has been appended since; a last line without its end is being written, or was cut."""
        try:
            with self.path.open("rb") as stream:
                stream.seek(self._read)
                content = stream.read()
        except FileNotFoundError:
            return
        whole = content.rfind(b"\n") + 1
        self._read += whole
        for line in content[:whole].splitlines():
            self._rows += 1
            self._take(line)

    def append(self, lines: Iterable[dict[str, Any]]) -> None:
        """Write lines and have them on the disk; those of runs that others have finished are left out.

        Raises :class:`StoppedError` where that cannot be done; results are kept, and found by the next driver.
        """
        try:
            with self.path.open("a+b", buffering=0) as stream:
                if fcntl is not None:
                    fcntl.flock(stream, fcntl.LOCK_EX)
                self.refresh()
                text = b"".join(
                    _text(line)
                    for line in lines
                    if line["state"] == RETRY or self.of(line["run"]).state != FINISHED
                )
                size = stream.seek(0, os.SEEK_END)
                if text and size > self._read:  # the last line was cut: what follows begins on a line of its own
                    text = b"\n" + text
                rest = memoryview(text)
                while rest:
                    rest = rest[stream.write(rest) :]
                os.fsync(stream.fileno())
        except OSError as error:
            raise StoppedError(
                f"{self.path}: cannot be written: {error.strerror}; the runs go on from where they are when the "
                "same command is given again"
            ) from None
        self.refresh()

    def _take(self, line: bytes) -> None:
        body, given = line[:-_SUM_LENGTH], line[-10:-2]
        if len(line) <= _SUM_LENGTH or b"%08x" % zlib.crc32(body) != given:
            if line.strip():
                rule = "does not agree with its check sum: it is left out, and its run looked for in its folder"
                self.defects.append(Defect(rule, file=str(self.path), row=self._rows))
            return
        entry = json.loads(line)
        self.standing.setdefault(entry["run"], Standing()).take(entry)


def line(run: str, state: str, message: str = "", **more: Any) -> dict[str, Any]:
    """A line of the manifest."""
    return {"run": run, "state": state} | ({"message": message} if message else {}) | more


def _text(entry: dict[str, Any]) -> bytes:
    body = json.dumps(entry)[:-1].encode()
    return body + _SUM.encode() + b"%08x" % zlib.crc32(body) + b'"}\n'
