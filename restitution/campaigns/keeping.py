"""A sweep's folder between two drives: which runs are under way, what is tried again, what is no more needed."""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from restitution.campaigns.fork import APPROACHES
from restitution.campaigns.manifest import FINISHED, RETRY, Manifest, line
from restitution.campaigns.plan import RUNS, Planned
from restitution.campaigns.run import BEGUN, CLAIM, seconds_of
from restitution.locks import is_held

_NEEDED_ONCE = ("checkpoint.h5", "trajectory_so_far.csv", CLAIM, BEGUN)


def under_way(folder: Path, runs: Iterable[Planned], manifest: Manifest) -> set[str]:
    """Runs that a process of a machine sharing the folder is at."""
    open_ones = (r.run for r in runs if not manifest.of(r.run).over)
    return {run for run in open_ones if is_held(folder / RUNS / run / CLAIM)}


def spoiled(folder: Path, runs: Iterable[Planned], manifest: Manifest) -> list[str]:
    """Finished runs whose results are no longer as they were written: gone, emptied, changed."""
    return [
        r.run for r in runs if manifest.of(r.run).state == FINISHED and seconds_of(folder / RUNS / r.run) is None
    ]


def retry(folder: Path, runs: Iterable[Planned], manifest: Manifest) -> int:
    """Have runs that diverged, failed or were given up tried again, and finished ones that are :func:`spoiled`.

    Returns how many those are.
    """
    runs = list(runs)
    again = [r.run for r in runs if manifest.of(r.run).shown in ("diverged", "failed")]
    again += spoiled(folder, runs, manifest)
    manifest.append(line(run, RETRY) for run in again)
    return len(again)


def clean(folder: Path, runs: Sequence[Planned], manifest: Manifest) -> tuple[dict[str, int], int]:
    """Remove folders of runs that the plan has no more, checkpoints of runs that are over, and approaches of none.

    What a process is at is left alone. Returns how many of what were removed, and the bytes.
    """
    planned, removed, count = {r.run: r for r in runs}, 0, Counter[str]()
    places = sorted((folder / RUNS).iterdir()) if (folder / RUNS).is_dir() else []
    for place in places:
        if is_held(place / CLAIM):
            continue
        if place.name not in planned:
            removed += _remove(place)
            count["runs that the plan has no more"] += 1
        elif manifest.of(place.name).over:
            for path in (p for p in place.iterdir() if p.name in _NEEDED_ONCE or p.name.endswith(".part")):
                removed += path.stat().st_size
                path.unlink()
                count["checkpoints and parts of files of runs that are over"] += path.name not in (CLAIM, BEGUN)
    if all(manifest.of(r.run).over for r in runs) and (folder / APPROACHES).is_dir():
        for place in (folder / APPROACHES).iterdir():
            if not is_held(place / CLAIM):
                removed += _remove(place)
                count["approaches"] += 1
    return {name: n for name, n in count.items() if n}, removed


def _remove(place: Path) -> int:
    size = sum(p.stat().st_size for p in place.rglob("*") if p.is_file())
    shutil.rmtree(place)
    return size
