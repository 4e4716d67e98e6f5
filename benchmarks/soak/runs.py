"""Checkpoints and kept runs, damaged: refused by name, or gone on from with the same result."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.kills import SHORT, SIMULATE, content
from benchmarks.soak.outcome import CLEAN, Attempt, Outcome, refused, sound
from benchmarks.soak.running import Workshop

STOPPED = """
import sys
from restitution.runs.resolved import ResolvedRun
advance = ResolvedRun.advance
def until(self, observers=()):
    if self.simulation.steps > 40 and self.contacts:
        raise KeyboardInterrupt
    advance(self, observers)
ResolvedRun.advance = until
from restitution.cli import main
sys.exit(main(sys.argv[1:]))
"""
"""The command line, interrupted once the sphere has met the wall."""
OTHER = SHORT + "[sphere]\ne_dry = 0.5\n"


@cache
def _made() -> tuple[tempfile.TemporaryDirectory, Path, Path]:
    """A whole run, and one that was stopped, kept as long as this process lives."""
    keeper = tempfile.TemporaryDirectory(prefix="soak-runs-")
    for name, program in (("whole", None), ("stopped", STOPPED)):
        shop = Workshop(Path(keeper.name) / name)
        shop.write("case.toml", SHORT)
        done = shop.process(*SIMULATE, program=program)
        if done.status not in (0, 130):
            raise RuntimeError(done.err)
    return keeper, Path(keeper.name) / "whole" / "out", Path(keeper.name) / "stopped" / "out"


def resumed(
    damage: Callable[[Path], None], must: bool = False, case: str = SHORT
) -> Callable[[Workshop], Outcome]:
    """``--resume`` from a checkpoint that was damaged: refused, or, unless it ``must`` be, the same result."""

    def make(shop: Workshop) -> Outcome:
        _, whole, stopped = _made()
        shop.write("case.toml", case)
        shutil.copytree(stopped, shop.folder / "out")
        damage(shop.folder / "out" / "checkpoint.h5")
        done = shop.process(*SIMULATE, "--resume")
        if done.status != 0 or must:
            return refused(done, ["checkpoint.h5"])
        if content(shop.folder / "out") != content(whole):
            return Outcome("silent", "gone on from, with another result")
        return sound(done)

    return make


def cut(random: Random) -> Iterator[Attempt]:
    """Cut at some byte."""
    while True:
        part = random.random()
        yield Attempt(
            f"checkpoint cut at {part:.2f}",
            resumed(lambda p, part=part: p.write_bytes(p.read_bytes()[: int(part * p.stat().st_size)])),
        )


def flipped(random: Random) -> Iterator[Attempt]:
    """One bit changed."""
    while True:
        part, bit = random.random(), random.randrange(8)
        yield Attempt(
            f"checkpoint flipped at {part:.3f}", resumed(lambda p, part=part, bit=bit: flip(p, part, bit))
        )


def flip(path: Path, part: float, bit: int) -> None:
    """Change one bit of a file."""
    data = bytearray(path.read_bytes())
    data[int(part * len(data))] ^= 1 << bit
    path.write_bytes(data)


def edited(_: Random) -> Iterator[Attempt]:
    """Numbers, arrays and descriptions changed; of another law; bombs; no HDF5 at all."""
    import h5py

    def edit(change: Callable) -> Callable[[Path], None]:
        def do(path: Path) -> None:
            with h5py.File(path, "r+") as file:
                change(file)

        return do

    def put(name: str, data: object) -> Callable:
        def change(file) -> None:
            del file[name]
            file.create_dataset(name, data=data)

        return change

    def bomb(file) -> None:
        shape = file["slots"].shape
        del file["slots"]
        file.create_dataset("slots", shape=(*shape[:-1], 2**33), dtype="f4", chunks=(*shape[:-1], 1))

    changes = {
        "steps of 1e12": lambda f: f.attrs.modify("steps", 10**12),
        "other parity": lambda f: f.attrs.modify("parity", 1 - f.attrs["parity"]),
        "no seal": lambda f: f.attrs.__delitem__("seal"), "no slots": lambda f: f.__delitem__("slots"),
        "a bomb": bomb,
        "no pictures": lambda f: f.__delitem__("beside"), "another shape": put("body/0/centres", [0.0]),
        "deep description": put("description", "[" * 100_000), "a list for a description": put("description",
        "[]"),
        "null for a description": put("description", "null"), "nan": lambda f: f["slots"].__setitem__(0,
        float("nan")),
        "format": lambda f: f.attrs.modify("format", "x"), "version": lambda f: f.attrs.modify("version", 99),
    }  # fmt: skip
    for name, change in changes.items():
        yield Attempt(f"checkpoint with {name}", resumed(edit(change), must=True))
    for name, data in (("empty", b""), ("text", b"x"), ("zeros", b"\0" * 10_000)):
        yield Attempt(
            f"checkpoint of {name}",
            resumed(lambda p, d=data: p.write_bytes(d), must=True),
        )
    yield Attempt("checkpoint of another law", resumed(lambda _: None, must=True, case=OTHER))


READ = "restitution.runs.kept"


def kept(random: Random) -> Iterator[Attempt]:
    """Tables and ``run.json`` of a kept run, edited, cut, flipped or gone: not taken for what was computed."""
    fields = (("steps", 0), ("steps", 7), ("step_s", -1.0), ("step_s", None), ("contacts", []), ("finished",
    False), ("case_as_run", {}),
              ("numbers", {}), ("files", {}), ("seal", "0"), ("seal", None), ("seconds", "x"), ("shape", [1]),
              ("told", {}), ("physics", 9))  # fmt: skip

    def of_table(name: str, deed: Callable[[bytes], bytes]) -> Attempt:
        return Attempt(f"kept {name} {deed.__name__}", lambda shop: read_kept(shop,
            lambda f: (f / name).write_bytes(deed((f / name).read_bytes()))))  # fmt: skip

    def record(change: Callable[[dict], object]) -> Callable[[Path], object]:
        return lambda f: (f / "run.json").write_text(json.dumps(change(json.loads((f / "run.json").read_text()))))

    for name, value in fields:
        yield Attempt(
            f"kept run.json {name} = {value!r}",
            lambda shop, n=name, v=value: read_kept(shop, record(lambda c: c | {n: v})),
        )
    yield Attempt("kept contact of 99 m/s", lambda shop: read_kept(shop, record(
        lambda c: inputs.edited(c, ("contacts", 0, "speed_out_m_s"), 99.0))))  # fmt: skip
    yield Attempt(
        "kept run.json nested deep",
        lambda shop: read_kept(shop, lambda f: (f / "run.json").write_text("[" * 5000)),
    )

    def half(data: bytes) -> bytes:
        return data[: len(data) // 2]

    def a_row_less(data: bytes) -> bytes:
        return b"\n".join(data.split(b"\n")[:-2]) + b"\n"

    def garbage(_: bytes) -> bytes:
        return b"garbage\n"

    def a_bit(data: bytes) -> bytes:
        at = random.randrange(len(data))
        return data[:at] + bytes([data[at] ^ (1 << random.randrange(8))]) + data[at + 1 :]

    while True:
        for name in ("trajectory.csv", "velocity.csv", "impacts.csv", "flow.npz", "run.json"):
            for deed in (half, a_row_less, garbage, a_bit):
                if not (deed is a_row_less and name == "flow.npz"):
                    yield of_table(name, deed)


def read_kept(shop: Workshop, damage: Callable[[Path], object]) -> Outcome:
    """Read by what the reports read it with."""
    _, whole, _ = _made()
    place = shop.folder / "runs" / "case"
    shutil.copytree(whole, place)
    before = content(place)
    damage(place)

    def read() -> int:
        from restitution.errors import InputError
        from restitution.runs.kept import own_runs

        try:
            found = own_runs(shop.folder / "runs", [])
        except InputError as error:
            import sys

            print(error, file=sys.stderr)
            return 2
        print(len(found))
        return 0

    done = shop.call(read)
    if done.status == 0 and content_or_none(place) == before:
        return CLEAN  # as a bit of the date, which nothing depends on
    return refused(done, ["runs/case"])


def content_or_none(place: Path) -> dict | None:
    """The files of a run, None where they cannot be read."""
    try:
        return content(place)
    except (ValueError, AttributeError):
        return None


def pictures(_: Random) -> Iterator[Attempt]:
    """Pictures of the flow beside a checkpoint, damaged: they play no part in going on."""
    for name, data in (
        ("empty", b""),
        ("text", b"PK"),
        ("cut", None),
        ("of a pickle", b"\x80\x04N."),
        ("zeros", b"\0" * 999),
    ):
        yield Attempt(f"flow.npz {name} and --resume", lambda shop, d=data: beside(shop, d))
        yield Attempt(f"flow.npz {name} of a kept run", lambda shop, d=data: read_kept(
            shop, lambda f: change(f / "flow.npz", d)))  # fmt: skip


def change(path: Path, data: bytes | None) -> None:
    """Other content; None cuts the end off."""
    path.write_bytes(path.read_bytes()[:-9] if data is None else data)


def beside(shop: Workshop, data: bytes | None) -> Outcome:
    """A damaged flow.npz in a folder where a run goes on."""
    _, whole, _ = _made()

    def damage(checkpoint: Path) -> None:
        shutil.copy(whole / "flow.npz", checkpoint.parent)
        change(checkpoint.parent / "flow.npz", data)

    return resumed(damage)(shop)
