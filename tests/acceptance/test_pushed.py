"""A ball that waited at an end stop and was pushed is diagnosed from where nothing but the beam moves it."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from tests.recording.released import RIG
from tests.recording.simulated import write
from tests.recording.stopped import Run, stopped

DAMPING = 0.35  # over the ball's mass [1/s]
PUSHES = ({6.2: 0.25}, {9.3: -0.3}, {5.2: 0.25})


@pytest.mark.slow
def test_what_was_missing_is_found_between_pushes(tmp_path: Path) -> None:
    """Find the damping and nothing else in recordings of 14 s that begin at a stop and hold a push each.

    The plant's d ṡ is an acceleration of the rolling ball: the force is (1 + 2/5) m d ṡ.
    """
    for number, pushes in enumerate(PUSHES, start=1):
        made = stopped(Run(held=2.0, damping=DAMPING, pushes=pushes), seed=10 + number)
        write(tmp_path / f"rec_0{number}.csv", made.columns)
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    found = harness.diagnose(tmp_path, progress=False)
    assert {one.code for one in found.record.findings} >= {"end-stop", "push"}
    assert list(found.effects) == ["viscous_damping"]
    coefficient = found.effects["viscous_damping"]["coefficient"]
    # Its 95 % interval reaches 0.3 % to either side: three times that.
    assert coefficient.value == pytest.approx(1.4 * 0.1 * DAMPING, rel=0.01)
