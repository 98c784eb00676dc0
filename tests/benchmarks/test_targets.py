"""The committed tables show that a diagnosis can be trusted."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.calibration.targets import Target, targets
from tests.benchmarks.made import committed

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.mark.parametrize("target", targets(committed(DOCS)), ids=lambda one: one.what)
def test_committed_tables_meet_the_targets(target: Target) -> None:
    """Meet each target with as many cases as it asks for."""
    assert target.met, f"{target.what}: {target.measured[0]:.1%} of {target.cases}, allowed {target.allowed}"
