"""`harness compile`: what is compiled once is not compiled again by the commands."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.compiled import njit
from harness.api.compilation import _kernels, _part
from tests.acceptance.short import write_short_case

# Our own functions that numba compiles during a command, in the order of their ends.
WATCHED = """
import json, sys
from numba.core.event import install_recorder
from harness.cli.main import main
with install_recorder("numba:compile") as recorder:
    try:
        main(prog_name="harness")
    except SystemExit as end:
        code = end.code
from harness.api.compilation import _kernels
print(json.dumps([one.name for one in _kernels(recorder.buffer)]))
sys.exit(code)
"""


def call(cache: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """A Python of its own that keeps compiled code in `cache`."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache)}
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True)


def compiled_for(cache: Path, *words: object) -> list[str]:
    """Functions that a command had to compile."""
    names: list[str] = json.loads(call(cache, "-c", WATCHED, *words).stdout.splitlines()[-1])
    return names


@pytest.mark.slow
def test_after_it_a_command_compiles_nothing(tmp_path: Path) -> None:
    """Fill an empty cache: neither a run nor a diagnosis nor a simulation then compiles anything of ours."""
    cache, case = tmp_path / "cache", write_short_case(tmp_path / "case")
    first: dict[str, Any] = json.loads(call(cache, "-m", "harness", "compile", "--json").stdout)
    assert [part["name"] for part in first["parts"]] == ["simulation", "comparison", "diagnosis"]
    names = [one["name"] for part in first["parts"] for one in part["kernels"]]
    assert {"analytic.kernel._integrate", "harness.identify.filter.ekf._filtered"} <= set(names)
    assert first["compiled"] == len(names)
    assert Path(first["cache"]).is_relative_to(cache)
    assert list(cache.rglob("kernel._integrate-*.nbc"))
    assert compiled_for(cache, "run", "--out", tmp_path / "run") == []
    assert compiled_for(cache, "diagnose", case, "--out", tmp_path / "diagnosed") == []
    assert compiled_for(cache, "simulate", "--out", tmp_path / "virtual", "--imperfect") == []


@pytest.mark.slow
def test_without_it_a_command_compiles(tmp_path: Path) -> None:
    """Find what a simulation compiles from an empty cache: the check above can fail."""
    assert "harness.simulator.stepping.describe" in compiled_for(
        tmp_path / "cache", "simulate", "--out", tmp_path / "virtual"
    )


def test_only_our_own_functions_are_listed() -> None:
    """Count a function of ours with its time, not those that numba compiles for it."""

    def total(x):  # type: ignore[no-untyped-def]
        return np.zeros(3).sum() + x

    total.__module__ = "analytic.made_up"
    kernel = njit(cache=False)(total)
    part = _part("a sum", lambda: kernel(1.0))
    assert [one.name.split(".")[1] for one in part.kernels] == ["made_up"]
    assert 0.0 < part.kernels[0].seconds <= part.seconds
    assert _part("again", lambda: kernel(2.0)).kernels == ()
    assert _kernels([]) == ()
