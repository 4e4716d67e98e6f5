"""A drop test: spheres let fall on a wall at several speeds in another program, and the e that it delivers."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.errors import InputError
from restitution.export.dem import Request
from restitution.export.impacts import Impacts

STEPS = 500
"""Of an undamped contact."""
ABOVE = 20
"""Steps before first contact that a sphere is set free."""
CONTACTS = 5.0
"""Undamped contact times that a test lasts: a damped contact is longer."""
_LONGEST_RUN = 600.0
"""s, of one command."""


@dataclass(frozen=True)
class Deck:
    """``main`` is the name of the file that the exported text is in, ``files`` all by name."""

    main: str
    files: Mapping[str, str]


class NotInstalledError(Exception):
    """A program, or what a level needs of it, is not there; the message says what."""


@dataclass(frozen=True)
class Installed:
    """A program as found: its version, and the commands that run a deck in the folder of its files."""

    version: str
    commands: Callable[[Deck], Sequence[Sequence[str]]]
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Program:
    """A program that drop tests are written for."""

    title: str
    deck: Callable[[Impacts, Request, NDArray], Deck]
    """Of impact speeds in m/s."""
    promised: Callable[[Impacts, Request, NDArray], NDArray]
    """What the exported text says that it delivers, at Stokes numbers of the law."""
    find: Callable[[int], Installed]
    """For a level; raises :class:`NotInstalledError`."""
    levels: tuple[int, ...] = (0, 1, 2)
    """Those that can be run."""


def run_deck(deck: Deck, program: Installed, drops: int) -> NDArray:
    """The e that the program delivers, drop by drop.

    Raises
    ------
    InputError : where the program stops or does not say so many numbers, with the end of what it said.
    """
    environment = os.environ | dict(program.environment)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in deck.files.items():
            (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / name).write_text(text)
        said = ""
        for command in program.commands(deck):
            done = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, check=False,
                timeout=_LONGEST_RUN, stdin=subprocess.DEVNULL,
            )  # fmt: skip
            said = done.stdout + done.stderr
            if done.returncode:
                raise InputError(f"{command[0]} stopped with status {done.returncode}: {_end(said)}")
    given = [float(e) for e in re.findall(r"^drop \S+ (\S+)$", said, re.MULTILINE)]
    if len(given) != drops:
        raise InputError(f"the program gave {len(given)} of {drops} rebounds: {_end(said)}")
    return np.array(given)


def _end(said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return "; ".join(lines[-3:]) or "it said nothing"
