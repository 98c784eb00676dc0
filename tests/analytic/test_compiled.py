"""Compiled code is kept by the state of its sources."""

from __future__ import annotations

import re
from pathlib import Path

import numba

from analytic import compiled

ROOT = Path(compiled.__file__).parent.parent


def test_every_compiled_function_is_kept_by_its_sources() -> None:
    """Take `njit` from where the cache is chosen, in every module: numba's own cache would outlive a changed callee."""
    taken = re.compile(r"from numba import [^\n]*\bn?jit\b|numba\.n?jit\b")
    sources = [file for package in ("analytic", "harness") for file in (ROOT / package).rglob("*.py")]
    assert len(sources) > 50
    beside = [file for file in sources if taken.search(file.read_text(encoding="utf-8"))]
    assert beside == [Path(compiled.__file__)]


def test_the_cache_is_chosen_by_import() -> None:
    """Have a cache folder as soon as `njit` is there."""
    assert numba.config.CACHE_DIR
