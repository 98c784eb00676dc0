"""Errors of the engines on random motions: the motions, the scheme's own error, and the pages."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from analytic.kernel import simulate
from analytic.models import CAM
from analytic.rig import Rig
from benchmarks.accuracy.motions import FARTHEST, drawn
from benchmarks.accuracy.page import SCHEME, in_readme, page, summary, table
from benchmarks.accuracy.scheme import leapfrog

ROOT = Path(__file__).resolve().parents[2]


def test_derivatives_are_those_of_the_angle() -> None:
    """Find α̇ and α̈ as differences of α and α̇, in the ramp and after it."""
    motion, step = drawn(0, Rig()).motion, 1e-5
    time = np.array([0.1, 0.5 * motion.ramp, motion.ramp + 0.2, 7.0])
    for order in (1, 2):
        lower = motion.evaluate if order == 1 else motion.derivative
        slope = (lower(time + step) - lower(time - step)) / (2.0 * step)
        # Third derivatives of up to 0.1 rad × (10/s)³ and those of the ramp, times step²/6; rounding 1e-16/step.
        np.testing.assert_allclose(motion.derivative(time, order), slope, rtol=0.0, atol=1e-7)


@pytest.mark.slow
def test_a_motion_depends_on_seed_and_number_alone() -> None:
    """Draw the same again, another for another number, and keep the ball where it may be."""
    one, again, other = drawn(3, Rig()), drawn(3, Rig()), drawn(4, Rig())
    assert one.motion == again.motion
    np.testing.assert_array_equal(one.position, again.position)
    assert one.motion != other.motion
    for each in (one, other):
        assert 0.1 * FARTHEST <= np.max(np.abs(each.position)) <= FARTHEST
        assert each.position[0] == each.start.position
        # The compiled kernel is another method in other code: 1 nm (README) on 3° at 2 Hz, here as much.
        position = simulate([CAM], Rig(), each.motion, each.start, each.time)[0].position
        np.testing.assert_allclose(position, each.position, rtol=0.0, atol=1e-8)


def test_the_scheme_is_of_second_order() -> None:
    """Lower the error of the leapfrog with the square of the step."""
    given, rig = drawn(1, Rig()), Rig()
    errors = [np.max(np.abs(leapfrog(given, rig, step) - given.position)) for step in (2e-3, 1e-3, 5e-4)]
    # Terms of fourth order add a share (ω dt)² = 4e-4 of the largest step.
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.02)


def told() -> dict[str, object]:
    """A summary with an engine that fails once."""
    errors = {
        ("mujoco", 1e-3): [4.0, None, 1.0],
        ("mujoco", 1e-4): [0.04, 0.02, 0.01],
        (SCHEME, 1e-3): [2.0, 1.0, 1.0],
        (SCHEME, 1e-4): [0.02, 0.01, 0.01],
    }
    return summary(errors, 2.0, 7, "0123456789ab")


def test_the_page_gives_largest_and_median_and_failures() -> None:
    """Count a failed run as such and leave it out of the figures."""
    text = page(told())
    assert "| MuJoCo | 0.001 s | 4 µm | 2.5 µm | 1 |" in text
    assert "| MuJoCo | 0.0001 s | 0.04 µm | 0.02 µm | 0 |" in text
    assert "| MuJoCo | 2.00 | 1.5 (1.2 … 1.8) | 1.5 |" in text


def test_page_and_readme_are_those_of_the_json() -> None:
    """Find in docs and README what the committed JSON says."""
    kept = json.loads((ROOT / "docs" / "accuracy.json").read_text(encoding="utf-8"))
    assert (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8") == page(kept)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert in_readme(kept, readme) == readme
    assert table(kept) in readme
    for row in kept["rows"]:
        values = [one for one in row["errors_um"] if one is not None]
        assert len(row["errors_um"]) == kept["motions"] >= 100
        assert row["failed"] == kept["motions"] - len(values)
        # Errors are kept with four digits.
        assert row["largest_um"] == pytest.approx(max(values), rel=1e-3)
        assert row["median_um"] == pytest.approx(np.median(values), rel=1e-3)
