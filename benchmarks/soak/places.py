"""Outputs that cannot be written, inputs that are no files, environments: refused, nothing half-written."""

from __future__ import annotations

import os
import resource
import subprocess
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.kills import SHORT
from benchmarks.soak.outcome import Attempt, Outcome, either, refused, same, sound
from benchmarks.soak.running import Done, Workshop

WRITERS = (
    ("fit", "../impacts.csv", *inputs.LAW, "--out", "fit.json"),
    ("fit", "../impacts.csv", *inputs.LAW, "--report", "report"),
    ("impacts", "../track.csv", "--conditions", "../conditions.toml", "--out", "out.csv"),
    ("bounce", "../case.toml", "--out", "out"),
    ("simulate", "../short.toml", "--out", "out"),
    ("export", "eq4_exponential", "--to", "c", "--out", "law.h"),
)


def _files(shop: Workshop) -> None:
    for name, text in {"impacts.csv": inputs.IMPACTS, "track.csv": inputs.track(),
    "conditions.toml": inputs.CONDITIONS,
                       "case.toml": inputs.CASE, "short.toml": SHORT}.items():  # fmt: skip
        shop.write(name, text)


def full_disks(random: Random) -> Iterator[Attempt]:
    """A disk of a few kB where root may make one, limits of a file's size, odd outputs."""
    while True:
        for command in WRITERS:
            size = random.choice((4, 8, 16, 32))
            yield Attempt(
                f"{command[0]} on a disk of {size} kB", lambda shop, c=command, s=size: on_a_small_disk(shop, c, s)
            )
            yield Attempt(
                f"{command[0]} with files of at most {size} B", lambda shop, c=command, s=size: limited(shop, c, s)
            )
        for command, odd in product(WRITERS[:4], ("folder", "under a file", "device", "no folder")):
            yield Attempt(f"{command[0]} to {odd}", lambda shop, c=command, o=odd: to_odd(shop, c, o))


def on_a_small_disk(shop: Workshop, command: tuple[str, ...], kilobytes: int) -> Outcome:
    """A tmpfs of its own; where none can be made, a limit of the size of files."""
    _files(shop)
    place = shop.folder / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k,mode=700", "tmpfs", str(place)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode:
        return limited(shop, command, 256 * kilobytes)
    try:
        return whole_or_nothing(Workshop(place).process(*command), place)
    finally:
        subprocess.run(["umount", str(place)], capture_output=True, check=False)


def limited(shop: Workshop, command: tuple[str, ...], most: int) -> Outcome:
    """RLIMIT_FSIZE in the process: writing beyond it is an error as on a full disk."""
    import signal

    _files(shop)
    place = shop.folder / "limited"
    place.mkdir()

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    return whole_or_nothing(Workshop(place).process(*command, preexec_fn=limit), place)


def whole_or_nothing(done: Done, place: Path) -> Outcome:
    """Either all was written, or status 2, a line, and no file but what a run goes on from."""
    if done.status == 0:
        return sound(done)
    files = [
        p.name
        for p in place.rglob("*")
        if p.is_file() and p.name not in ("checkpoint.h5", "trajectory_so_far.csv")
    ]
    if files:
        return Outcome("silent", f"left behind: {files}")
    return refused(done)


def to_odd(shop: Workshop, command: tuple[str, ...], odd: str) -> Outcome:
    """An output that is a folder, lies under a file, is a device, or in no folder."""
    _files(shop)
    place = shop.folder / "here"
    (place / "folder").mkdir(parents=True)
    (place / "file").write_text("kept")
    out = {"folder": "folder", "under a file": "file/x", "device": "/dev/full", "no folder": "no/such/x"}[odd]
    done = Workshop(place).command(*command[:-1], out)
    if (place / "file").read_text() != "kept":
        return Outcome("silent", "a file was changed")
    return either(done)


def paths(_: Random) -> Iterator[Attempt]:
    """Inputs by odd names, pipes and devices."""
    track, about = inputs.track(), ("--conditions", "conditions.toml")
    for name in ("a b.csv", "a\nb.csv", "日本.csv", "x" * 250 + ".csv", "--a.csv"):
        yield Attempt(f"track {name[:9]!r}", lambda shop, n=name: of_name(shop, n, track, about))
    for name in ("/dev/zero", "/dev/full", ".", "loop.csv", "x" * 300, "none.csv", "/proc/self/mem", ""):
        yield Attempt(f"track {name[:12]!r}", lambda shop, n=name: no_file(shop, n, about))
    yield Attempt("track by a pipe", lambda shop: piped(shop, track, about, "/dev/stdin"))
    yield Attempt("track by a fifo", lambda shop: fifo(shop, track, about))
    yield Attempt(
        "conditions from a device", lambda shop: no_file(shop, "track.csv", ("--conditions", "/dev/zero"))
    )


def of_name(shop: Workshop, name: str, track: str, about: tuple[str, ...]) -> Outcome:
    """A good file, whatever it is called."""
    shop.write("conditions.toml", inputs.CONDITIONS)
    shop.write(name, track)
    return sound(shop.command("impacts", f"./{name}", *about))


def no_file(shop: Workshop, name: str, about: tuple[str, ...]) -> Outcome:
    """What is no file, or never ends, is refused at once."""
    shop.write("conditions.toml", inputs.CONDITIONS)
    shop.write("track.csv", inputs.track())
    (shop.folder / "loop.csv").symlink_to("loop.csv")
    return refused(shop.command("impacts", name, *about))


def piped(shop: Workshop, track: str, about: tuple[str, ...], name: str) -> Outcome:
    """The same result from a pipe as from a file."""
    shop.write("conditions.toml", inputs.CONDITIONS)
    shop.write("track.csv", track)
    expected = shop.process("impacts", "track.csv", *about)
    with (shop.folder / "track.csv").open("rb") as stream:
        cat = subprocess.Popen(["cat"], stdin=stream, stdout=subprocess.PIPE)
        done = shop.process("impacts", name, *about, stdin=cat.stdout)
        cat.wait()
    return same(done, expected.out)


def fifo(shop: Workshop, track: str, about: tuple[str, ...]) -> Outcome:
    """A named pipe, written by another process."""
    shop.write("conditions.toml", inputs.CONDITIONS)
    shop.write("track.csv", track)
    os.mkfifo(shop.folder / "pipe")
    writer = subprocess.Popen(["sh", "-c", "cat track.csv > pipe"], cwd=shop.folder)
    done = shop.process("impacts", "pipe", *about)
    writer.wait()
    return sound(done)


def pipes_out(_: Random) -> Iterator[Attempt]:
    """Outputs that nobody reads, or that are full."""
    for command, where in product((("laws", "list"), ("data", "list")), ("closed", "full", "left")):
        yield Attempt(f"{' '.join(command)} to what is {where}", lambda shop, c=command, w=where: into(shop, c, w))


def into(shop: Workshop, command: tuple[str, ...], where: str) -> Outcome:
    """Standard output closed, on a full device, or left by its reader."""
    if where == "full":
        with Path("/dev/full").open("wb") as full:
            return refused(shop.process(*command, stdout=full))
    if where == "closed":
        return sound(shop.process(*command, preexec_fn=lambda: os.close(1), stdout=None))
    process = shop.start(*command)
    process.stdout.read(10)
    process.stdout.close()
    process.stdout = None
    return sound(shop.wait(process))


def same_bytes(_: Random) -> Iterator[Attempt]:
    """The same output whatever the environment."""
    environments = [
        {"PYTHONHASHSEED": "1"}, {"PYTHONHASHSEED": "7"}, {"NUMBA_NUM_THREADS": "1"}, {"OMP_NUM_THREADS": "1"},
        {"TZ": "Asia/Tokyo"},
        {"LC_ALL": "C", "PYTHONUTF8": "0"}, {"LC_ALL": "POSIX"}, {"COLUMNS": "20"}, {"NO_COLOR": "1"},
        {"MPLBACKEND": "TkAgg"},
        {"PYTHONOPTIMIZE": "2"}, {"PYTHONWARNINGS": "error"}, {"HOME": "/nonexistent"},
        {"PYTHONIOENCODING": "ascii"},
    ]  # fmt: skip
    commands = (("fit", "impacts.csv", *inputs.LAW), ("impacts", "track.csv", "--conditions", "conditions.toml"))
    for environment, command in product(environments, commands):
        yield Attempt(
            f"{command[0]} with {environment}", lambda shop, e=environment, c=command: in_environment(shop, e, c)
        )


def in_environment(shop: Workshop, environment: dict[str, str], command: tuple[str, ...]) -> Outcome:
    """One of them against the usual one."""
    _files(shop)
    usual = shop.command(*command)
    return same(shop.process(*command, environment=environment), usual.out)


def threads(_: Random) -> Iterator[Attempt]:
    """The cache of kernels where others could write to it, damaged, or nowhere; numbers of threads."""
    for value in ("0", "-1", "many", "", "1.5"):
        yield Attempt(
            f"NUMBA_NUM_THREADS={value!r}",
            lambda shop, v=value: simulated(shop, {"NUMBA_NUM_THREADS": v}, refused),
        )
    for mode in (0o777, 0o770):
        yield Attempt(f"cache of mode {mode:o}", lambda shop, m=mode: cache_of(shop, m))
    yield Attempt("no home", lambda shop: simulated(shop, {"HOME": "", "XDG_CACHE_HOME": ""}, sound))
    yield Attempt(
        "cache in a file", lambda shop: simulated(shop, {"LBM_CACHE_DIR": str(shop.write("file", "kept"))}, sound)
    )
    yield Attempt("cache in /proc", lambda shop: simulated(shop, {"LBM_CACHE_DIR": "/proc/x"}, sound))


def simulated(shop: Workshop, environment: dict[str, str], judge) -> Outcome:
    """A short simulation in an environment."""
    shop.write("case.toml", SHORT)
    return judge(shop.process("simulate", "case.toml", "--out", "out", environment=environment))


def cache_of(shop: Workshop, mode: int) -> Outcome:
    """What lies in a folder that others may write to is not run."""
    import pickle

    place = shop.folder / "cache"
    place.mkdir()
    mark = shop.folder / "ran"
    from lbm.fluid import cache

    kept = place / cache.source_hash()
    kept.mkdir()
    for name in ("kernels", "collision", "exchange"):
        (kept / f"{name}.planted.nbi").write_bytes(pickle.dumps(Planted(str(mark))))
    kept.chmod(mode)
    outcome = simulated(shop, {"LBM_CACHE_DIR": str(place)}, sound)
    return Outcome("silent", "a planted file was executed") if mark.exists() else outcome


class Planted:
    """What leaves a mark where it is unpickled, as any program might."""

    def __init__(self, mark: str):
        self.mark = mark

    def __reduce__(self):
        return open, (self.mark, "w")
