"""Which module knows which: the solver nothing of the toolkit, the toolkit the solver in one module."""

import ast
import importlib.util
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


def own_names():
    """(importer, module, name) of everything that a module takes from another of the house, lazy or for types."""
    for package in (lbm, restitution):
        root = Path(package.__file__).parent
        for path in root.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in (
                    "lbm",
                    "restitution",
                ):
                    for alias in node.names:
                        yield path.relative_to(root.parent).as_posix(), node.module, alias.name


def is_there(module, name):
    there = importlib.import_module(module)
    if hasattr(there, name):
        return True
    return hasattr(there, "__path__") and importlib.util.find_spec(f"{module}.{name}") is not None


def test_every_name_that_is_imported_is_there():
    assert [entry for entry in own_names() if not is_there(*entry[1:])] == []
