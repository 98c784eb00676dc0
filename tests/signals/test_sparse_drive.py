"""A drive at some of its stamps is the same motion with the same error there."""

from __future__ import annotations

import numpy as np
import pytest

from harness.signals.drive import SmoothedDrive, make_drive
from harness.signals.error_process import ErrorProcess
from harness.signals.held_drive import held_drive
from harness.signals.sparse_drive import SparseDrive, sparse

COUNT, EVERY = 2e-4, 7  # [rad], [1]


@pytest.fixture(scope="module")
def whole() -> SmoothedDrive:
    """A beam that swings by 4° at 0.4 Hz, read in counts at 500 Hz."""
    time = np.arange(2000) / 500
    angle = 0.07 * np.sin(2 * np.pi * 0.4 * time)
    return make_drive(time, np.rint(angle / COUNT) * COUNT, resolution=COUNT)


def test_the_motion_between_stamps_is_that_of_all(whole: SmoothedDrive) -> None:
    """Between its own stamps too, the angle is within a hundredth of its stated error."""
    drive = sparse(whole, EVERY)
    time = whole.time[whole.time <= drive.time[-1]]
    assert np.max(np.abs(drive.evaluate(time) - whole.evaluate(time))) < 0.01 * np.min(whole.std[:, 0])
    np.testing.assert_array_equal(drive.states, whole.states[::EVERY])


def test_the_error_is_that_of_the_stamps(whole: SmoothedDrive) -> None:
    """Its covariance is the stated one, and goes on from stamp to stamp: P₊ = A P Aᵀ + B Bᵀ."""
    error = sparse(whole, EVERY).error
    np.testing.assert_allclose(error.covariance, whole.error.covariance[::EVERY], rtol=1e-12)
    # The steps of the whole drive miss it by what rounding leaves; seven of them by seven times that at the most.
    assert missed(error) < EVERY * missed(whole.error) < 1e-3


def missed(error: ErrorProcess) -> float:
    """The largest difference of P₊ from A P Aᵀ + B Bᵀ, over the deviations of its row and column [1]."""
    A, B, P = error.transition, error.root, error.covariance
    on = A @ P[:-1] @ A.transpose(0, 2, 1) + B @ B.transpose(0, 2, 1)
    deviation = np.sqrt(np.diagonal(P[1:], axis1=1, axis2=2))
    return float(np.max(np.abs(on - P[1:]) / (deviation[:, :, None] * deviation[:, None, :])))


def test_what_is_drawn_scatters_by_the_error(whole: SmoothedDrive) -> None:
    """400 draws have the stated deviation of the angle at a stamp, within four standard errors of 3.5 %."""
    drive = sparse(whole, EVERY)
    drawn = np.array([path.states[100, 0] for path in drive.draw(400, seed=0)])
    assert np.std(drawn - drive.states[100, 0]) == pytest.approx(drive.std[100, 0], rel=0.14)


def test_smoothing_anew_uses_all_readings(whole: SmoothedDrive) -> None:
    """A rougher motion is that of the whole drive, at the same stamps."""
    rougher = sparse(whole, EVERY).rougher(10.0)
    assert isinstance(rougher, SparseDrive)
    np.testing.assert_array_equal(rougher.states, whole.rougher(10.0).states[::EVERY])


def test_a_drive_that_keeps_its_stamps_is_the_same(whole: SmoothedDrive) -> None:
    """At every stamp, and for a command that jumps at each of its stamps."""
    command = held_drive(whole)
    assert sparse(whole, 1) is whole
    assert sparse(command, EVERY) is command
