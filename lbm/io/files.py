"""Writing HDF5 files so that a reader never meets half a file."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from lbm import arguments
from lbm.errors import OutputError

__all__ = ["write_aside"]


class _Sink(io.FileIO):
    """A file that remembers its first failure instead of raising it inside HDF5, which cannot recover."""

    failure: OSError | None = None

    def write(self, data) -> int:
        rest = memoryview(data).cast("B")
        size = len(rest)
        while len(rest) and self.failure is None:
            try:
                rest = rest[super().write(rest) :]
            except OSError as error:
                self.failure = error
        return size

    def truncate(self, size: int | None = None) -> int:
        if self.failure is None:
            try:
                return super().truncate(size)
            except OSError as error:
                self.failure = error
        return size or 0


@contextmanager
def write_aside(path: Path | str) -> Iterator[h5py.File]:
    """An HDF5 file open for writing, which takes the name ``path`` only when complete and on the disk.

    Raises :class:`lbm.errors.OutputError` if that fails (disk full, no permission); a file that was at
    ``path`` is then still there, unchanged.
    """
    path = arguments.path("file", path)
    if not path.name or "\0" in str(path):
        raise OutputError(f"{str(path)!r} names no file")
    path = path.resolve()  # through links, which stay what they are
    aside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        if path.exists() and not path.is_file():
            raise FileExistsError(errno.EEXIST, "is not a regular file")
        path.parent.mkdir(parents=True, exist_ok=True)
        with _Sink(aside, "w+") as sink:
            with h5py.File(sink, "w") as file:
                yield file
            if sink.failure is not None:
                raise sink.failure
            os.fsync(sink.fileno())
        aside.replace(path)
    except OSError as error:
        raise OutputError(
            f"{path}: not written ({error}); a file of that name that was there is intact"
        ) from error
    finally:
        if aside.parent.is_dir() and len(os.fsencode(aside.name)) <= 255:
            aside.unlink(missing_ok=True)
