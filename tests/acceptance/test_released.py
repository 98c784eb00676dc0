"""Runs of a second or two, from one end of the beam to the other, are diagnosed as longer recordings are."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from tests.recording.released import Release, released

DAMPING = 0.25  # over the ball's mass [1/s]
TILTS = (0.04, 0.05, 0.06, 0.07, 0.08, 0.09)


@pytest.mark.slow
def test_a_ball_that_leans_on_a_stop_hides_nothing(tmp_path: Path) -> None:
    """Find the damping and nothing else where each run begins against a stop under 2° and ends at the other one.

    The plant's d ṡ is an acceleration of the rolling ball: the force is (1 + 2/5) m d ṡ.
    """
    runs = [Release(begin=0.4, lean=0.03, wait=0.8, tilt=tilt, damping=DAMPING, bounces=True) for tilt in TILTS]
    found = harness.diagnose(released(tmp_path, runs, seed=4), progress=False)
    assert list(found.effects) == ["viscous_damping"]
    coefficient = found.effects["viscous_damping"]["coefficient"]
    # Its 95 % interval reaches 5 % to either side: twice that.
    assert coefficient.value == pytest.approx(1.4 * 0.1 * DAMPING, rel=0.1)
    assert found.record.errors.heldout.after.rms_m["whole"] < 0.3 * found.record.errors.heldout.before.rms_m["whole"]


@pytest.mark.slow
def test_a_late_position_of_short_runs_is_a_delay(tmp_path: Path) -> None:
    """Find the delay, where an acceleration that comes late was taken for a wrong sampling rate."""
    runs = [Release(tilt=tilt, delay=0.066) for tilt in TILTS]
    found = harness.diagnose(released(tmp_path, runs, rate=200, seed=5), progress=False)
    assert list(found.effects) == ["channel_delay"]
    delay = found.effects["channel_delay"]["delay"]
    assert delay.value == pytest.approx(0.066, abs=2e-3)
