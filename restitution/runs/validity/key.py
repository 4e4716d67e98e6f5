"""What a checkpoint of a stopped run belongs to: the very case and the very text of the program, bit for bit."""

from __future__ import annotations

import hashlib
import json

from restitution.cases.case import Case
from restitution.runs.filmed import filmed
from restitution.runs.validity.program import program_hash
from restitution.runs.validity.told import told

_FOR_READERS = {"title", "note", "prediction", "study"}
_DIGITS = 12
_AT_THE_WALL = ("sphere.film", "sphere.contact", "floor, m", "span")
"""Beginnings of the names of what the solver is told and is at work from the film on, or after the contact."""


def checkpoint_key(case: Case) -> str:
    """Hash of a case, of what the solver is told of it, and of the program."""
    content = case.model_dump(mode="json", exclude=_FOR_READERS)
    return _hash([content, told(case), filmed(case), program_hash()])


def approach_key(case: Case) -> str:
    """Hash of what the solver is told of a case but film and contact, and of the program.

    What is left out acts from the edge of the film on: cases of one key come to it in the same way, bit for bit.
    """
    before = {name: entry for name, entry in told(case).items() if not name.startswith(_AT_THE_WALL)}
    return _hash([before, case.run.duration, program_hash()])


def _hash(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:_DIGITS]
