"""Files that belong together: all new, or known to be half new, whatever stops the writing and wherever."""

import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from restitution.errors import InputError
from restitution.files import write_folder
from restitution.locks import HALF_NEW

OLD, NEW = ({name: f"{age} {name}" for name in "abcd"} for age in ("old", "new"))
STOPPED = """
import os, signal, sys
from pathlib import Path
from restitution.files import write_folder
folder, number, at = sys.argv[1], signal.Signals(int(sys.argv[2])), int(sys.argv[3])
plain, done = Path.replace, []
def replace(self, target):
    if len(done) == at:
        os.kill(os.getpid(), number)
    done.append(target)
    return plain(self, target)
Path.replace = replace
write_folder(folder, {name: f"new {name}" for name in "abcd"})
"""


def content(folder):
    return {p.name: p.read_text() for p in folder.iterdir() if p.name != HALF_NEW and not p.name.endswith(".part")}


def stopped(folder, number, at):
    """The status of a process that gets a signal before its rename ``at``."""
    write_folder(folder, OLD)
    command = [sys.executable, "-c", STOPPED, str(folder), str(int(number)), str(at)]
    return subprocess.run(command, cwd=Path(__file__).parents[2], stderr=subprocess.PIPE, check=False).returncode


@pytest.mark.parametrize("at", range(4))
def test_a_set_that_a_kill_left_half_new_is_known_and_mended(at, tmp_path):
    assert stopped(tmp_path, signal.SIGKILL, at) == -signal.SIGKILL
    assert content(tmp_path) not in ({}, NEW)
    assert "Run the same command again" in (tmp_path / HALF_NEW).read_text()
    write_folder(tmp_path, NEW)
    assert content(tmp_path) == NEW
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(NEW)


def test_ctrl_c_amid_the_renames_waits_for_them(tmp_path):
    assert stopped(tmp_path, signal.SIGINT, 2) == -signal.SIGINT
    assert content(tmp_path) == NEW
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(NEW)


def test_a_rename_that_fails_says_so_in_the_folder(tmp_path, monkeypatch):
    write_folder(tmp_path, OLD)
    plain = Path.replace

    def replace(self, target):
        if target.name == "c":
            raise OSError(5, "Input/output error")
        return plain(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", replace)
        with pytest.raises(InputError, match="Input/output error"):
            write_folder(tmp_path, NEW)
    assert "c" in (tmp_path / HALF_NEW).read_text()
    assert not list(tmp_path.glob(".*.part"))


def test_sets_of_several_writers_do_not_mix(tmp_path):
    sets = [{name: f"{k} {name}" for name in OLD} for k in range(4)]
    writers = [threading.Thread(target=lambda s=s: [write_folder(tmp_path, s) for _ in range(20)]) for s in sets]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert content(tmp_path) in sets
    assert not (tmp_path / HALF_NEW).exists()


def test_one_file_needs_no_such_word(tmp_path):
    write_folder(tmp_path, {"a": "1"})
    assert [p.name for p in tmp_path.iterdir()] == ["a"]
