"""What the scorecard's tolerances and rows are worth: the spread of its values, and which errors it catches.

``python -m benchmarks.validation --spread``    how far values move with threads, processor, libraries, precision
``python -m benchmarks.validation --planted``   which row catches which of the errors of ``planted_errors.toml``

Both go on where they were stopped and write to ``reports/validate/``: ``spread.json``, from which ``restitution
validate --bless`` takes its tolerances, and ``planted.csv``, from the values in ``planted.json``.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from lbm.fluid import cache
from restitution.files import write_whole
from restitution.validation.baseline import BASELINE, FOLDER, SPREAD, read_baseline
from restitution.validation.row import Depth, Row
from restitution.validation.rows import all_rows
from restitution.validation.scorecard import Judged, Result
from restitution.validation.verdict import Verdict

ROOT = Path(__file__).parent.parent
PLANTED, OTHER = "planted.json", "other precision"
SOLVER = (
    "shear-wave", "poiseuille", "force-balance", "falling-momentum", "shear-rotation", "frames-fast",
    "force-noise", "added-mass-touching", "film-force", "wall-approach-10", "sub-steps", "impact-momentum",
    "imposed-restitution", "flight-li_drop1", "restart",
)  # fmt: skip
"""Rows that are run for an error of the solver; those of kept runs are stale then and say no more."""
PARTICLE = (
    "film-force", "basset-fall", "oscillating-sphere", "stokes-number", "law-delivered", "law-check-values",
    "exact-resistance", "drag-law",
)  # fmt: skip
"""Rows that are run for an error of laws and of the point particle."""
_HASH = "return digest.hexdigest()[:16]"
"""How kernels are known (lbm/fluid/cache.py); an error outside them is run with the kernels of the program."""


@dataclass(frozen=True)
class Change:
    """A planted error: ``old`` becomes ``new`` in ``file``, where it stands once."""

    what: str
    file: str
    old: str
    new: str
    compiled: bool = False

    @property
    def rows(self) -> tuple[str, ...]:
        """The rows that are run for it."""
        return SOLVER if self.file.startswith(("lbm/", "restitution/runs/")) else PARTICLE


def changes() -> list[Change]:
    """The errors of ``planted_errors.toml``."""
    content = tomllib.loads(Path(__file__).with_name("planted_errors.toml").read_text("utf-8"))
    return [Change(**change) for change in content["change"]]


def planted(change: Change, place: Path) -> None:
    """A copy of the program in ``place`` with the error in it; raises ValueError where it cannot be planted."""
    for package in ("lbm", "restitution", "data"):
        shutil.copytree(ROOT / package, place / package, ignore=shutil.ignore_patterns("__pycache__"))
    path = place / change.file
    text = path.read_text("utf-8")
    if text.count(change.old) != 1:
        raise ValueError(f"{change.file}: {change.old!r} stands {text.count(change.old)} times")
    path.write_text(text.replace(change.old, change.new), "utf-8")
    if not change.compiled:
        of_kernels = place / "lbm/fluid/cache.py"
        known = of_kernels.read_text("utf-8").replace(_HASH, f'return "{cache.source_hash()}"')
        of_kernels.write_text(known, "utf-8")


def scorecard(root: Path, rows: list[str], python: str = "", **environment: str) -> dict:
    """``scorecard.json`` of the program in ``root``, of some rows."""
    with tempfile.TemporaryDirectory() as place:
        options = ["--only", *rows, "--out", place, "--runs", str(ROOT / "reports/runs")]
        if (ROOT / FOLDER / BASELINE).is_file():
            options += ["--baseline", str(ROOT / FOLDER / BASELINE)]
        around = os.environ | {"PYTHONPATH": str(root)} | environment
        command = [python or sys.executable, "-m", "restitution", "validate", *options]
        done = subprocess.run(command, cwd=place, env=around, capture_output=True, text=True, check=False)
        written = Path(place) / "scorecard.json"
        if not written.is_file():
            raise RuntimeError(done.stderr)
        return json.loads(written.read_text("utf-8"))


def spread(rows: list[str], interpreters: list[str], only: list[str] | None = None) -> None:
    """Measure what is missing of ``spread.json``: by row, label and way the change from one thread."""
    path = ROOT / FOLDER / SPREAD
    kept = json.loads(path.read_text("utf-8")) if path.is_file() else {"ways": {}, "rows": {}}
    ways: dict[str, dict[str, str]] = {
        "1 thread": {"NUMBA_NUM_THREADS": "1"},
        "2 threads": {"NUMBA_NUM_THREADS": "2"},
        "generic processor": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
        "without fused multiply-add": {"NUMBA_CPU_FEATURES": "-fma"},
        OTHER: {},
    }
    ways |= {_libraries(python): {"python": python} for python in interpreters}
    known = all_rows()
    for way, how in ways.items():
        if only and way not in only:
            continue
        done = kept["ways"].setdefault(way, {})
        missing = [name for name in rows if done.get(name, {}).get("key") != known[name].key]
        if not missing:
            continue
        print(f"{way}: {len(missing)} rows", flush=True)
        for name, values in _values(missing, known, way, how).items():
            done[name] = {"key": known[name].key, "values": values}
        kept["rows"] = _differences(kept["ways"])
        write_whole(path, json.dumps(kept, indent=1) + "\n")


def _values(rows: list[str], known: dict[str, Row], way: str, how: dict[str, str]) -> dict[str, dict]:
    """Values of rows by name, made in one of the ways; rows that name no precision have no other."""
    if way != OTHER:
        found = scorecard(ROOT, rows, **how)["rows"]
        return {row["name"]: {v["label"]: v["value"] for v in row["values"]} for row in found}
    made = {}
    for row in (known[name] for name in rows):
        other = {"float32": "float64", "float64": "float32"}.get(row.case.get("dtype"))
        made[row.name] = {} if other is None else replace(row, case={**row.case, "dtype": other}).values()
    return made


def _differences(ways: dict[str, dict]) -> dict[str, dict[str, dict[str, float]]]:
    first = ways.get("1 thread", {})
    found: dict[str, dict[str, dict[str, float]]] = {}
    for way, rows in ways.items():
        for name, row in rows.items():
            for label, value in row["values"].items():
                ours = first.get(name, {}).get("values", {}).get(label)
                if way != "1 thread" and None not in (ours, value):
                    apart = float(f"{abs(value - ours):.3g}")
                    found.setdefault(name, {}).setdefault(label, {})[way] = apart
    return found


def plant(part: int, parts: int) -> None:
    """What the rows give with each of every ``parts``-th error planted: ``planted.json``, then the table of it."""
    path = ROOT / FOLDER / PLANTED
    for change in changes()[part::parts]:
        if change.what in _read(path):
            continue
        with tempfile.TemporaryDirectory() as place:
            planted(change, Path(place))
            found = scorecard(Path(place), list(change.rows))["rows"]
        values = {row["name"]: {v["label"]: v["value"] for v in row["values"]} for row in found}
        write_whole(path, json.dumps(_read(path) | {change.what: values}, indent=1) + "\n")
        print(change.what, flush=True)
    write_whole(path.with_suffix(".csv"), table(_read(path)))


def _read(path: Path) -> dict:
    return json.loads(path.read_text("utf-8")) if path.is_file() else {}


def table(found: dict[str, dict[str, dict[str, float | None]]]) -> str:
    """Which row catches which error, against the truth and against the baseline, as CSV."""
    known, held = all_rows(), read_baseline(ROOT / FOLDER / BASELINE)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("error", "file", "rows_run", "caught_at", "against_truth", "against_baseline"))
    for change in changes():
        rows = found.get(change.what, {})
        judged = [
            Judged.of(known[n], Result(key=known[n].key, values=v), held.held(known[n])) for n, v in rows.items()
        ]
        truth = [j.row.name for j in judged if j.truth is Verdict.FAIL]
        baseline = [j.row.name for j in judged if j.baseline is Verdict.FAIL]
        depths = [known[name].depth for name in (*truth, *baseline)]
        at = min(depths, key=list(Depth).index, default="not caught" if rows else "not run")
        writer.writerow((change.what, change.file, len(rows), at, " ".join(truth), " ".join(baseline)))
    return text.getvalue()


def _libraries(python: str) -> str:
    ask = "import numba, numpy, scipy; print(*(f'{m.__name__} {m.__version__}' for m in (numba, numpy, scipy)))"
    return subprocess.run([python, "-c", ask], capture_output=True, text=True, check=True).stdout.strip()


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spread", action="store_true")
    parser.add_argument("--planted", action="store_true")
    parser.add_argument("--only", nargs="+", metavar="ROW", help="these rows (all of quick and default)")
    parser.add_argument("--part", default="1/1", help="with --planted: 2/3 takes the second of three shares")
    parser.add_argument("--way", action="append", help="with --spread: this way of running alone")
    parser.add_argument("--python", action="append", default=[], help="with --spread: another interpreter as well")
    arguments = parser.parse_args()
    known = all_rows()
    rows = arguments.only or [name for name, row in known.items() if row.depth is not Depth.FULL]
    (ROOT / FOLDER).mkdir(parents=True, exist_ok=True)
    if arguments.spread:
        spread(rows, arguments.python, arguments.way)
    if arguments.planted:
        part, _, parts = arguments.part.partition("/")
        plant(int(part) - 1, int(parts))


if __name__ == "__main__":
    main()
