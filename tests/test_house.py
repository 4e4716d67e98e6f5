"""Which package knows which: the solver nothing of the toolkit, the toolkit the solver in one module."""

import ast
from pathlib import Path

import pytest

import lbm
import restitution


def importers(package, name):
    """Modules of ``package`` that import ``name``, at the top or anywhere within."""
    root = Path(package.__file__).parent
    found = set()
    for path in root.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and node.level == 0 else []
            if any(n.split(".")[0] == name for n in names):
                found.add(path.relative_to(root).as_posix())
    return found


@pytest.mark.parametrize(
    ("package", "name", "allowed"), [(lbm, "restitution", set()), (restitution, "lbm", {"resolved.py"})]
)
def test_the_packages_meet_in_one_module(package, name, allowed):
    assert importers(package, name) == allowed
