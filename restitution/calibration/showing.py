"""How a result shows itself: as a small table at Python's prompt, and as one in a notebook."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """What is to be said of a result: a line, and rows of cells under headings, the first aligned left."""

    title: str
    headings: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()

    def text(self) -> str:
        """Columns of one width each, for a terminal."""
        if not self.rows:
            return self.title
        cells = [tuple(self.headings), *map(tuple, self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = [self.title]
        for first, *others in cells:
            right = [cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)]
            lines.append("  ".join(["", first.ljust(widths[0]), *right]).rstrip())
        return "\n".join(lines)

    def html(self) -> str:
        """A table for a notebook."""
        title = f"<p>{html.escape(self.title)}</p>"
        if not self.rows:
            return title

        def row(cells: Sequence[str], tag: str) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

        body = "".join(row(cells, "td") for cells in self.rows)
        return f"{title}<table><thead>{row(self.headings, 'th')}</thead><tbody>{body}</tbody></table>"


class Showing:
    """A result that says what is in it by :meth:`shown`, instead of all its arrays."""

    def shown(self) -> Table:
        """The result in a few lines."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return self.shown().text()

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return self.shown().html()


def counted(n: int, what: str) -> str:
    """``1 impact``, ``2 impacts``."""
    return f"{n} {what}{'s' * (n != 1)}"
