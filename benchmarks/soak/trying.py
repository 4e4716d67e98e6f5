"""A command on the files of a user, and how it is judged: refused by name, or used with finite results."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from benchmarks.soak.outcome import Attempt, Outcome, either, refused, sound
from benchmarks.soak.running import Done, Workshop

Judge = Callable[[Done], Outcome]


def tried(
    name: str, files: dict[str, str | bytes], command: Iterable[str], judge: Judge, before: Iterable[str] = ()
) -> Attempt:
    """A command on files, after another one that makes what it needs."""

    def make(shop: Workshop) -> Outcome:
        for file, content in files.items():
            shop.write(file, content)
        if before:
            made = sound(shop.command(*before))
            if made.kind != "clean":
                return made
        return judge(shop.command(*command))

    return Attempt(name, make)


def names(*texts: str, left: Iterable[str] = ()) -> Judge:
    """Refused, with these in what is said."""
    return lambda done: refused(done, texts, left)


def may(*texts: str) -> Judge:
    """Refused with these in what is said, or used."""
    return lambda done: either(done, texts)
