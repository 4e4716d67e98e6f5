"""What the scorecard's tolerances and rows are worth: the spread of its values, and which errors it catches.

``python -m benchmarks.validation --spread``    how far values move with threads, processor, libraries, precision
``python -m benchmarks.validation --planted``   which row catches which of the errors of ``planted_errors.toml``

Both go on where they were stopped and write to ``reports/validate/``: ``spread.json``, from which ``restitution
validate --bless`` takes its tolerances, and ``planted.csv``. Rows that take long are left out by ``--only``.
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
from restitution.validation.baseline import BASELINE, FOLDER, SPREAD
from restitution.validation.row import Depth, Row
from restitution.validation.rows import all_rows

ROOT = Path(__file__).parent.parent
PLANTED, OTHER = "planted.csv", "other precision"
_COMMAND = """import sys
import lbm.fluid.cache as cache
if sys.argv[1]:
    cache.source_hash = lambda: sys.argv[1]  # the kernels are those of the program itself
from restitution.cli import main
sys.exit(main(["validate", *sys.argv[2:]]))
"""


@dataclass(frozen=True)
class Change:
    """A planted error: ``old`` becomes ``new`` in ``file``, where it stands once."""

    what: str
    file: str
    old: str
    new: str
    compiled: bool = False


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


def scorecard(root: Path, rows: list[str], kernels: str = "", python: str = "", **environment: str) -> dict:
    """``scorecard.json`` of the program in ``root``, of some rows; ``kernels``: the hash of those to be taken."""
    with tempfile.TemporaryDirectory() as place:
        options = ["--only", *rows, "--out", place, "--runs", str(ROOT / "reports/runs")]
        if (ROOT / FOLDER / BASELINE).is_file():
            options += ["--baseline", str(ROOT / FOLDER / BASELINE)]
        around = os.environ | {"PYTHONPATH": str(root)} | environment
        command = [python or sys.executable, "-c", _COMMAND, kernels, *options]
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


def plant(rows: list[str]) -> None:
    """Which of the rows catches which planted error, against the truth (T) and against the baseline (B)."""
    path = ROOT / FOLDER / PLANTED
    kept = {r["error"]: r for r in csv.DictReader(path.open(encoding="utf-8"))} if path.is_file() else {}
    for change in changes():
        if change.what in kept:
            continue
        with tempfile.TemporaryDirectory() as place:
            planted(change, Path(place))
            kernels = "" if change.compiled else cache.source_hash()
            found = scorecard(Path(place), rows, kernels)["rows"]
        truth = [r["name"] for r in found if r["truth"] == "fail"]
        baseline = [r["name"] for r in found if r["against_baseline"] == "fail"]
        quick = [n for n in {*truth, *baseline} if all_rows()[n].depth is Depth.QUICK]
        kept[change.what] = {
            "error": change.what, "file": change.file, "caught_at": "quick" if quick else "default",
            "against_truth": " ".join(truth), "against_baseline": " ".join(baseline), "rows_run": len(found),
        }  # fmt: skip
        if not truth and not baseline:
            kept[change.what]["caught_at"] = "not caught"
        print(f"{change.what}: truth {truth or '-'}; baseline {baseline or '-'}", flush=True)
        text = io.StringIO()
        writer = csv.DictWriter(text, list(kept[change.what]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(kept.values())
        write_whole(path, text.getvalue())


def _libraries(python: str) -> str:
    ask = "import numba, numpy, scipy; print(*(f'{m.__name__} {m.__version__}' for m in (numba, numpy, scipy)))"
    return subprocess.run([python, "-c", ask], capture_output=True, text=True, check=True).stdout.strip()


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spread", action="store_true")
    parser.add_argument("--planted", action="store_true")
    parser.add_argument("--only", nargs="+", metavar="ROW", help="these rows (all of quick and default)")
    parser.add_argument("--way", action="append", help="with --spread: this way of running alone")
    parser.add_argument("--python", action="append", default=[], help="with --spread: another interpreter as well")
    arguments = parser.parse_args()
    known = all_rows()
    rows = arguments.only or [name for name, row in known.items() if row.depth is not Depth.FULL]
    (ROOT / FOLDER).mkdir(parents=True, exist_ok=True)
    if arguments.spread:
        spread(rows, arguments.python, arguments.way)
    if arguments.planted:
        plant([name for name in rows if not name.startswith(("rebound-", "settling-"))])


if __name__ == "__main__":
    main()
