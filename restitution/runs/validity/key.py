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


def checkpoint_key(case: Case) -> str:
    """Hash of a case, of what the solver is told of it, and of the program."""
    content = case.model_dump(mode="json", exclude=_FOR_READERS)
    parts = json.dumps([content, told(case), filmed(case), program_hash()], sort_keys=True)
    return hashlib.sha256(parts.encode()).hexdigest()[:_DIGITS]
