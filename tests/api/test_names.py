"""`import harness`: the public names, at no cost until one is used."""

from __future__ import annotations

import subprocess
import sys

import pytest

import harness

HEAVY = {"numpy", "pandas", "scipy", "numba", "mujoco", "pybullet", "matplotlib", "pydantic", "rich"}


@pytest.mark.parametrize("name", harness.__all__)
def test_every_name_is_there_and_documented(name: str) -> None:
    """Resolve every public name, with a docstring, and list it."""
    assert getattr(harness, name).__doc__
    assert name in dir(harness)


def test_a_name_that_is_not_there_is_told() -> None:
    """Fail as any module does."""
    with pytest.raises(AttributeError, match="no attribute 'diagnosis_of'"):
        _ = harness.diagnosis_of


def test_importing_the_package_imports_nothing_heavy() -> None:
    """Leave everything that takes time to whoever uses it."""
    script = f"import harness, sys; print(*({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
