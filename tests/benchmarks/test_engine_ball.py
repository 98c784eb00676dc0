"""The same experiments with the ball of an engine: another contact, the same truth."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.calibration.engine_ball import engine_mover
from harness.errors import InputError
from harness.simulator import Experiment
from tests.simulator.acting import EACH, EACH_UNLISTED

# What a force along the beam stands for exactly is left with the errors of engine and plant: below 1 µm each in 6 s at
# 0.5 ms. A force that varies along the way is seen by the leapfrog to (ω dt)²/24; the steepest, bump and imbalance,
# change within 4 mm, ω = 50/s at 0.2 m/s. Where the ball stops, an engine meets the instant to a step: 2 c g K dt per
# stop, 3e-8 m/s of which the mean over the step leaves the part due to the changing pull.
SMOOTH, STEEP, DRY = 1e-6, 3e-5, 1e-4
TOLERANCE = {
    "viscous_damping": SMOOTH,
    "level_error": SMOOTH,
    "rolling_radius": SMOOTH,
    "linkage_backlash": SMOOTH,
    "track_curvature": SMOOTH,
    "beam_compliance": SMOOTH,
    "cubic_drag": SMOOTH,
    "track_bump": STEEP,
    "ball_imbalance": STEEP,
    "rolling_resistance": DRY,
    "directional_resistance": DRY,
    "presliding_hysteresis": DRY,
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "engine"),
    [
        *((name, "mujoco") for name in TOLERANCE),
        *((name, "pybullet") for name in ("viscous_damping", "track_bump", "directional_resistance")),
    ],
)
def test_engine_ball_moves_as_the_plants_own(name: str, engine: str) -> None:
    """Follow the plant's ball over 6 s of a closed-loop recording, stops included."""
    listed = name in EACH
    values = {name: (EACH if listed else EACH_UNLISTED)[name]}
    experiment = Experiment(seed=3, identify=1, predict=0, duration=6.0, **{"hidden" if listed else "unlisted": values})
    own, other = experiment.recordings()[0], experiment.recordings(engine_mover(engine))[0]
    np.testing.assert_array_equal(own.record.angle, other.record.angle)
    assert np.max(np.abs(own.position - other.position)) < TOLERANCE[name]
    # the same noise on nearly the same position: one step of the resolution at most
    assert np.max(np.abs(own.record.position - other.record.position)) < 1.01e-4 + TOLERANCE[name]


def test_engine_ball_is_held_at_rest() -> None:
    """Keep a ball at rest under rolling resistance for as long as the beam stays within atan(c)."""
    experiment = Experiment(
        seed=3, identify=1, predict=0, duration=4.0, hidden={"rolling_resistance": {"coefficient": 0.2}}, start=0.3
    )
    one = experiment.recordings(engine_mover("mujoco"))[0]
    assert np.ptp(one.angle) > 0.005
    # The pull is seen a step late. At each of the servo's 400 jumps of α̈, 4 rad/s² at most, the ball so moves by
    # K (h + r + …) 4 rad/s² dt² = 33 nm before it is held again, this way or that: √400 · 33 nm.
    assert np.max(np.abs(one.position - 0.3)) < 7e-7


def test_sliding_ball_is_not_given_to_an_engine() -> None:
    """Refuse what a force along the beam cannot stand for."""
    experiment = Experiment(seed=3, identify=1, predict=0, duration=2.0, hidden={"contact_slip": EACH["contact_slip"]})
    with pytest.raises(InputError, match="slides"):
        experiment.recordings(engine_mover("mujoco"))


def test_unknown_engine_is_refused() -> None:
    """Name the engines there are."""
    with pytest.raises(InputError, match="mujoco, pybullet"):
        engine_mover("havok")
