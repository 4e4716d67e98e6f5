"""The text of the program, by its hash: where it has not changed, nothing has to be held against anything."""

from __future__ import annotations

import hashlib
import importlib.util
from functools import cache
from pathlib import Path

_APART = ("calibration", "campaigns", "commands", "emulation", "report", "validation")
"""Folders that no run depends on; that nothing below imports them is an import contract in pyproject.toml."""
_DIGITS = 12


@cache
def program_hash() -> str:
    """First digits of the SHA-256 over the text of both packages, but what no run depends on."""
    digest = hashlib.sha256()
    for package in ("lbm", "restitution"):
        root = Path(importlib.util.find_spec(package).origin).parent
        for path in sorted(root.rglob("*.py")):
            name = path.relative_to(root)
            if name.parts[0] not in _APART:
                digest.update(f"{package}/{name.as_posix()}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:_DIGITS]
