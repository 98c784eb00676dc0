"""The error of a smoothed angle as a process: its covariances are those of the posterior."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from harness.signals import smooth
from harness.signals.drive import make_drive
from harness.signals.error_process import error_process
from tests.signals.dense_posterior import posterior_covariance
from tests.signals.test_spline_smoother import record


def test_the_process_has_the_covariances_of_the_posterior() -> None:
    """Go on from stamp to stamp with the covariances of a dense solve, over missing readings and uneven steps."""
    time, value, variance, density = record()
    dense = posterior_covariance(time, variance, density)
    found = error_process(smooth(time, value, variance, density), variance)
    deviation = np.sqrt(np.array([np.diag(dense[k, :, k]) for k in range(len(time))]))
    # The smoother itself is held to 1e-4 of the product of the standard deviations (`test_spline_smoother`).
    for k in range(len(time) - 1):
        A, B, P = found.transition[k], found.root[k], dense[k, :, k]
        scale = np.outer(deviation[k + 1], deviation[k])
        np.testing.assert_array_less(np.abs(A @ P - dense[k + 1, :, k]), 1e-4 * scale)
        after = A @ P @ A.T + B @ B.T
        np.testing.assert_array_less(
            np.abs(after - dense[k + 1, :, k + 1]), 1e-4 * np.outer(deviation[k + 1], deviation[k + 1])
        )


def test_an_angle_at_rest_keeps_its_error_and_one_that_moves_forgets_it() -> None:
    """Carry the error of a beam at rest on through a second, and lose that of a moving one within 0.3 s."""
    time = np.arange(0.0, 8.0, 0.01)
    step = 2.0 * np.pi / 4096
    moving = time > 4.0
    angle = np.where(moving, 0.05 * (1.0 - np.cos(2.0 * np.pi * 0.5 * (time - 4.0))), 0.3 * step)
    drive = make_drive(time, np.rint(angle / step) * step, resolution=step, noise=0.0)
    error = drive.error

    def correlation(first: int, last: int) -> float:
        carried = error.covariance[first]
        for k in range(first, last):
            carried = error.transition[k] @ carried
        return float(carried[0, 0] / np.sqrt(error.covariance[first][0, 0] * error.covariance[last][0, 0]))

    assert correlation(100, 200) > 0.8
    # At 0.1 rad/s a count of 1.5 mrad lasts 15 ms: after 0.3 s twenty counts lie between.
    assert abs(correlation(475, 505)) < 0.3


def test_drawn_paths_scatter_as_the_process_does() -> None:
    """Agree in variance and correlation with paths drawn from the posterior by an independent method."""
    time = np.arange(0.0, 3.0, 0.02)
    step = 2.0 * np.pi / 4096
    drive = make_drive(time, np.rint(0.05 * np.sin(2.0 * time) / step) * step, resolution=step, noise=0.0)
    count, first, last = 800, 60, 64
    drawn = np.array([path.states[:, 0] - drive.states[:, 0] for path in drive.draw(count, seed=1)])
    carried = drive.error.covariance[first]
    for k in range(first, last):
        carried = drive.error.transition[k] @ carried
    expected = carried[0, 0]
    spread = np.sqrt(drive.error.covariance[first][0, 0] * drive.error.covariance[last][0, 0])
    # A sample covariance of n draws scatters by at most √(2/n) of the product of the deviations; four of these.
    assert np.mean(drawn[:, first] * drawn[:, last]) == pytest.approx(expected, abs=4.0 * np.sqrt(2.0 / count) * spread)


def test_a_gain_scales_the_error_and_a_part_keeps_its_stamps() -> None:
    """Multiply deviations by the gain, and cut covariances and steps at the same stamps."""
    time, value, variance, density = record()
    found = error_process(smooth(time, value, variance, density), variance)
    larger, part = found.scaled(-3.0), found.between(2, 9)
    np.testing.assert_allclose(larger.covariance, 9.0 * found.covariance)
    np.testing.assert_allclose(larger.root, 3.0 * found.root)
    np.testing.assert_array_equal(larger.transition, found.transition)
    np.testing.assert_array_equal(part.covariance, found.covariance[2:9])
    np.testing.assert_array_equal(part.transition, found.transition[2:8])
    np.testing.assert_array_equal(part.root, found.root[2:8])


def test_the_process_at_some_stamps_is_that_of_all() -> None:
    """Go from one kept stamp to the next with the covariances that the steps between them add up to."""
    time, value, variance, density = record()
    found = error_process(smooth(time, value, variance, density), variance)
    kept = np.array([0, 1, 4, 9])
    few = found.at(kept)
    for k, (first, last) in enumerate(pairwise(kept)):
        A, Q = np.eye(3), np.zeros((3, 3))
        for j in range(first, last):
            step = found.transition[j]
            A, Q = step @ A, step @ Q @ step.T + found.root[j] @ found.root[j].T
        np.testing.assert_allclose(few.transition[k], A, rtol=1e-12)
        scale = np.sqrt(np.diag(Q))
        np.testing.assert_array_less(np.abs(few.root[k] @ few.root[k].T - Q), 1e-12 * np.outer(scale, scale))
    np.testing.assert_array_equal(few.covariance, found.covariance[kept])


def test_an_angle_known_exactly_has_no_negative_variance() -> None:
    """Keep variances at or above zero where those of the smoother are rounding alone."""
    time = np.arange(0.0, 8.0, 0.05)
    drive = make_drive(time, np.where(np.sin(time) > 0.0, 0.2, -0.3), noise=1e-8)
    assert np.all(np.diagonal(drive.error.covariance, axis1=1, axis2=2) >= 0.0)
