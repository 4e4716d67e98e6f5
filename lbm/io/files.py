"""Writing HDF5 files so that a reader never meets half a file."""

from __future__ import annotations

import errno
import io
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import h5py

try:
    import fcntl
except ImportError:  # where files cannot be held, nothing is known to be stale
    fcntl = None  # type: ignore[assignment]

from lbm import arguments
from lbm.errors import OutputError
from lbm.io.interrupt import interrupts_deferred

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


def _hold(number: int) -> bool:
    """Lock an open file as long as it is open; False where another process has it, or none can be locked here."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _remove_stale(path: Path) -> None:
    """Remove what killed processes left of earlier files of that name: what nobody holds."""
    for part in path.parent.iterdir():
        if part.name.startswith(f".{path.name}.") and part.name.endswith(".part"):
            with suppress(OSError), part.open("rb") as stream:
                if _hold(stream.fileno()):
                    part.unlink()


@contextmanager
def write_aside(path: Path | str) -> Iterator[h5py.File]:
    """An HDF5 file open for writing, which takes the name ``path`` only when complete and on the disk.

    Raises :class:`lbm.errors.OutputError` if that fails (disk full, no permission); a file that was at
    ``path`` is then still there, unchanged. Ctrl-C takes effect when the file is complete: HDF5 cannot be
    interrupted, it goes on with what was not written.
    """
    path = arguments.path("file", path)
    if not path.name or "\0" in str(path):
        raise OutputError(f"{str(path)!r} names no file")
    path = path.resolve()  # through links, which stay what they are
    aside = path.with_name(f".{path.name}.{secrets.token_hex(8)}.part")
    try:
        if path.exists() and not path.is_file():
            raise FileExistsError(errno.EEXIST, "is not a regular file")
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_stale(path)
        with _Sink(aside, "x+") as sink:
            _hold(sink.fileno())
            with interrupts_deferred(second_one_through=False), h5py.File(sink, "w") as file:
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
