"""A ball that something holds at first looks like one that friction holds, and is said to."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.effects import ROLLING_RESISTANCE, STRIBECK_FRICTION
from harness.identify.held_at_first import may_be_held
from harness.identify.pose import problem_of
from harness.identify.verdict import Estimate
from harness.recording import load_case
from tests.recording.released import Release, released

AT_REST = {"static_coefficient": Estimate(4e-3, 2e-3, 6e-3, ""), "kinetic_coefficient": Estimate(0.0, 0.0, 1e-4, "")}
LEVEL = 5e-3  # by which a free ball would leave its place [rad]


HELD = Release(begin=0.3, finger=True, wait=0.4, level=LEVEL)
FREE = Release(begin=0.3, lean=-0.2, tilt=0.2, wait=0.0)  # 17 mm away after 0.15 s


def told(folder: Path, run: Release) -> bool:
    """Whether a friction at rest alone is said to be a held ball in two such runs."""
    problem = problem_of(load_case(released(folder, [run, run], rate=100)))
    return may_be_held(problem, STRIBECK_FRICTION.name, AT_REST)


def test_a_friction_at_rest_alone_may_be_a_finger(tmp_path: Path) -> None:
    """Say so where the recordings begin with a ball at rest, and not where it moves from the first."""
    assert told(tmp_path / "held", HELD)
    assert not told(tmp_path / "free", FREE)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        (ROLLING_RESISTANCE.name, {"coefficient": Estimate(4e-3, 2e-3, 6e-3, "")}),
        (STRIBECK_FRICTION.name, AT_REST | {"kinetic_coefficient": Estimate(2e-3, 1e-3, 3e-3, "")}),
    ],
    ids=["rolling", "in motion too"],
)
def test_a_friction_that_slows_a_rolling_ball_is_no_finger(
    tmp_path: Path, name: str, parameters: dict[str, Estimate]
) -> None:
    """Say nothing of a friction in motion, which nothing that holds the ball at first explains."""
    problem = problem_of(load_case(released(tmp_path, [HELD], rate=100)))
    assert not may_be_held(problem, name, parameters)
