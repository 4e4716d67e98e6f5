"""The house: rooms that can be drawn from memory. Which room knows which is a contract in pyproject.toml."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("lbm", "restitution")
LIKE_THINGS = {"restitution/laws", "restitution/commands"}
"""Folders of things of one kind, which may be wide."""
WIDEST, LONGEST = 15, 320


def modules(*places):
    return [path for place in places for path in sorted((ROOT / place).rglob("*.py"))]


def name(path):
    return path.relative_to(ROOT).as_posix()


def imported(path):
    """Names of the modules that a file imports, at the top or anywhere within."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module


def importers(package, *places):
    return {name(path) for path in modules(*places) if any(n.split(".")[0] == package for n in imported(path))}


def test_the_solver_knows_nothing_of_the_toolkit_nor_do_its_tests():
    assert importers("restitution", "lbm", "tests/lbm") == set()


def test_benchmarks_are_imported_by_nobody():
    assert importers("benchmarks", "lbm", "restitution", "tests", "examples") == set()


def test_no_module_is_too_long():
    assert [name(path) for path in modules(*PACKAGES) if len(path.read_text("utf-8").splitlines()) > LONGEST] == []


def folders():
    return sorted({path.parent for path in modules(*PACKAGES)})


@pytest.mark.parametrize("folder", folders(), ids=name)
def test_a_folder_of_unlike_things_is_not_too_wide(folder):
    assert name(folder) in LIKE_THINGS or len(list(folder.glob("*.py"))) <= WIDEST


@pytest.mark.parametrize("folder", [f for f in folders() if name(f) not in (*PACKAGES, *LIKE_THINGS)], ids=name)
def test_a_face_names_its_rooms(folder):
    face = (folder / "__init__.py").read_text("utf-8")
    rooms = {path.stem for path in folder.glob("*.py")} | {
        path.parent.name for path in folder.glob("*/__init__.py")
    }
    assert [room for room in sorted(rooms - {"__init__"}) if room not in face] == []


def test_tests_mirror_the_tree():
    tests = {path.parent for path in modules(*(f"tests/{package}" for package in PACKAGES))}
    assert [name(t) for t in sorted(tests) if not (ROOT / t.relative_to(ROOT / "tests")).is_dir()] == []
