"""Roots of covariances whose numbers depend on each other nearly, or wholly, linearly."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import ANGLE_HOLD, ANGLE_LAG, ANGLE_SERVO
from analytic.motion import FloatArray
from harness.signals.drive import make_drive
from harness.signals.follower_error import behind_follower
from harness.signals.triangular_roots import root_of

ROUNDING = 1e-12  # of a correlation; each of the sums of ten terms and of the ten steps leaves some 1e-15


def wrong_by(covariance: FloatArray) -> float:
    """Largest error of L Lᵀ, over both standard deviations; raises where L is not triangular."""
    L = np.zeros_like(covariance)
    root_of(covariance, L, 0)
    np.testing.assert_array_equal(L, np.tril(L))
    deviations = np.sqrt(np.diag(covariance))
    scale = np.outer(deviations, deviations)
    return float(np.max(np.abs(L @ L.T - covariance) / np.where(scale > 0.0, scale, 1.0)))


def test_the_root_of_an_angle_behind_servo_hold_and_lag_is_one_at_every_stamp() -> None:
    """Give each covariance back: a forecast may begin at any stamp."""
    time = np.arange(0.0, 8.0, 0.01)
    step = 2.0 * np.pi / 4096
    angle = 0.05 * np.sin(2.0 * np.pi * 0.4 * time) + 0.02 * np.sin(2.0 * np.pi * 1.1 * time)
    error = make_drive(time, np.rint(angle / step) * step, resolution=step, noise=0.0).error
    for follower in (
        ANGLE_SERVO.follower({"lag": 0.12398, "damping": 0.76786}),
        ANGLE_HOLD.follower({"interval": 0.19442}),
        ANGLE_LAG.follower({"time_constant": 0.0247}),
    ):
        error = behind_follower(error, time, follower)
    assert error.covariance.shape[1:] == (9, 9)
    assert max(wrong_by(one) for one in error.covariance) < ROUNDING


@pytest.mark.parametrize("rank", [0, 1, 4, 9])
def test_the_root_of_a_covariance_of_any_rank_is_one(rank: int) -> None:
    """Give it back where numbers depend on each other wholly, and where one is known exactly."""
    generator = np.random.default_rng(rank)
    for _ in range(50):
        factor = generator.normal(size=(9, rank)) * 10.0 ** generator.uniform(-8.0, 2.0, (9, 1))
        factor[3] = 0.0
        assert wrong_by(factor @ factor.T) < ROUNDING


@pytest.mark.parametrize("other", [5.0, 1.0 + 1e-14])
def test_the_rest_of_the_matrix_stays(other: float) -> None:
    """Write the root below and on the diagonal from the given row and column on, and nothing else."""
    L = np.full((4, 4), 7.0)
    root_of(np.array([[4.0, 2.0], [2.0, other]]), L, 2)
    root = np.array([[2.0, 0.0], [1.0, np.sqrt(other - 1.0)]])
    np.testing.assert_allclose(np.tril(L[2:, 2:]), root, rtol=ROUNDING, atol=1e-6)
    L[2:, 2:] += np.tril(7.0 - L[2:, 2:])
    np.testing.assert_array_equal(L, 7.0)
