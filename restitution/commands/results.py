"""Folders of results: what two commands that write them share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from restitution.commands.console import show, show_rows
from restitution.errors import Defect, InputError
from restitution.files import check_folder
from restitution.runs.record import SolverContact, model_in

_SHOWN = 12


def folder_for(given: str | None, default: str, model: str) -> Path:
    """Where the results go; raises :class:`InputError` for what is no folder or holds those of another model."""
    if given == "":
        raise InputError(Defect("names no folder", field="--out"))
    folder = Path(given or default)
    if folder.exists() and not folder.is_dir():
        raise InputError(Defect("is no folder", file=str(folder), field="--out"))
    check_folder(folder)
    other = model_in(folder)
    if other not in (None, model):
        raise InputError(
            Defect(f"holds results of the other model, {other}: choose another folder", file=str(folder))
        )
    return folder


def show_contacts(contacts: Sequence[SolverContact], apexes_mm: list[float]) -> None:
    """Print the first contacts and the height that follows each."""
    rows = [
        (
            f"{i}", f"{c.time_s * 1e3:.2f}", f"{c.speed_in_m_s:.4f}", f"{c.speed_out_m_s:.4f}",
            f"{apexes_mm[i - 1]:.3f}" if i <= len(apexes_mm) else "",
        )
        for i, c in enumerate(contacts[:_SHOWN], 1)
    ]  # fmt: skip
    if not rows:
        show("no contact")
        return
    headings = ("contact", "time ms", "speed in m/s", "speed out m/s", "apex mm")
    show_rows(headings, rows, right=("contact", "apex mm"))
    if len(contacts) > _SHOWN:
        show(f"and {len(contacts) - _SHOWN} more, in run.json")
