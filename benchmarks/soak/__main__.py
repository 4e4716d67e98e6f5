"""The soak: attempts of every area in turn, until all are made or the time is over; a table; a file."""

from __future__ import annotations

import argparse
import heapq
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from random import Random

from benchmarks.soak.areas import AREAS
from benchmarks.soak.outcome import KINDS, Area, Attempt, Count, Outcome
from benchmarks.soak.running import ROOT, Workshop, preload

RESULT = ROOT / "benchmarks" / "soak.json"
LIMIT = 1500
"""Seconds; on a machine that is not busy with other things all attempts are made in less."""
SHORT = 300.0
"""A soak of fewer seconds leaves out what is slow."""
FEWEST = 30
"""Attempts in areas that were not tried at revision 0a77d89."""


def soak(areas: Sequence[Area], seconds: float, seed: int, say=None, at_most: int | None = None) -> list[Count]:
    """Attempts of each area, as many as were made before, or as there is time for.

    The area that has had the least time goes next: those that are quick make all their attempts, and what they do
    not use is left to the slow ones.
    """
    preload()
    counts = {area.name: Count(area) for area in areas}
    waiting = [(0.0, rank, area) for rank, area in enumerate(Random(seed).sample(list(areas), len(areas)))]
    attempts = {area.name: area.attempts(Random(f"{seed} {area.name}")) for area in areas}
    end = time.monotonic() + seconds
    while waiting and (began := time.monotonic()) < end:
        spent, rank, area = heapq.heappop(waiting)
        count = counts[area.name]
        most = area.before[0] if area.before else FEWEST
        attempt = next(attempts[area.name], None)
        if attempt is None or count.tried >= min(most, at_most or most):
            continue
        outcome = made(attempt)
        count.add(attempt, outcome)
        if say is not None and outcome.kind != "clean":
            say(f"{area.name}: {attempt.name}: {outcome.kind}: {outcome.why}")
        heapq.heappush(waiting, (spent + time.monotonic() - began, rank, area))
    return list(counts.values())


def made(attempt: Attempt) -> Outcome:
    """One attempt in an empty folder."""
    with tempfile.TemporaryDirectory(prefix="soak-") as folder:
        return attempt.make(Workshop(Path(folder)))


def table(counts: Sequence[Count]) -> str:
    """Before and after, a row an area."""

    def cells(numbers: Sequence[int] | None) -> str:
        return " ".join(f"{n:5d}" for n in numbers) if numbers else " " * 35

    heads = " ".join(f"{h:>5}" for h in ("tried", "clean", "trace", "hang", "silen", "uncle"))
    lines = [f"{'':38} {'revision 0a77d89':35}   now", f"{'area':38} {heads}   {heads}"]
    total = [[0] * 6, [0] * 6]
    for count in counts:
        now = (count.tried, *count.kinds.values())
        lines.append(f"{count.area.name:38.38} {cells(count.area.before)}   {cells(now)}")
        for sums, numbers in zip(total, (count.area.before or (0,) * 6, now), strict=True):
            sums[:] = [a + b for a, b in zip(sums, numbers, strict=True)]
    lines.append(f"{'sum':38} {cells(total[0])}   {cells(total[1])}")
    return "\n".join(lines)


def record(counts: Sequence[Count], seed: int, seconds: float) -> str:
    """The result as JSON."""
    heads = ("attempts", *KINDS)
    areas = [
        {"area": c.area.name, "before": dict(zip(heads, c.area.before, strict=True)) if c.area.before else None,
         "now": {"attempts": c.tried, **c.kinds}, "failures": [[name, o.kind, o.why] for name, o in c.failures]}
        for c in counts
    ]  # fmt: skip
    revision = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=False
    ).stdout.strip()  # fmt: skip
    about = {
        "revision": revision,
        "before": "0a77d89",
        "seed": seed,
        "seconds": round(seconds),
        "python": sys.version.split()[0],
    }
    return json.dumps({**about, "areas": areas}, indent=1) + "\n"


def main() -> int:
    """Run it; status 1 where an attempt was not clean."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.soak", description=__doc__)
    parser.add_argument("--seconds", type=float, default=LIMIT, help=f"stop after so many ({LIMIT})")
    parser.add_argument("--write", action="store_true", help=f"keep the result in {RESULT.name}")
    parser.add_argument("--seed", type=int, default=0, help="of what is done at random (0)")
    parser.add_argument("--most", type=int, help="attempts of each area, at most")
    parser.add_argument("--area", action="append", help="only areas whose name has this in it")
    args = parser.parse_args()
    areas = [a for a in AREAS if not args.area or any(part in a.name for part in args.area)]
    areas = [a for a in areas if not a.slow or args.area or args.seconds >= SHORT]
    began = time.monotonic()
    counts = soak(areas, args.seconds, args.seed, lambda line: print(line, flush=True), args.most)
    print(table(counts))
    if args.write:
        RESULT.write_text(record(counts, args.seed, time.monotonic() - began))
    return int(any(count.failures for count in counts))


if __name__ == "__main__":
    sys.exit(main())
