"""Compiled code is kept by the state of its sources, and nobody else's cache is touched."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from analytic import compiled

ROOT = Path(compiled.__file__).parent.parent
CALLER = """
from analytic.compiled import njit
from analytic.callee import FACTOR, twice

@njit(cache=True)
def value(x):
    return FACTOR * twice(x)
"""
CALLEE = """
from analytic.compiled import njit

FACTOR = {factor}

@njit(cache=True)
def twice(x):
    return {two} * x
"""
OTHER = """
import numba

before = numba.config.CACHE_DIR
import analytic.caller
assert numba.config.CACHE_DIR == before

@numba.njit(cache=True)
def other(x):
    return x

other(1)
print(analytic.caller.value(1), sum(analytic.caller.value.stats.cache_hits.values()))
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package `analytic` of two small modules in place of ours, and a module of somebody else beside it."""
    folder = tmp_path / "analytic"
    folder.mkdir()
    (folder / "__init__.py").touch()
    shutil.copy(compiled.__file__, folder)
    (folder / "caller.py").write_text(CALLER)
    (folder / "callee.py").write_text(CALLEE.format(factor=10, two=2))
    (tmp_path / "other.py").write_text(OTHER)
    return tmp_path


def run(package: Path, **environment: str) -> list[int]:
    """What `caller.value(1)` returns in a new process, and how often it was found compiled."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "PYTHONPATH"))}
    command = [sys.executable, "-c", "import other"]
    done = subprocess.run(command, cwd=package, env=clean | environment, capture_output=True, text=True, check=True)
    return [int(word) for word in done.stdout.split()]


@pytest.mark.slow
def test_a_change_in_another_file_is_never_missed(package: Path) -> None:
    """Compile anew after a change of a called function or of a constant, and only then."""
    assert run(package) == [20, 0]
    assert run(package) == [20, 1]
    (package / "analytic" / "callee.py").write_text(CALLEE.format(factor=10, two=3))
    assert run(package) == [30, 0]
    (package / "analytic" / "callee.py").write_text(CALLEE.format(factor=100, two=3))
    assert run(package) == [300, 0]
    (package / "analytic" / "callee.py").write_text(CALLEE.format(factor=10, two=2))
    assert run(package) == [20, 1]


@pytest.mark.slow
def test_the_cache_lies_where_numba_puts_it(package: Path) -> None:
    """Keep ours and somebody else's code beside the sources, or in the folder the user names."""
    run(package)
    assert list((package / "analytic" / "__pycache__").glob("caller.value-*.nbi"))
    assert list((package / "__pycache__").glob("other.other-*.nbi"))
    chosen = package / "chosen"
    assert run(package, NUMBA_CACHE_DIR=str(chosen)) == [20, 0]
    found = {file.name.split("-")[0] for file in chosen.rglob("*.nbi")}
    assert found == {"caller.value", "callee.twice", "other.other"}


def test_compiled_code_lets_other_threads_run() -> None:
    """Release Python's global lock in whatever is compiled, so that fits in threads run side by side."""

    @compiled.njit(cache=False)
    def twice(x: float) -> float:
        return 2.0 * x

    assert twice(1.0) == 2.0
    assert twice.targetoptions["nogil"]  # type: ignore[attr-defined]


def test_every_compiled_function_is_kept_by_its_sources() -> None:
    """Take `njit` from `analytic.compiled` in every module: numba's own cache would outlive a changed callee."""
    taken = re.compile(r"from numba import [^\n]*\bn?jit\b|numba\.n?jit\b")
    sources = [file for package in ("analytic", "harness") for file in (ROOT / package).rglob("*.py")]
    assert len(sources) > 50
    beside = [file for file in sources if taken.search(file.read_text(encoding="utf-8"))]
    assert beside == [Path(compiled.__file__)]


def test_compiled_functions_read_nothing_from_other_sources() -> None:
    """Import from our own packages nothing into a compiled function that the cache's digest does not see."""
    sources = compiled.sources()
    assert ROOT / "analytic" / "slots.py" in sources
    seen = {".".join(file.relative_to(ROOT).with_suffix("").parts) for file in sources}
    for file in sources:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        unseen = {
            alias.asname or alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in ("analytic", "harness")
            for alias in node.names
            if not {node.module, f"{node.module}.{alias.name}"} & seen
        }
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef) and "njit" in "".join(map(ast.unparse, function.decorator_list)):
                body = {node.id for line in function.body for node in ast.walk(line) if isinstance(node, ast.Name)}
                assert not body & unseen, f"{file.name}: {function.name}"
