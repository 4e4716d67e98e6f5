"""Files and folders that one process has: held by the system as long as it lives, so that none outlives it.

Where files cannot be held (no POSIX locks), nothing is refused and nothing is taken to be left behind.
"""

from __future__ import annotations

import os
import signal
import socket
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from restitution.errors import Defect, InputError

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

LOCK = ".running"
"""File in a folder that a process writes to: its number and its host."""
HALF_NEW = "HALF_NEW.txt"
"""File in a folder while several of its files are replaced; one that stays says that some of them are old."""


def hold(number: int) -> bool:
    """Hold an open file until it is closed; False where another process has it, or files cannot be held here."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


class HeldError(InputError):
    """Another process writes there."""


def is_held(path: Path) -> bool:
    """Whether a process has the file of a :func:`sole_writer`; one that a killed process left is nobody's."""
    if fcntl is None:
        return False
    try:
        with path.open("rb") as stream:
            fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


@contextmanager
def sole_writer(folder: Path, file: str = LOCK) -> Iterator[None]:
    """Within it, no other process may write results into the folder, which must exist.

    Raises :class:`HeldError` where one does, naming it. ``file`` is what is held: another for another purpose.
    """
    if fcntl is None:
        yield
        return
    path = folder / file
    stream = _held(path)
    try:
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        stream.flush()
        yield
    finally:
        path.unlink(missing_ok=True)
        stream.close()


@contextmanager
def replacing(folder: Path, names: Iterable[str]) -> Iterator[None]:
    """Within it, files that belong together are renamed into place: by one process at a time, Ctrl-C put off.

    What kills the process, or fails, before all of them have their names leaves :data:`HALF_NEW` beside them.
    """
    path = folder / HALF_NEW
    stream = _held(path, wait=True)
    try:
        with interrupts_put_off():
            stream.truncate(0)
            stream.write(_HALF_NEW.format(names="\n".join(names)).encode("utf-8", "surrogateescape"))
            yield
            path.unlink(missing_ok=True)
    finally:
        stream.close()


@contextmanager
def interrupts_put_off() -> Iterator[None]:
    """Within it Ctrl-C is only noted, to be raised at the end; signals reach the main thread alone."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    noted: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: noted.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if noted:
            signal.raise_signal(signal.SIGINT)


_HALF_NEW = """\
These files belong together and were being replaced. If this file stays, that was cut off: some of them are new and
some are old. Run the same command again; it writes all of them and removes this file.

{names}
"""


def _held(path: Path, wait: bool = False):
    while True:
        try:
            stream = path.open("a+b", buffering=0)
        except OSError as error:
            raise InputError(Defect(f"cannot be written: {error.strerror}", file=str(path.parent))) from None
        try:
            if fcntl is not None:
                fcntl.flock(stream, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            stream.seek(0)
            who = stream.read(200).decode("utf-8", "replace").strip() or "another process"
            stream.close()
            rule = f"{who} writes its results there: wait for it, or choose another folder (--out)"
            raise HeldError(Defect(rule, file=str(path.parent))) from None
        except OSError:  # a file system without locks: nothing is known of others
            return stream
        with suppress(OSError):
            if os.path.samestat(os.fstat(stream.fileno()), path.stat()):
                return stream
        stream.close()  # its holder has just removed it
