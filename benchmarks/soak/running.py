"""Commands tried in a folder of their own, with limits of time and memory.

Most are tried in a fork of this process, which has loaded the libraries already; what is to be killed, to meet a
full disk or another environment is a process of its own.
"""

from __future__ import annotations

import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SECONDS = 20
"""Of the processor; what is meant to be refused takes about one."""
PATIENCE = 20.0
"""Seconds of the clock for one of the processor, on a machine that others use."""
MEGABYTES = 400
"""More than this process has, of which a fork has all."""


@dataclass(frozen=True)
class Done:
    """What a command did: its status (negative: the signal), what it said, where; why it was stopped."""

    status: int
    out: str
    err: str
    folder: Path
    late: str = ""


class Workshop:
    """An empty folder to try things in, and the means to try them."""

    def __init__(self, folder: Path):
        self.folder = folder

    def write(self, name: str, content: str | bytes) -> Path:
        """Put a file there."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content)
        return path

    def command(self, *arguments: str, seconds: int = SECONDS) -> Done:
        """``restitution ARGUMENTS`` in a fork."""
        from restitution.cli import main

        return self.call(lambda: main(list(arguments)), seconds)

    def call(self, work: Callable[[], int | None], seconds: int = SECONDS) -> Done:
        """Some work in a fork: its status is what it returns."""
        out, err = (tempfile.TemporaryFile() for _ in range(2))  # noqa: SIM115
        ended, alive = os.pipe()
        number = os.fork()
        if number == 0:
            os.close(ended)
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            self._be_it(work, out.fileno(), err.fileno())
        os.close(alive)
        in_time = select.select([ended], [], [], PATIENCE * seconds)[0]
        if not in_time:
            os.kill(number, signal.SIGKILL)
        _, status, used = os.wait4(number, 0)
        os.close(ended)
        killed = os.waitstatus_to_exitcode(status) in (-signal.SIGXCPU, -signal.SIGKILL)
        late = f"{seconds} s" if killed else ""
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        if used.ru_maxrss - own > MEGABYTES * 1024:
            late = f"{MEGABYTES} MB"
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "replace"))
            stream.close()
        return Done(os.waitstatus_to_exitcode(status), *texts, self.folder, late)

    def _be_it(self, work: Callable[[], int | None], out: int, err: int) -> None:
        status = 1
        try:
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            os.dup2(out, 1)
            os.dup2(err, 2)
            sys.stdout, sys.stderr = (os.fdopen(n, "w", encoding="utf-8", errors="replace") for n in (1, 2))
            os.chdir(self.folder)
            try:
                status = work() or 0
            except SystemExit as stopped:
                status = stopped.code if isinstance(stopped.code, int) else 1
            except KeyboardInterrupt:
                status = 130
            except BaseException:  # noqa: BLE001
                traceback.print_exc()
            for stream in (sys.stdout, sys.stderr):
                if stream is not None and not stream.closed:
                    stream.flush()
        finally:
            os._exit(status)

    def start(self, *arguments: str, program: str | None = None, **options) -> subprocess.Popen:
        """A process of its own: ``restitution ARGUMENTS``, or a Python ``program`` with them."""
        how = ["-m", "restitution"] if program is None else ["-c", program]
        environment = {**os.environ, "PYTHONPATH": str(ROOT), **options.pop("environment", {})}
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "cwd": self.folder} | options
        return subprocess.Popen([sys.executable, *how, *arguments], env=environment, **options)

    def process(self, *arguments: str, seconds: int = 6 * SECONDS, **options) -> Done:
        """The same, waited for."""
        return self.wait(self.start(*arguments, **options), seconds)

    def wait(self, process: subprocess.Popen, seconds: int = 6 * SECONDS) -> Done:
        """What a process that was started came to."""
        late = ""
        try:
            out, err = process.communicate(timeout=PATIENCE / 4 * seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            late = f"{seconds:g} s"
        texts = [(t or b"").decode("utf-8", "replace") for t in (out, err)]
        return Done(process.returncode, *texts, self.folder, late)

    def stop(self, process: subprocess.Popen, after: float, number: signal.Signals, times: int = 1) -> Done:
        """Send it a signal once it has lived so many seconds, or more of them in short order."""
        until = time.monotonic() + after
        while process.poll() is None and time.monotonic() < until:
            time.sleep(min(0.05, max(0.0, until - time.monotonic())))
        for _ in range(times):
            if process.poll() is None:
                process.send_signal(number)
                time.sleep(0.05)
        return self.wait(process)

    def copy(self, other: Path, name: str) -> Path:
        """A copy of a folder or file, to be damaged."""
        place = self.folder / name
        if other.is_dir():
            shutil.copytree(other, place)
        else:
            shutil.copy(other, place)
        return place


def preload() -> None:
    """Load what the commands load, before the forks."""
    import importlib

    names: Sequence[str] = (
        "restitution.cli", "restitution.calibration", "restitution.calibration.trajectories.fit",
        "restitution.calibration.result.ranking", "restitution.calibration.result.fit_file",
        "restitution.calibration.estimation.posterior", "restitution.report.fits.report", "restitution.bounce",
        "restitution.runs.simulate", "restitution.runs.kept", "restitution.runs.point_particle",
        "restitution.impacts",
        "restitution.report.drawing", "restitution.export", "matplotlib.pyplot", "rich.table", "iminuit",
        "sympy", "h5py",
        "scipy.optimize", "jinja2", "pandas", "restitution.foreign", "restitution.datasets.checks",
    )  # fmt: skip
    for name in names:
        importlib.import_module(name)
