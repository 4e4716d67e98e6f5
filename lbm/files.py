"""Writing HDF5 files so that a reader never meets half a file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import h5py

from lbm.errors import OutputError


@contextmanager
def write_aside(path: Path | str) -> Iterator[h5py.File]:
    """An HDF5 file open for writing, which takes the name ``path`` only when complete and on the disk.

    Raises :class:`lbm.errors.OutputError` if that fails (disk full, no permission); a file that was at
    ``path`` is then still there, unchanged.
    """
    path = Path(path)
    aside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with h5py.File(aside, "w") as file:
            yield file
        with aside.open("rb+") as written:
            os.fsync(written.fileno())
        aside.replace(path)
    except (OSError, RuntimeError) as error:
        # h5py reports a failed flush on closing as RuntimeError
        raise OutputError(
            f"{path}: could not be written ({error}); an earlier file of that name is intact"
        ) from error
    finally:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
