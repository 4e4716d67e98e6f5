"""The report of e asked against e delivered: measured where wished, then drawn and put on a page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.files import write_folder, write_whole
from restitution.report.delivered import content, languages, page, plot

KEPT = "delivered.csv"
"""The kept table of drops, in the report's folder."""
LANGUAGES = "languages.csv"
"""The kept table of ``python -m tests.languages``, beside it."""


def write(folder: str | Path, run: bool = False, say: Callable[[str], None] = lambda text: None) -> list[str]:
    """Write the report into ``folder``; returns the names of the files. The same table gives the same bytes.

    ``run``: first run the programs that are installed, and keep what they deliver.
    """
    kept = Path(folder) / KEPT
    if run:
        _measure(kept, say)
    elif not kept.exists():
        rule = "is not there: what programs deliver is kept in it; --measure runs those that are installed"
        raise InputError(Defect(rule, file=str(kept)))
    table, summary = content.gather(str(kept))
    drawing, beside = plot.draw(table), Path(folder) / LANGUAGES
    agreements = languages.gather(beside) if beside.exists() else []
    files: dict[str, str | bytes] = {
        "figure.svg": drawing.svg,
        "figure.png": drawing.png,
        "index.html": page.render(table, summary, agreements, drawing.svg),
    }
    write_folder(folder, files)
    return [KEPT, *files]


def _measure(kept: Path, say: Callable[[str], None]) -> None:
    from restitution.export.drops import PROGRAMS
    from restitution.export.drops.kept import kept_text, measure, read_kept

    table = measure(PROGRAMS.items(), read_kept(kept) if kept.exists() else None, say)
    if table.empty:
        raise InputError("none of the programs is installed: 'make targets' says how to get them")
    kept.parent.mkdir(parents=True, exist_ok=True)
    write_whole(kept, kept_text(table))
