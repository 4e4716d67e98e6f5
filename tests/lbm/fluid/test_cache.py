"""A change anywhere in the package must not be answered by an old kernel."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import lbm

SCRIPT = """
import json, numpy as np
from lbm import Rates, Simulation
from lbm.fluid import cache
flow = Simulation((8, 8, 8), Rates.two_relaxation_times(0.1))
flow.set_flow(1.0, 0.02 * np.random.default_rng(0).standard_normal((3, 8, 8, 8)))
flow.run(2, guard=None)
print(json.dumps([cache.source_hash(), cache.compiled_count(), float(np.abs(flow.velocity).sum())]))
"""


def _run(root, caches):
    environment = {**os.environ, "PYTHONPATH": str(root), "LBM_CACHE_DIR": str(caches)}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=root, env=environment, capture_output=True, text=True, check=True
    )
    return (*json.loads(done.stdout), done.stderr)


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """A copy of the package, its cache after one run, and what that run gave."""
    root = tmp_path_factory.mktemp("first")
    shutil.copytree(Path(lbm.__file__).parent, root / "lbm", ignore=shutil.ignore_patterns("__pycache__"))
    return root, root / "caches", _run(root, root / "caches")


def test_a_second_process_compiles_nothing(first):
    root, caches, (source_hash, compiled, result, said) = first
    assert compiled > 0
    assert "compiling" in said
    again_hash, compiled, again, said = _run(root, caches)
    assert (again_hash, compiled, again) == (source_hash, 0, result)
    assert "compiling" not in said


def test_editing_an_inlined_function_compiles_anew(first, tmp_path):
    root, caches, (source_hash, _, result, _) = first
    shutil.copytree(root / "lbm", tmp_path / "lbm", ignore=shutil.ignore_patterns("__pycache__"))
    # the collision is inlined in the kernels, but stands in another file
    inlined = tmp_path / "lbm" / "fluid" / "collision.py"
    source = inlined.read_text()
    edited = source.replace("one / (one + drho)", "one")
    assert edited != source
    inlined.write_text(edited)
    edited_hash, compiled, changed, _ = _run(tmp_path, caches)
    assert edited_hash != source_hash
    assert compiled > 0
    assert changed != result


@pytest.mark.parametrize("trouble", ["unwritable", "damaged"])
def test_without_a_usable_cache_kernels_are_compiled_in_memory(trouble, first, tmp_path):
    """A place that cannot be written, files that cannot be read: a warning, and the same result."""
    root, caches, (_, _, result, _) = first
    if trouble == "unwritable":
        (tmp_path / "file").touch()
        place = tmp_path / "file" / "caches"
    else:
        place = shutil.copytree(caches, tmp_path / "caches")
        for path in place.rglob("*.nb?"):
            path.write_bytes(path.read_bytes()[:20] if path.suffix == ".nbc" else b"")
    _, compiled, found, said = _run(root, place)
    assert compiled > 0
    assert said.count("CacheWarning: ") == 1
    assert found == result
    assert ("load the kernels from the cache" in said) == (trouble == "damaged")
    if trouble == "damaged":  # replaced by that run
        _, compiled, found, said = _run(root, place)
        assert (compiled, found) == (0, result)
        assert "CacheWarning" not in said
