"""Rests on the same count of an encoder are known as such, and their errors stay a Gauss–Markov process."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.signals.drive import Drive, make_drive
from harness.signals.rests import rests, with_repeats

STEP = 2.0 * math.pi / 4096.0
TIME = np.arange(0.0, 12.0, 0.01)


def between_stops(low: float, high: float) -> FloatArray:
    """A beam that goes to and fro between two angles in counts and rests for 1.5 s at each, shape (n,) [rad]."""
    share = np.clip((TIME % 4.0) / 0.5, 0.0, 1.0) - np.clip((TIME % 4.0 - 2.0) / 0.5, 0.0, 1.0)
    return STEP * (low + (high - low) * share**2 * (3.0 - 2.0 * share))


def drive(angle: FloatArray, noise: float = 0.0) -> Drive:
    """As an encoder of 4096 counts reads the angle."""
    generator = np.random.default_rng(1)
    read = np.round((angle + noise * generator.standard_normal(angle.size)) / STEP) * STEP
    return make_drive(TIME, read, resolution=STEP, noise=noise)


def test_rests_on_a_count_are_counted_over_all_recordings() -> None:
    """Count three rests at a stop in one recording and three in the next as six, and motion as none."""
    one, other = drive(between_stops(-34.2, 34.2)), drive(between_stops(-34.2, 50.3))
    known = with_repeats([one, other])
    repeats = [each.repeats for each in known]
    assert repeats[0] is not None
    assert repeats[1] is not None
    at_low, at_high, moving = (TIME % 4.0 > 2.9) & (TIME % 4.0 < 3.6), (TIME % 4.0 > 0.9) & (TIME % 4.0 < 1.6), 0.25
    assert set(repeats[0][at_low]) == {6.0}
    assert set(repeats[0][at_high]) == {3.0}
    assert set(repeats[1][at_high]) == {3.0}
    assert set(repeats[0][np.abs(TIME % 4.0 - moving) < 0.1]) == {1.0}


def test_noise_that_dithers_leaves_no_rest() -> None:
    """Know the angle of a beam that rests better than its count, where noise spreads the readings over several."""
    noisy = drive(between_stops(-34.2, 34.2), noise=STEP)
    assert not list(rests(noisy))
    assert with_repeats([noisy])[0] is noisy
    assert noisy.shared_error is noisy.error


@pytest.mark.parametrize("first", [0, 300])
def test_an_inflated_error_is_a_process_still(first: int) -> None:
    """Go on from stamp to stamp as its covariances say: P₊ = A P Aᵀ + B Bᵀ."""
    (known,) = with_repeats([drive(between_stops(-34.2, 34.2))])
    assert known.repeats is not None
    error = known.shared_error.between(first, len(TIME))
    assert np.allclose(error.covariance[:, 0, 0], (known.repeats * known.error.covariance[:, 0, 0])[first:])
    carried = error.transition @ error.covariance[:-1] @ error.transition.transpose(0, 2, 1)
    carried = carried + error.root @ error.root.transpose(0, 2, 1)
    scale = np.sqrt(np.einsum("kii->ki", error.covariance[1:]))
    scaled = (carried - error.covariance[1:]) / (scale[:, :, None] * scale[:, None, :])
    # The smoother's own covariances obey this to the rounding of its subtractions; inflating adds none.
    plain = known.error.between(first, len(TIME))
    before = plain.transition @ plain.covariance[:-1] @ plain.transition.transpose(0, 2, 1)
    before = before + plain.root @ plain.root.transpose(0, 2, 1)
    least = np.sqrt(np.einsum("kii->ki", plain.covariance[1:]))
    unscaled = (before - plain.covariance[1:]) / (least[:, :, None] * least[:, None, :])
    assert np.abs(scaled).max() < np.abs(unscaled).max() + 1e-9
