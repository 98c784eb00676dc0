"""`harness diagnose` on a rig that records the command of its servo, not the beam's angle."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.acceptance.conftest import call
from tests.identify.estimate.test_angle_noise import LAG, ROLLING, write

LATE = {"angle_servo": 1.0, "angle_lag": 1.0, "angle_hold": 0.5}


@pytest.mark.slow
def test_a_command_is_told_and_replayed(tmp_path: Path) -> None:
    """Name the friction and what lags, of the right sizes, say that the command is no noise, and replay it."""
    case, out = write(tmp_path / "case", measured=None), tmp_path / "out"
    done = call(tmp_path, "diagnose", case, "--out", out)
    assert done.code == 0, done.err
    found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    sizes = {one["name"]: [each["value"] for each in one["parameters"].values()] for one in found["effects"]}
    # A hold of an interval is late by half of it, a servo of damping 1 by its lag; the two differ by little else here.
    (late,) = (share * sizes.pop(name)[0] for name, share in LATE.items() if name in sizes)
    assert late == pytest.approx(LAG, rel=0.1)
    # Taken for noise, the command left friction at 0.0024 ± 0.0005, a fifth too small.
    (friction,) = sizes.values()
    assert friction == pytest.approx([ROLLING] * len(friction), rel=0.1)
    assert found["model"]["held_command"]
    assert found["problem"]["held_command"]
    page = (out / "diagnosis.html").read_text(encoding="utf-8")
    assert "a command that answers the readings of the ball" in page
    replayed = call(tmp_path, "replay", out, case)
    assert replayed.code == 0, replayed.out
    assert "nothing differs" in replayed.out
    predicted = call(tmp_path, "predict", out, case / "rec_01.csv")
    assert predicted.code == 0, predicted.err
