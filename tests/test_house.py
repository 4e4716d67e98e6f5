"""Which module knows which: the solver nothing of the toolkit, the toolkit the solver in one module."""

import ast
import graphlib
import importlib.util
from pathlib import Path

import pytest

import lbm
import restitution

NOT_YET = ("lbm.", "restitution.report.fig2.content")


def imported(path):
    """Names of the modules that a file imports, at the top or anywhere within."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def importers(package, name):
    """Modules of ``package`` that import ``name``."""
    root = Path(package.__file__).parent
    return {
        path.relative_to(root).as_posix()
        for path in root.rglob("*.py")
        if any(n.split(".")[0] == name for n in imported(path))
    }


@pytest.mark.parametrize(
    ("package", "name", "allowed"),
    [(lbm, "restitution", set()), (restitution, "lbm", {"runs/resolved.py", "runs/setup.py"})],
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


def test_benchmarks_are_imported_by_nobody():
    root = Path(__file__).parent.parent
    files = [path for place in ("tests", "lbm", "restitution") for path in (root / place).rglob("*.py")]
    names = {name for path in files for name in imported(path) if name.split(".")[0] == "benchmarks"}
    assert names <= {"lbm.problems.spheres"}  # becomes lbm.problems.flows.spheres


def test_the_solver_is_tested_without_the_toolkit():
    files = (Path(__file__).parent / "lbm").rglob("*.py")
    assert [path.name for path in files if any(n.split(".")[0] == "restitution" for n in imported(path))] == []


def test_no_module_needs_one_that_needs_it():
    """Imports within functions and those for types count: what a content is made into it does not know."""
    modules = {}
    for package in (lbm, restitution):
        root = Path(package.__file__).parent
        for path in root.rglob("*.py"):
            name = ".".join(path.relative_to(root.parent).with_suffix("").parts)
            modules[name.removesuffix(".__init__")] = path
    needs = {
        name: {n if n in modules else n.rpartition(".")[0] for n in imported(path)} & modules.keys() - {name}
        for name, path in modules.items()
        if not name.startswith(NOT_YET)
    }
    graphlib.TopologicalSorter(needs).prepare()  # raises, naming the circle
