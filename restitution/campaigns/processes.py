"""Processes of this machine as an :class:`~concurrent.futures.Executor`: a death costs one run.

The pool of the standard library is broken as a whole when one of its processes is killed, and does not say whose
run that was. So each slot here is a pool of one process, started anew when that dies. Processes are spawned: a
forked one would wait for threads that it has not inherited. Left to Python, a spawned one imports the script that
asked for it once more, and one without ``if __name__ == "__main__"`` would begin all anew: here it does not, so
tasks are functions of modules, not of the script. Processes end with the one that started them, whatever kills it;
a Ctrl-C at the terminal does not reach them, they are told to leave a checkpoint and stop.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from types import ModuleType
from typing import Any

_SECONDS_TO_STOP = 30.0
_SECONDS_TO_LOOK = 0.5


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class LocalProcesses(Executor):
    """So many processes of this machine, each with so many threads."""

    def __init__(self, processes: int, threads: int = 1):
        self.slots = processes
        self._threads = threads
        self._pools = [self._pool() for _ in range(processes)]
        self._pending: list[list[Future]] = [[] for _ in range(processes)]

    def submit(self, fn: Callable, /, *args: Any, **kwargs: Any) -> Future:
        """In the slot with the least to do."""
        for futures in self._pending:
            futures[:] = [f for f in futures if not f.done()]
        with _starting(), _without_script():
            return self._submit(_call, fn, *args, **kwargs)

    def _submit(self, fn: Callable, /, *args: Any, **kwargs: Any) -> Future:
        slot = min(range(self.slots), key=lambda i: len(self._pending[i]))
        try:
            future = self._pools[slot].submit(fn, *args, **kwargs)
        except BrokenProcessPool:
            self._pools[slot].shutdown(wait=False)
            self._pools[slot] = self._pool()
            future = self._pools[slot].submit(fn, *args, **kwargs)
        self._pending[slot].append(future)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes."""
        for pool in self._pools:
            pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def interrupt(self) -> None:
        """Have the runs leave their checkpoints and stop."""
        for process in multiprocessing.active_children():
            with suppress(OSError):
                os.kill(process.pid, signal.SIGINT)

    def _pool(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(
            1,
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin,
            initargs=(self._threads, os.getpid()),
        )


def _begin(threads: int, parent: int) -> None:
    """The first thing that a process of a slot does."""
    os.environ["NUMBA_NUM_THREADS"] = str(threads)
    with suppress(OSError, AttributeError):
        os.setpgid(0, 0)  # the terminal's Ctrl-C is for the process that started this one
    signal.signal(signal.SIGINT, _stop)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    sys.unraisablehook = _unraised
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


@contextmanager
def _starting() -> Iterator[None]:
    """While a process may be started: here a Ctrl-C waits until it is, there until it is ready for one."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # which would let signals through again when it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _without_script() -> Iterator[None]:
    """Within it, a process that is started is told of no script: its ``__main__`` stays empty."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


_within = threading.Event()
"""Set while a task is at work."""
_over = threading.Event()
"""Set once an interrupt has come between two tasks: no more are begun."""


def _call(fn: Callable, /, *args: Any, **kwargs: Any) -> Any:
    _within.set()
    try:
        if _over.is_set():
            raise KeyboardInterrupt
        return fn(*args, **kwargs)
    finally:
        _within.clear()


def _stop(*_: object) -> None:
    """What interrupts a task, or the next one where none is at work."""
    if _within.is_set():
        raise KeyboardInterrupt
    _over.set()


def _unraised(what: Any) -> None:
    """An interrupt that came while something was being freed is lost there: it is sent once more."""
    if issubclass(what.exc_type, KeyboardInterrupt):
        threading.Timer(_SECONDS_TO_LOOK / 10, os.kill, (os.getpid(), signal.SIGINT)).start()
    else:
        sys.__unraisablehook__(what)


def _end_with(parent: int) -> None:
    """End this process once that which started it is gone, after its run had the time to leave a checkpoint."""
    while os.getppid() == parent:
        time.sleep(_SECONDS_TO_LOOK)
    if _within.is_set():
        os.kill(os.getpid(), signal.SIGINT)
        until = time.monotonic() + _SECONDS_TO_STOP
        while _within.is_set() and time.monotonic() < until:
            time.sleep(_SECONDS_TO_LOOK / 10)
    os._exit(1)
