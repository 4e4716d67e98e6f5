"""The probe cases that vouch for kept runs: what they give, how far that moves, and what they would notice.

``python -m benchmarks.probes``                   how far the present program is from the committed numbers
``python -m benchmarks.probes --write "why"``     commits what it gives now, as the next version of the physics
``python -m benchmarks.probes --spread``          how far the same program moves with threads, processor, libraries
``python -m benchmarks.probes --sensitivity``     how far each of a dozen small changes of the physics moves it

``--write`` raises the version, so that every kept run is stale. Where nothing departs it does not, and only takes
the present text as one that is known to agree. Results of the last two are kept in ``benchmarks/probes.json``.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

from restitution.files import write_whole
from restitution.runs.validity import physics
from restitution.runs.validity.program import program_hash

ROOT = Path(__file__).parent.parent
KEPT = Path(__file__).parent / "probes.json"
_GIVE = """import json, sys
from restitution.runs.validity import physics
json.dump(physics.probe_numbers(), sys.stdout)
"""


@dataclass(frozen=True)
class Change:
    """A small change of the physics: ``old`` becomes ``new`` in ``file``, where it stands once."""

    what: str
    file: str
    old: str
    new: str


def changes() -> list[Change]:
    """The changes of ``probe_changes.toml``."""
    content = tomllib.loads(Path(__file__).with_name("probe_changes.toml").read_text("utf-8"))
    return [Change(**change) for change in content["change"]]


def main(argv: list[str] | None = None) -> int:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", metavar="WHY")
    parser.add_argument("--spread", action="store_true")
    parser.add_argument("--sensitivity", action="store_true")
    parser.add_argument("--python", action="append", default=[], help="with --spread: another interpreter as well")
    args = parser.parse_args(argv)
    if args.spread:
        return _keep("spread", spread(args.python))
    if args.sensitivity:
        return _keep("sensitivity", sensitivity())
    start = time.perf_counter()
    now = physics.probe_numbers()
    print(f"{len(now)} probes in {time.perf_counter() - start:.1f} s")
    return _write(args.write, now) if args.write else _show(now)


def _show(now: dict[str, physics.Numbers]) -> int:
    committed = physics.committed()
    for name, entries in now.items():
        apart = {
            e: physics.apart(numbers, committed["numbers"].get(name, {}).get(e)) for e, numbers in entries.items()
        }
        worst = max(apart, key=apart.get)
        tolerance = physics.TOLERANCES[physics.precision(name)]
        print(f"{name:20s} at most {apart[worst]:.1e} ({worst}), tolerance {tolerance:.0e}")
    departing = physics.compare(committed["numbers"], now)
    print("\n".join(departing) or f"agrees with version {committed['version']}: {committed['why']}")
    return bool(departing)


def _write(why: str, now: dict[str, physics.Numbers]) -> int:
    version = 0
    if physics.NUMBERS.exists():
        content = physics.committed()
        if not physics.compare(content["numbers"], now):
            write_whole(physics.NUMBERS, physics.text(content | {"program": program_hash()}))
            print("nothing departs: the version stays; this text is known to agree")
            return 0
        version = content["version"]
    content = {"version": version + 1, "why": why, "program": program_hash(), "numbers": now}
    write_whole(physics.NUMBERS, physics.text(content))
    print(f"version {version + 1}: {why}; say so in CHANGELOG.md")
    return 0


def spread(interpreters: list[str]) -> dict[str, dict[str, float]]:
    """Largest difference from the committed numbers, by way of running and by precision."""
    ways = {
        "1 thread": {"NUMBA_NUM_THREADS": "1"},
        "2 threads": {"NUMBA_NUM_THREADS": "2"},
        "generic processor": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
        "without fused multiply-add": {"NUMBA_CPU_FEATURES": "-fma"},
    }
    runs = {way: (sys.executable, extra) for way, extra in ways.items()}
    runs |= {_libraries(python): (python, {}) for python in interpreters}
    return {way: _by_precision(_numbers_of(ROOT, *how)) for way, how in runs.items()}


def sensitivity() -> dict[str, dict[str, float]]:
    """Largest change over tolerance, and the probe that sees it, for each of :func:`changes`."""
    table = {}
    for change in changes():
        with tempfile.TemporaryDirectory() as place:
            for package in ("lbm", "restitution", "data"):
                shutil.copytree(ROOT / package, Path(place) / package)
            path = Path(place) / change.file
            path.write_text(changed(change, path.read_text("utf-8")), "utf-8")
            numbers = _numbers_of(Path(place), sys.executable, {})
        committed = physics.committed()["numbers"]
        over = {
            f"{name}, {entry}": physics.apart(values, committed[name][entry])
            / physics.TOLERANCES[physics.precision(name)]
            for name, entries in numbers.items()
            for entry, values in entries.items()
        }
        probe = max(over, key=over.get)
        table[change.what] = {"over_tolerance": float(f"{over[probe]:.3g}"), "probe": probe}
        print(f"{change.what:45s} {over[probe]:10.3g} x tolerance ({probe})", flush=True)
    return table


def changed(change: Change, text: str) -> str:
    """``text`` with the change made; raises ValueError where its place is not there, or not alone."""
    if text.count(change.old) != 1:
        raise ValueError(f"{change.file}: {change.old!r} stands {text.count(change.old)} times")
    return text.replace(change.old, change.new)


def _numbers_of(root: Path, python: str, extra: dict[str, str]) -> dict[str, physics.Numbers]:
    with tempfile.TemporaryDirectory() as kernels:
        environment = os.environ | {"PYTHONPATH": str(root), "LBM_CACHE_DIR": kernels} | extra
        done = subprocess.run(
            [python, "-c", _GIVE], cwd=root, env=environment, capture_output=True, text=True, check=False
        )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)


def _by_precision(numbers: dict[str, physics.Numbers]) -> dict[str, float]:
    committed = physics.committed()["numbers"]
    worst: dict[str, float] = {}
    for name, entries in numbers.items():
        kind = physics.precision(name)
        apart = max(physics.apart(values, committed[name][entry]) for entry, values in entries.items())
        worst[kind] = max(worst.get(kind, 0.0), float(f"{apart:.2g}"))
    print(worst, flush=True)
    return worst


def _libraries(python: str) -> str:
    ask = "import numba, numpy, scipy; print(*(f'{m.__name__} {m.__version__}' for m in (numba, numpy, scipy)))"
    return subprocess.run([python, "-c", ask], capture_output=True, text=True, check=True).stdout.strip()


def _keep(name: str, table: dict) -> int:
    kept = json.loads(KEPT.read_text("utf-8")) if KEPT.exists() else {}
    write_whole(KEPT, json.dumps(kept | {name: table}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
