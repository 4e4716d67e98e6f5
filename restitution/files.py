"""Outputs appear whole or not at all: written aside, then renamed."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, nullcontext, suppress
from pathlib import Path
from typing import IO

from restitution.errors import Defect, InputError
from restitution.locks import hold, replacing

_PART = ".part"
_TRIES = 5


def check_place(path: str | Path) -> None:
    """Raise :class:`InputError` where a file could not be written, before the work that it is for is done."""
    place = Path(path)
    if place.is_dir():
        raise InputError(Defect("cannot be written: it is a folder", file=str(path)))
    if not place.parent.is_dir():
        raise InputError(Defect(f"cannot be written: there is no folder {place.parent}", file=str(path)))
    if not os.access(place.parent, os.W_OK):
        raise InputError(Defect(f"cannot be written: the folder {place.parent} is not writable", file=str(path)))


def check_folder(path: str | Path) -> None:
    """Raise :class:`InputError` where files could not be put into a folder, which need not exist yet."""
    place = Path(path)
    if place.exists() and not place.is_dir():
        raise InputError(Defect("is not a folder", file=str(path)))
    there = next(p for p in (place, *place.absolute().parents) if p.exists())
    if not there.is_dir() or not os.access(there, os.W_OK):
        raise InputError(Defect(f"cannot be written: {there} is not a folder that can be written", file=str(path)))


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write one file aside in its folder, which must exist, then rename it into place; links are followed.

    Raises :class:`InputError` naming ``path`` where that cannot be done; then nothing is changed.
    """
    check_place(path)
    try:
        target = Path(path).resolve()
        if target.exists() and not target.is_file():
            raise InputError(Defect("is not a regular file", file=str(path)))
    except OSError as error:
        raise _defect(error, path) from None
    _write({str(path): (target, content)})


def write_folder(
    folder: str | Path, contents: Mapping[str, str | bytes], also: Mapping[str, str | bytes] | None = None
) -> None:
    """Write several files into ``folder``, made if need be: all are written aside first, then renamed in turn.

    A process killed between two renames leaves a file that says so (:data:`restitution.locks.HALF_NEW`).
    ``also`` are further files, by whole path, that belong to the same set.
    """
    folder, made = Path(folder), []
    if folder.exists() and not folder.is_dir():
        raise InputError(Defect("is not a folder", file=str(folder)))
    for path in also or ():
        check_place(path)
    try:
        made = [place for place in (folder, *folder.parents) if not place.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        targets = {str(folder / name): (folder / name, content) for name, content in contents.items()}
        targets |= {path: (Path(path).resolve(), content) for path, content in (also or {}).items()}
        _write(targets)
    except (OSError, InputError) as error:
        for place in made:
            if place.is_dir() and not any(place.iterdir()):
                place.rmdir()
        if isinstance(error, InputError):
            raise
        raise _defect(error, folder) from None


def _write(contents: Mapping[str, tuple[Path, str | bytes]]) -> None:
    """Write to targets, which the caller knows by the names that are the keys.

    A file written aside is held until it has its name, so that those which killed processes left are known.
    """
    aside: list[tuple[str, Path, Path]] = []
    with ExitStack() as streams:
        streams.callback(_remove, aside)
        for name, (target, content) in contents.items():
            if target.is_dir():
                raise InputError(Defect("cannot be written: it is a folder", file=name))
            try:
                _remove_stale(target)
                stream, temporary = _aside(target)
                streams.enter_context(stream)
                aside.append((name, temporary, target))
                rest = memoryview(content.encode() if isinstance(content, str) else content)
                while rest:
                    rest = rest[stream.write(rest) :]
            except OSError as error:
                raise _defect(error, name) from None
        one_set = replacing(aside[0][2].parent, contents) if len(aside) > 1 else nullcontext()
        with one_set:
            for name, temporary, target in aside:
                try:
                    temporary.replace(target)
                except OSError as error:
                    raise _defect(error, name) from None


def _aside(target: Path) -> tuple[IO[bytes], Path]:
    """A new file beside ``target``, held: one that another writer took for stale before that is given up.

    Where files cannot be held none is taken for stale either, and the last one serves.
    """
    for tries_left in reversed(range(_TRIES)):
        temporary = target.with_name(f".{target.name}.{secrets.token_hex(8)}{_PART}")
        stream = temporary.open("xb", buffering=0)
        if (hold(stream.fileno()) and temporary.exists()) or not tries_left:
            break
        stream.close()
        temporary.unlink(missing_ok=True)
    return stream, temporary


def _remove(aside: Sequence[tuple[str, Path, Path]]) -> None:
    for _, temporary, _ in aside:
        temporary.unlink(missing_ok=True)


def _remove_stale(target: Path) -> None:
    """Remove what killed processes left of earlier files of that name: what nobody holds."""
    beginning = f".{target.name}."
    for part in [p for p in target.parent.iterdir() if p.name.startswith(beginning) and p.name.endswith(_PART)]:
        with suppress(OSError), part.open("rb") as stream:
            if hold(stream.fileno()):
                part.unlink()


def _defect(error: OSError, name: str | Path) -> InputError:
    return InputError(Defect(f"cannot be written: {error.strerror or error}", file=str(name)))
