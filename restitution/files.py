"""Outputs appear whole or not at all: written aside, then renamed."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from restitution.errors import Defect, InputError


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write one file aside in its folder, which must exist, then rename it into place; links are followed.

    Raises :class:`InputError` where that cannot be done; then nothing is changed.
    """
    path = Path(path)
    try:
        path = path.resolve()
        if path.exists() and not path.is_file():
            raise InputError(Defect("is not a regular file", str(path)))
        _write(path.parent, {path.name: content})
    except OSError as error:
        raise _defect(error, path) from None


def write_folder(folder: str | Path, contents: Mapping[str, str | bytes]) -> None:
    """Write several files into ``folder``, made if need be: all are written aside first, then renamed in turn."""
    folder, made = Path(folder), []
    try:
        made = [place for place in (folder, *folder.parents) if not place.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder, contents)
    except OSError as error:
        for place in made:
            if place.is_dir() and not any(place.iterdir()):
                place.rmdir()
        raise _defect(error, folder) from None


def _write(folder: Path, contents: Mapping[str, str | bytes]) -> None:
    aside: list[tuple[Path, Path]] = []
    try:
        for name, content in contents.items():
            target = folder / name
            if target.is_dir():
                raise IsADirectoryError(None, "is a folder", str(target))
            temporary = folder / f".{name}.{os.getpid()}.part"
            with temporary.open("xb") as stream:
                aside.append((temporary, target))
                stream.write(content.encode() if isinstance(content, str) else content)
        for temporary, target in aside:
            temporary.replace(target)
    finally:
        for temporary, _ in aside:
            temporary.unlink(missing_ok=True)


def _defect(error: OSError, place: Path) -> InputError:
    return InputError(Defect(f"cannot be written: {error.strerror or error}", str(error.filename or place)))
