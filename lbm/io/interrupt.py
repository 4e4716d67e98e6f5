"""Ctrl-C between two steps, never within one: what a kernel began must be completed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_deferred() -> Iterator[list]:
    """Hold back Ctrl-C, listed in what is yielded, until the block is left; let a second one through."""
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        yield []  # signals reach the main thread only
        return
    held: list = []

    def hold(*received) -> None:
        if held:
            usual(*received)
        held.append(received)

    signal.signal(signal.SIGINT, hold)
    try:
        yield held
    finally:
        signal.signal(signal.SIGINT, usual)
    if held:
        usual(*held[0])
