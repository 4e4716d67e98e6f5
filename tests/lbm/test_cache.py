"""A change anywhere in the package must not be answered by an old kernel."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import lbm

SCRIPT = """
import json, numpy as np
from lbm import Rates, Simulation, cache
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


def test_editing_an_inlined_function_compiles_anew(tmp_path):
    package = tmp_path / "lbm"
    shutil.copytree(Path(lbm.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    first_hash, compiled, first, said = _run(tmp_path, tmp_path / "caches")
    assert compiled > 0
    assert "compiling" in said
    again_hash, compiled, again, said = _run(tmp_path, tmp_path / "caches")
    assert (again_hash, compiled, again) == (first_hash, 0, first)
    assert "compiling" not in said
    # the collision is inlined in the kernels, but stands in another file
    inlined = package / "collision.py"
    source = inlined.read_text()
    edited = source.replace("one / (one + drho)", "one")
    assert edited != source
    inlined.write_text(edited)
    edited_hash, compiled, changed, _ = _run(tmp_path, tmp_path / "caches")
    assert edited_hash != first_hash
    assert compiled > 0
    assert changed != first
