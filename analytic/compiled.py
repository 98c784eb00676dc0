"""Compiled code, kept so that a changed source is never run in an old compilation.

numba looks only at the file of the function it compiled: a function in another file that calls a changed one would go
on with the old. So the cache is one per state of all compiled sources. It is chosen when this module is imported, which
is why every compiled function takes `njit` from here.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numba
from numba import njit

__all__ = ["keep_compiled_code_fresh", "njit"]

_PACKAGES = ("analytic", "harness")


def keep_compiled_code_fresh() -> None:
    """Give numba a cache folder that is named after the sources; a folder that the user set stays."""
    config: Any = numba.config
    if config.CACHE_DIR:
        return
    root = Path(__file__).parent
    state = hashlib.sha256()
    for package in _PACKAGES:
        for file in sorted((root.parent / package).rglob("*.py")):
            text = file.read_bytes()
            if b"njit" in text:
                state.update(text)
    name = f"numba-{state.hexdigest()[:16]}"
    for folder in (root / "__pycache__", Path.home() / ".cache" / "ball-beam-harness"):
        try:
            (folder / name).mkdir(parents=True, exist_ok=True)
        except OSError:  # installed where the user may not write
            continue
        config.CACHE_DIR = str(folder / name)
        return


keep_compiled_code_fresh()
