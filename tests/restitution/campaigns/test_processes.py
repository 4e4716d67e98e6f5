"""Processes of this machine: a Ctrl-C that finds them half started is theirs to end on, not to report."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.sweeps import ROOT

SCRIPT = """
import time
from restitution.campaigns.processes import LocalProcesses

if __name__ == "__main__":
    processes = LocalProcesses(1)
    future = processes.submit(time.sleep, 60)
    print("submitted", flush=True)
    try:
        future.result()
    except KeyboardInterrupt:
        processes.interrupt()
        processes.shutdown(cancel_futures=True)
        print("stopped", flush=True)
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="sends a terminal's interrupt")
@pytest.mark.parametrize("seconds", [0.0, 0.05])
def test_an_interrupt_while_processes_start_ends_them_silently(tmp_path, seconds):
    script = tmp_path / "submits.py"
    script.write_text(SCRIPT)
    driver = subprocess.Popen(
        [sys.executable, str(script)], env=os.environ | {"PYTHONPATH": str(ROOT)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    assert driver.stdout.readline() == "submitted\n"
    time.sleep(seconds)
    os.killpg(driver.pid, signal.SIGINT)
    out, said = driver.communicate(timeout=50)
    assert out == "stopped\n"
    assert said == ""


UNGUARDED = """
import os
from restitution.campaigns.processes import LocalProcesses

print("begins", flush=True)
processes = LocalProcesses(2)
others = {processes.submit(os.getpid).result() for _ in range(2)}
print(len(others - {os.getpid()}), flush=True)
processes.shutdown()
"""


def test_a_script_without_a_guard_is_not_begun_again_by_its_processes(tmp_path):
    script = tmp_path / "submits.py"
    script.write_text(UNGUARDED)
    done = subprocess.run(
        [sys.executable, str(script)], env=os.environ | {"PYTHONPATH": str(ROOT)}, text=True,
        capture_output=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() in (["begins", "1"], ["begins", "2"])
    assert done.stderr == ""
