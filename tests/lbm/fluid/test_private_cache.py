"""What is read from the cache is run: only what this user alone can have written, as it was written."""

import json
import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import lbm

KERNELS = """
import json
from lbm.fluid import cache
@cache.kernel(parallel=False)
def double(x):
    return 2 * x
@cache.kernel(parallel=False)
def square(x):
    return x * x
print(json.dumps([double(3.0), square(3.0), cache.compiled_count(), cache.source_hash()]))
"""


@pytest.fixture
def program(tmp_path):
    (tmp_path / "program.py").write_text(KERNELS)
    return tmp_path / "program.py"


def run(program, caches, before="", **environment):
    environment = {**os.environ, "PYTHONPATH": str(Path(lbm.__file__).parent.parent), **environment}
    if caches is not None:
        environment["LBM_CACHE_DIR"] = str(caches)
    command = f"{before}import runpy; runpy.run_path({str(program)!r})"
    done = subprocess.run(
        [sys.executable, "-c", command], env=environment, capture_output=True, text=True, check=True
    )
    *results, compiled, source_hash = json.loads(done.stdout)
    assert results == [6.0, 9.0]
    return compiled, source_hash, done.stderr


class Planted:
    """What leaves a mark where it is unpickled, as any program might."""

    def __init__(self, mark):
        self.mark = str(mark)

    def __reduce__(self):
        return open, (self.mark, "w")


def plant(caches, mark):
    indices = list(caches.rglob("*.nbi"))
    assert indices
    for path in indices:
        path.write_bytes(pickle.dumps(Planted(mark)))


def of_another_user(path):
    if os.geteuid() != 0:
        pytest.skip("only root can give files away")
    os.chown(path, 54321, 54321)


@pytest.mark.parametrize(
    "whose", ["writable folder", "writable folder above", "another's folder", "writable files", "another's files"]
)
def test_what_others_may_have_written_is_never_run(whose, program, tmp_path):
    caches, mark = tmp_path / "caches", tmp_path / "ran"
    _, source_hash, _ = run(program, caches)
    plant(caches, mark)
    if whose == "writable folder":
        (caches / source_hash).chmod(0o777)
    elif whose == "writable folder above":
        caches.chmod(0o770)
    elif whose == "another's folder":
        of_another_user(caches / source_hash)
    for path in caches.rglob("*.nbi"):
        if whose == "writable files":
            path.chmod(0o666)
        elif whose == "another's files":
            of_another_user(path)
    compiled, _, said = run(program, caches)
    assert not mark.exists()
    assert compiled == 2
    assert said.count("CacheWarning: ") == 1


def test_the_mark_would_be_left_by_what_is_read(program, tmp_path):
    """Without which the test above would show nothing."""
    run(program, tmp_path / "caches")
    plant(tmp_path / "caches", tmp_path / "ran")
    run(program, tmp_path / "caches")
    assert (tmp_path / "ran").exists()


@pytest.mark.parametrize("damage", ["exchanged", "flipped"])
def test_a_kernel_that_is_not_as_it_was_written_is_replaced(damage, program, tmp_path):
    caches = tmp_path / "caches"
    run(program, caches)
    kernels = sorted(caches.rglob("*.nbc"))
    contents = [bytearray(path.read_bytes()) for path in kernels]
    if damage == "exchanged":
        contents.reverse()
    else:
        for content in contents:
            content[len(content) // 2] ^= 1
    for path, content in zip(kernels, contents, strict=True):
        path.write_bytes(content)
    compiled, _, said = run(program, caches)
    assert (compiled, said.count("CacheWarning: ")) == (2, 1)
    compiled, _, said = run(program, caches)
    assert (compiled, said.count("CacheWarning: ")) == (0, 0)


def test_what_is_kept_is_for_this_user_alone(program, tmp_path):
    """Whatever the usual mode of new files is, as where every user has a group of his own."""
    caches = tmp_path / "caches"
    run(program, caches, before="import os; os.umask(0o002); ")
    made = [caches, *caches.rglob("*")]
    assert any(path.suffix == ".nbc" for path in made)
    assert all(path.stat().st_mode & 0o077 == 0 for path in made)
    compiled, _, said = run(program, caches)
    assert (compiled, said.count("CacheWarning: ")) == (0, 0)


def test_no_home_directory_is_needed(program):
    """As in a container whose user has a number but neither a name nor a home."""
    homeless = "import os, pwd; os.environ.pop('HOME', None); os.environ.pop('XDG_CACHE_HOME', None); "
    homeless += "os.environ.pop('LBM_CACHE_DIR', None); pwd.getpwuid = lambda _: {}['no such user']; "
    compiled, _, said = run(program, None, before=homeless)
    assert compiled == 2
    assert said.count("CacheWarning: ") == 1
