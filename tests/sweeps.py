"""A sweep of short resolved runs, a driver of it as a process, and what its folder says afterwards."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
TINY = """
base = "gondret_st152_10"
{head}
[case]
release = {{ kind = "drive", gap_d = 1.0, speed = 0.3, ramp = 0.0005 }}
numerics.cells_per_diameter = 6
numerics.lattice_speed = 0.1
numerics.width_d = 2.5
numerics.height_d = 4.5
run.after_contact = {span}
{rest}
"""
SIX = '[vary]\nfilm.tension = ["50 kPa", 101325]\nsphere.e_dry = [0.8, 0.9, 0.97]\n'
POINTS = """
base = "gondret_st152_10"
models = ["point particle"]
[vary]
sphere.e_dry = [0.8, 0.9, 0.97]
fluid.viscosity = ["10 mPa s", "20 mPa s"]
"""
_ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT)}


def write(folder: Path, text: str, name: str = "sweep.toml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def tiny(folder: Path, span: float = 0.012, head: str = "", rest: str = SIX) -> Path:
    """The file of a sweep of resolved runs: a third of a second each, longer with ``span``."""
    return write(folder, TINY.format(head=head, span=span, rest=rest))


def start(*arguments: object, **more) -> subprocess.Popen:
    """``restitution sweep`` as a process of its own."""
    command = [sys.executable, "-m", "restitution", "sweep", *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, env=_ENVIRONMENT, stdout=pipe, stderr=pipe, text=True, **more)


def run(*arguments: object, **more) -> subprocess.CompletedProcess:
    """The same, to its end."""
    with start(*arguments, **more) as process:
        out, err = process.communicate(timeout=120)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def module(name: str, *arguments: object) -> subprocess.Popen:
    """A module of Python's as a process, silent."""
    command = [sys.executable, "-m", name, *map(str, arguments)]
    return subprocess.Popen(command, env=_ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def lines(folder: Path) -> list[dict]:
    path = folder / "manifest.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def finished(folder: Path) -> Counter:
    """How often each run stands in the manifest as finished."""
    return Counter(entry["run"] for entry in lines(folder) if entry["state"] == "finished")


def until(condition, seconds: float = 60.0) -> None:
    """Wait for what must come."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.05)


def under_way(folder: Path) -> bool:
    return any((folder / "runs").glob("*/.running"))


def results(folder: Path) -> dict[str, dict]:
    """All that runs have left, by run and file, but for date and seconds."""
    found = {}
    for place in sorted(p.parent for p in (folder / "runs").glob("*/run.json")):
        record = json.loads((place / "run.json").read_text())
        about = {k: v for k, v in record.items() if k not in ("date", "seconds", "seal", "threads")}
        files = {p.name: p.read_bytes() for p in place.iterdir() if p.suffix in (".csv", ".npz")}
        found[place.name] = files | {"run.json": about}
    return found


def kill(process: subprocess.Popen) -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()
