"""A doubt: something about an input that can be used but contradicts what it must obey."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from restitution.errors import Defect, InputError


@dataclass(frozen=True)
class Doubt:
    """``name`` in a word, ``message`` with the likely mistake and what mends it, ``where`` the record or file."""

    name: str
    message: str
    where: str = ""

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        return f"{place}{self.message}"

    def defect(self) -> Defect:
        """The same where doubts are refused."""
        return Defect(self.message, file=self.where or None)


def refuse(doubts: Iterable[Doubt]) -> None:
    """Raise :class:`InputError` with every doubt; nothing where there is none."""
    defects = [doubt.defect() for doubt in dict.fromkeys(doubts)]
    if defects:
        raise InputError(*defects)
