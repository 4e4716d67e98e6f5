"""What identifies a run: hashes of its case, of the code that makes it, and of the data it takes.

Comments, docstrings and empty lines are no part of the code's hash: a run is stale when the program has changed,
not when a sentence about it has. The hash is the same under all versions of Python.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import io
import json
import tokenize
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from restitution import datasets, laws
from restitution.case import Case

_HERE = Path(__file__).parent
_MODULES = (
    "branch.py", "conditions.py", "impact_speed.py", "impacts.py", "lattice_closures.py", "measured_bounces.py",
    "resolved.py", "simulate.py", "stokes.py", "tracks.py", "laws/base.py", "laws/brenner_1961.py",
    "laws/cavitation.py", "laws/cut_off.py", "laws/rebound.py", "laws/resistance.py",
    "laws/source_abstract_eq3.py", "laws/wall_normal.py", "laws/wall_tangential.py",
)  # fmt: skip
_WITHOUT_EFFECT = {"problems.py", "progress.py", "vtkhdf.py"}
"""Modules of the solver that no result depends on."""
_FOR_READERS = {"title", "note", "prediction"}
_LAYOUT = (tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.COMMENT)
_DIGITS = 12


@dataclass(frozen=True)
class RunKey:
    """First digits of the SHA-256 of case, code and data, and ``key`` over the three."""

    case: str
    code: str
    data: str

    @property
    def key(self) -> str:
        """One hash for all."""
        return _hash([self.case, self.code, self.data])

    def stated(self) -> dict[str, str]:
        """All four, by name, as they are kept with a result."""
        return {"key": self.key, "case_hash": self.case, "code_hash": self.code, "data_hash": self.data}


def run_key(case: Case) -> RunKey:
    """The key of a case under this version of the code; a rebound law and a record count as its data."""
    content = case.model_dump(mode="json", exclude=_FOR_READERS)
    contact, taken = case.contact, []
    if contact is not None and contact.measured == "record":
        taken.append(datasets.resource(case.record).hash)
    if contact is not None and contact.law is not None:
        taken.append(program(inspect.getsource(inspect.getmodule(type(laws.get(contact.law))))))
    return RunKey(_hash([json.dumps(content, sort_keys=True)]), code_hash(), _hash(taken))


@cache
def code_hash() -> str:
    """Hash of the solver and of what lies between it and a result."""
    package = Path(importlib.util.find_spec("lbm").origin).parent  # found, not imported: its text is what counts
    solver = [path for path in package.glob("*.py") if path.name not in _WITHOUT_EFFECT]
    files = {f"lbm/{path.name}": path for path in solver} | {name: _HERE / name for name in _MODULES}
    return _hash(f"{name}\n{program(files[name].read_text('utf-8'))}" for name in sorted(files))


def program(source: str) -> str:
    """A module's text without comments, docstrings and empty lines."""
    lines = source.splitlines(keepends=True)
    drop: list[tuple[tuple[int, int], tuple[int, int]]] = []
    begins = True  # whether the next token begins a statement
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and begins):
            drop.append((token.start, token.end))
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            begins = token.type in _LAYOUT
    for (row, column), (last, end) in reversed(drop):
        head, tail = lines[row - 1][:column], lines[last - 1][end:]
        lines[row - 1 : last] = [head + tail]
    return "\n".join(text for line in lines if (text := line.rstrip()))


def _hash(parts: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()[:_DIGITS]
