"""What an attempt may come to, and how many came to what."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchmarks.soak.running import Done, Workshop

KINDS = ("clean", "traceback", "hang", "silent", "unclear")
"""Clean: whole and right results, or status 2 with few short lines that name the file, nothing half-written.
Hang: too long or too much memory. Silent: wrong, lenient or half-written without a word."""
MOST_LINES, LONGEST_LINE = 20, 1300
_NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf)(?!\w)", re.IGNORECASE)


@dataclass(frozen=True)
class Outcome:
    """Of one attempt; ``why`` is for those that are not clean."""

    kind: str
    why: str = ""


CLEAN = Outcome("clean")


@dataclass(frozen=True)
class Attempt:
    """One attempt: its name, and what makes it, in an empty folder of its own."""

    name: str
    make: Callable[[Workshop], Outcome]


@dataclass(frozen=True)
class Area:
    """Attempts of one kind. ``before``: attempts, then counts of :data:`KINDS`, of revision 0a77d89.

    ``slow``: one may take a minute, so that a short soak leaves them out.
    """

    name: str
    before: tuple[int, int, int, int, int, int] | None
    attempts: Callable[[Random], Iterator[Attempt]]
    slow: bool = False


@dataclass
class Count:
    """What the attempts of an area came to."""

    area: Area
    kinds: dict[str, int] = field(default_factory=lambda: dict.fromkeys(KINDS, 0))
    failures: list[tuple[str, Outcome]] = field(default_factory=list)

    def add(self, attempt: Attempt, outcome: Outcome) -> None:
        """Count one."""
        self.kinds[outcome.kind] += 1
        if outcome.kind != "clean":
            self.failures.append((attempt.name, outcome))

    @property
    def tried(self) -> int:
        """All of them."""
        return sum(self.kinds.values())


def refused(done: Done, names: Iterable[str] = (), left: Iterable[str] = ()) -> Outcome:
    """Input that cannot be used: said in short lines that name it, nothing written."""
    if (bad := broken(done)) is not None:
        return bad
    if done.status == 0:
        return Outcome("silent", f"accepted: {done.out[:200]!r}")
    if left := [name for name in left if (done.folder / name).exists()]:
        return Outcome("silent", f"left behind: {left}")
    if missing := [name for name in names if name not in done.err]:
        return Outcome("unclear", f"does not name {missing[0]}: {done.err[:200]!r}")
    return CLEAN


def either(done: Done, names: Iterable[str] = (), left: Iterable[str] = ()) -> Outcome:
    """Input of which nobody knows beforehand whether it can be used: refused, or finite numbers."""
    if done.status != 0:
        return refused(done, names, left)
    return sound(done)


def sound(done: Done) -> Outcome:
    """A result, of finite numbers, unless a word says why not."""
    if (bad := broken(done)) is not None:
        return bad
    if done.status != 0:
        return Outcome("silent", f"status {done.status}: {done.err[:300]!r}")
    if (found := _NO_NUMBER.search(done.out)) is not None:
        return Outcome("silent", f"no number: {done.out[max(0, found.start() - 80) : found.end() + 20]!r}")
    return CLEAN


def noted(done: Done) -> Outcome:
    """A doubtful input: refused, or a result with a word about it."""
    if done.status != 0:
        return refused(done)
    said = done.out + done.err
    if not re.search(r"^(doubt|note|warning)", said, re.MULTILINE):
        return Outcome("silent", f"no word: {done.out[:200]!r}")
    return sound(done)


def same(done: Done, out: str) -> Outcome:
    """The very same output."""
    found = sound(done)
    if found.kind == "clean" and done.out != out:
        return Outcome("silent", f"another output: {done.out[:200]!r}")
    return found


def broken(done: Done) -> Outcome | None:
    """What no command may do, whatever its input."""
    if done.late:
        return Outcome("hang", f"over {done.late}")
    if "Traceback (most recent call last)" in done.err or done.status not in (0, 2, 130):
        last = done.err.strip().splitlines()[-1:] or [f"status {done.status}"]
        return Outcome("traceback", last[0][:300])
    lines = done.err.splitlines()
    usage = lines and lines[0].startswith("usage:")
    if done.status == 2 and not lines:
        return Outcome("unclear", "refused without a word")
    if len(lines) > MOST_LINES + (30 if usage else 0):
        return Outcome("unclear", f"{len(lines)} lines")
    if any(len(line) > LONGEST_LINE or not line.isprintable() for line in lines if not line.startswith("\r")):
        return Outcome("unclear", f"long or unprintable: {done.err[:200]!r}")
    return None
