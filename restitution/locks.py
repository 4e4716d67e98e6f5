"""Files and folders that one process has: held by the system as long as it lives, so that none outlives it.

Where files cannot be held (no POSIX locks), nothing is refused and nothing is taken to be left behind.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from restitution.errors import Defect, InputError

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

LOCK = ".running"
"""File in a folder that a process writes to: its number and its host."""


def hold(number: int) -> bool:
    """Hold an open file until it is closed; False where another process has it, or files cannot be held here."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


@contextmanager
def sole_writer(folder: Path) -> Iterator[None]:
    """Within it, no other process may write results into the folder, which must exist.

    Raises :class:`InputError` where one does, naming it.
    """
    if fcntl is None:
        yield
        return
    path = folder / LOCK
    stream = _held(path)
    try:
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        stream.flush()
        yield
    finally:
        path.unlink(missing_ok=True)
        stream.close()


def _held(path: Path):
    while True:
        try:
            stream = path.open("a+b", buffering=0)
        except OSError as error:
            raise InputError(Defect(f"cannot be written: {error.strerror}", file=str(path.parent))) from None
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            stream.seek(0)
            who = stream.read(200).decode("utf-8", "replace").strip() or "another process"
            stream.close()
            rule = f"{who} writes its results there: wait for it, or choose another folder (--out)"
            raise InputError(Defect(rule, file=str(path.parent))) from None
        except OSError:  # a file system without locks: nothing is known of others
            return stream
        with suppress(OSError):
            if os.path.samestat(os.fstat(stream.fileno()), path.stat()):
                return stream
        stream.close()  # its holder has just removed it
