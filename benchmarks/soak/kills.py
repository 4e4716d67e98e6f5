"""Kills and interrupts at any moment and amid the writing; two processes at once. Real processes and signals."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.outcome import CLEAN, Attempt, Outcome, broken, sound
from benchmarks.soak.running import ROOT, Done, Workshop

RUNS = ROOT / "reports" / "runs"
_PAGE = ("index.html", "figure.svg", "figure.png", "impacts.csv")
_TABLES = ("trajectory.csv", "velocity.csv", "impacts.csv")
SHORT = """
base = "gondret_st152_10"
[release]
kind = "drive"
gap_d = 0.55
speed = 0.3
ramp = 0.0005
free_below_d = 0.5
[numerics]
cells_per_diameter = 6
lattice_speed = 0.1
width_d = 2.5
height_d = 4.5
[run]
after_contact = 0.02
"""


@dataclass(frozen=True)
class Writer:
    """A command that writes a set of files: into which folder, some of them, what it needs, its statuses."""

    command: tuple[str, ...]
    folder: str
    older: tuple[str, ...]
    files: Mapping[str, str] = field(default_factory=dict)
    statuses: tuple[int, ...] = (0,)

    @property
    def name(self) -> str:
        """The command without its options."""
        return " ".join(self.command[:2])


SIMULATE = ("simulate", "case.toml", "--out", "out")
FIT = Writer(("fit", "impacts.csv", *inputs.LAW, "--out", "fit.json", "--report", "report"), "report", _PAGE,
             {"impacts.csv": inputs.IMPACTS})  # fmt: skip
FIG1 = Writer(("report", "fig1", "--out", "fig1", "--runs", str(RUNS)), "fig1", _PAGE)
FIG2 = Writer(("report", "fig2", "--out", "fig2", "--runs", str(RUNS)), "fig2", _PAGE)
VALIDATE = Writer(("validate", "--only", "couette", "--out", "card"), "card", ("index.html",), {}, (0, 1, 3))
WRITERS = (
    Writer(SIMULATE, "out", _TABLES, {"case.toml": SHORT}), FIT, FIG1,
    Writer(("bounce", "case.toml", "--out", "bounce"), "bounce", _TABLES, {"case.toml": inputs.CASE}),
    FIG2, VALIDATE,
)  # fmt: skip
OFTEN = """
import sys
from restitution.runs import stand
stand.SECONDS_PER_CHECKPOINT = 0.2
from restitution.cli import main
sys.exit(main(sys.argv[1:]))
"""
"""The command line with a checkpoint every 0.2 s."""
AT_RENAME = """
import os, signal, sys
from pathlib import Path
at, done, plain = int(sys.argv.pop(1)), [], Path.replace
def replace(self, target):
    if len(done) == at:
        os.kill(os.getpid(), signal.SIGKILL)
    done.append(target)
    return plain(self, target)
Path.replace = replace
from restitution.cli import main
sys.exit(main(sys.argv[1:]))
"""
"""The command line, killed before it gives a file its name: that of the number it is given first."""
LEFT = (".part", "HALF_NEW.txt", ".running")


@cache
def whole_run(folder: str) -> dict[str, object]:
    """The results of a run that nothing stopped."""
    shop = Workshop(Path(folder))
    shop.write("case.toml", SHORT)
    done = shop.process(*SIMULATE)
    if sound(done).kind != "clean":
        raise RuntimeError(done.err)
    return content(shop.folder / "out")


def content(folder: Path) -> dict[str, object]:
    """All files of a run; of run.json what does not tell when it was made."""
    found: dict[str, object] = {p.name: p.read_bytes() for p in folder.iterdir()}
    about = json.loads(found.pop("run.json"))  # type: ignore[arg-type]
    found["run.json"] = {k: v for k, v in about.items() if k not in ("seconds", "date", "seal")}
    return found


def nothing_left(folder: Path) -> Outcome:
    """No file of an interrupted writing stays."""
    left = [str(p.relative_to(folder)) for p in folder.rglob("*") if p.name.endswith(LEFT)]
    return Outcome("silent", f"left behind: {left[:3]}") if left else CLEAN


def simulations(numbers: tuple[signal.Signals, ...], most: int) -> Callable[[Random], Iterator[Attempt]]:
    """``simulate`` stopped once or more at random, then continued: the same files bit for bit."""

    def attempts(random: Random) -> Iterator[Attempt]:
        import tempfile

        reference = tempfile.TemporaryDirectory(prefix="soak-whole-")
        while True:
            stops = [
                (random.uniform(0.5, 14), random.choice(numbers), random.randint(1, most))
                for _ in range(random.randint(1, 2))
            ]
            name = "simulate stopped by " + ", ".join(f"{n.name} x {k} at {t:.1f} s" for t, n, k in stops)
            yield Attempt(name, lambda shop, stops=stops: stopped(shop, stops, whole_run(reference.name)))

    return attempts


def stopped(shop: Workshop, stops: list, whole: dict[str, object]) -> Outcome:
    """One chain of stops, and the run that goes on."""
    shop.write("case.toml", SHORT)
    (shop.folder / "out").mkdir()
    for after, number, times in stops:
        done = shop.stop(shop.start(*SIMULATE, "--resume", program=OFTEN), after, number, times)
        if done.status not in (0, 130, -number) or "Traceback" in done.err:
            return broken(done) or Outcome("unclear", f"status {done.status}: {done.err[-200:]!r}")
    done = shop.process(*SIMULATE, "--resume")
    if (outcome := sound(done)).kind != "clean":
        return outcome
    found = content(shop.folder / "out")
    if found != whole:
        unlike = [name for name in sorted({*found, *whole}) if found.get(name) != whole.get(name)]
        return Outcome("silent", f"other files after --resume: {unlike}")
    return CLEAN


def at_random(writer: Writer, longest: float) -> Callable[[Random], Iterator[Attempt]]:
    """A command that writes a set of files, stopped at random within so many seconds."""

    def attempts(random: Random) -> Iterator[Attempt]:
        while True:
            number = random.choice((signal.SIGKILL, signal.SIGINT, signal.SIGTERM))
            after = random.uniform(0.2, longest)

            def make(shop: Workshop, number: signal.Signals = number, after: float = after) -> Outcome:
                return replaced(shop, writer, lambda: shop.stop(shop.start(*writer.command), after, number))

            yield Attempt(f"{writer.name} stopped by {number.name} at {after:.1f} s", make)

    return attempts


def placed(random: Random) -> Iterator[Attempt]:
    """Kills before a rename, of each command that writes a set of files."""
    while True:
        for writer in WRITERS:
            at = random.randrange(len(writer.older) + 2)

            def make(shop: Workshop, writer: Writer = writer, at: int = at) -> Outcome:
                return replaced(shop, writer, lambda: shop.process(str(at), *writer.command, program=AT_RENAME))

            yield Attempt(f"{writer.name} killed before rename {at}", make)


def replaced(shop: Workshop, writer: Writer, stop: Callable[[], Done]) -> Outcome:
    """A set of files over an older one, by a stopped command, then a whole one: never both without a word."""
    for name, text in writer.files.items():
        shop.write(name, text)
    for name in writer.older:
        shop.write(f"{writer.folder}/{name}", "old")
    done = stop()
    if done.late or "Traceback" in done.err:
        return broken(done) or Outcome("hang", done.late)
    place = shop.folder / writer.folder
    ages = {name: (place / name).read_bytes() == b"old" for name in writer.older}
    if len({*ages.values()}) > 1 and not (place / "HALF_NEW.txt").exists():
        return Outcome("silent", f"half new without a word: {ages}")
    again = shop.process(*writer.command)
    if again.status not in writer.statuses or "Traceback" in again.err:
        return broken(again) or Outcome("silent", f"status {again.status}: {again.err[-200:]!r}")
    if any((place / name).read_bytes() == b"old" for name in writer.older):
        return Outcome("silent", "files of the older set are left")
    return nothing_left(shop.folder)


def at_once(_: Random) -> Iterator[Attempt]:
    """Two processes with one output, and on one cold cache of kernels."""
    yield Attempt("two simulations into one folder", two_simulations)
    yield Attempt("two simulations into one folder, again", two_simulations)
    yield Attempt("two processes on a cold cache", cold_cache)


def two_simulations(shop: Workshop) -> Outcome:
    """One of them has the folder and the other is refused and names it, or they come one after the other."""
    shop.write("case.toml", inputs.CASE)
    processes = [shop.start(*SIMULATE) for _ in range(2)]
    done = [shop.wait(p) for p in processes]
    for one in done:
        if (bad := broken(one)) is not None:
            return bad
    statuses = sorted(d.status for d in done)
    if statuses == [0, 0]:
        return max((sound(one) for one in done), key=lambda outcome: outcome.kind != "clean")
    if statuses != [0, 2]:
        return Outcome("silent", f"statuses {statuses}")
    refusal = next(d.err for d in done if d.status == 2)
    return CLEAN if "process" in refusal else Outcome("unclear", refusal[:200])


def cold_cache(shop: Workshop) -> Outcome:
    """Both compile; both are right, and the cache serves a third."""
    shop.write("case.toml", SHORT)
    environment = {"LBM_CACHE_DIR": str(shop.folder / "cache")}
    os.mkdir(shop.folder / "cache", 0o700)  # noqa: PTH102
    each = [shop.start("simulate", "case.toml", "--out", f"out{k}", environment=environment) for k in range(2)]
    for done in [shop.wait(p) for p in each]:
        if (outcome := sound(done)).kind != "clean":
            return outcome
    if content(shop.folder / "out0") != content(shop.folder / "out1"):
        return Outcome("silent", "two results")
    return nothing_left(shop.folder / "cache")
