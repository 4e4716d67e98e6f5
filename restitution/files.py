"""Outputs appear whole or not at all: written aside, then renamed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from restitution.errors import Defect, InputError


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write a file aside in the same folder, then rename it into place.

    Raises :class:`InputError` where the place cannot be written; then nothing is changed.
    """
    path = Path(path)
    write_folder(path.parent, {path.name: content})


def write_folder(folder: str | Path, contents: Mapping[str, str | bytes]) -> None:
    """Write several files into ``folder``: all are written aside first, then renamed one after the other."""
    folder = Path(folder)
    aside: list[tuple[Path, Path]] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            target = folder / name
            if target.is_dir():
                raise IsADirectoryError(None, "is a folder", str(target))
            handle, temporary = tempfile.mkstemp(dir=folder, prefix=f".{name}.")
            aside.append((Path(temporary), target))
            with os.fdopen(handle, "wb") as stream:
                stream.write(content.encode() if isinstance(content, str) else content)
            # mkstemp makes files private; outputs get the permissions any new file would.
            umask = os.umask(0)
            os.umask(umask)
            Path(temporary).chmod(0o666 & ~umask)
        for temporary, target in aside:
            temporary.replace(target)
    except OSError as error:
        raise InputError(
            Defect(f"cannot be written: {error.strerror or error}", str(error.filename or folder))
        ) from None
    finally:
        for temporary, _ in aside:
            temporary.unlink(missing_ok=True)
