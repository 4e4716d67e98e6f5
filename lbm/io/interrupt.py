"""Ctrl-C between two steps, never within one, nor within a file: what was begun must be completed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_deferred(second_one_through: bool = True) -> Iterator[list]:
    """Hold back Ctrl-C, listed in what is yielded, until the block is left; let a second one through, or none."""
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        yield []  # signals reach the main thread only
        return
    held: list = []

    def hold(*received) -> None:
        if held and second_one_through:
            usual(*received)
        held.append(received)

    signal.signal(signal.SIGINT, hold)
    try:
        yield held
    finally:
        signal.signal(signal.SIGINT, usual)
    if held:
        usual(*held[0])
