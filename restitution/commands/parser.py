"""The parser of every command: options as they are written in full, and one line of what is wrong with them."""

from __future__ import annotations

import argparse
import difflib
from collections.abc import Sequence
from typing import Any, NoReturn

from restitution.errors import printable


class Parser(argparse.ArgumentParser):
    """Takes no abbreviated options: ``--st`` is one today, and another when the next option is added.

    Parsers of subcommands are of the class of their parser.
    """

    def __init__(self, *args: Any, **named: Any):
        super().__init__(*args, **{**named, "allow_abbrev": False})

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """As of its base; an unknown option is refused here, where those that are near are known."""
        known, rest = super().parse_known_args(args, namespace)
        wrong = next((text.partition("=")[0] for text in rest if text.startswith("-")), None)
        if wrong is not None:
            self.error(f"{wrong} is no option of this command{self._near(wrong)}")
        if rest:
            self.error(f"{rest[0]!r} is one argument too many, or stands apart from those it belongs to")
        return known, rest

    def _near(self, wrong: str) -> str:
        options = [o for o in self._option_string_actions if o.startswith("--")]
        near = [o for o in options if o.startswith(wrong)] or difflib.get_close_matches(wrong, options)
        return f"; is {' or '.join(near)} meant?" if near else ""

    def error(self, message: str) -> NoReturn:
        """One line, and status 2."""
        self.exit(2, f"error: {printable(message.removeprefix('argument '))} ({self.prog} --help lists all)\n")
