"""What an encoder rounds alike is known as such: rests on a count, visits to a limit; its error stays a process."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.signals.drive import Drive, make_drive
from harness.signals.rests import limits, rests, with_shared_rounding

STEP = 2.0 * math.pi / 4096.0
TIME = np.arange(0.0, 12.0, 0.01)


def between_stops(low: float, high: float) -> FloatArray:
    """A beam that goes to and fro between two angles in counts and rests for 1.5 s at each, shape (n,) [rad]."""
    share = np.clip((TIME % 4.0) / 0.5, 0.0, 1.0) - np.clip((TIME % 4.0 - 2.0) / 0.5, 0.0, 1.0)
    return STEP * (low + (high - low) * share**2 * (3.0 - 2.0 * share))


def drive(angle: FloatArray, noise: float | None = 0.0) -> Drive:
    """As an encoder of 4096 counts reads the angle; without noise, but with one to be estimated, for `None`."""
    generator = np.random.default_rng(1)
    read = np.round((angle + (noise or 0.0) * generator.standard_normal(angle.size)) / STEP) * STEP
    return make_drive(TIME, read, resolution=STEP, noise=noise)


def test_rests_on_a_count_are_counted_over_all_recordings() -> None:
    """Count three rests at a stop in one recording and three in the next as six, and motion as none."""
    one, other = drive(between_stops(-34.2, 34.2)), drive(between_stops(-34.2, 50.3))
    known = with_shared_rounding([one, other])
    often = [each.inflation for each in known]
    assert often[0] is not None
    assert often[1] is not None
    at_low, at_high, moving = (TIME % 4.0 > 2.9) & (TIME % 4.0 < 3.6), (TIME % 4.0 > 0.9) & (TIME % 4.0 < 1.6), 0.25
    assert np.allclose(often[0][at_low], 6.0)
    assert np.allclose(often[0][at_high], 3.0)
    assert np.allclose(often[1][at_high], 3.0)
    assert np.allclose(often[0][np.abs(TIME % 4.0 - moving) < 0.1], 1.0)


def held_command(limit: float) -> FloatArray:
    """A command of many sines that a controller gives every 0.02 s and cuts off at ± a limit in counts, [rad]."""
    begin = np.floor(TIME / 0.02 + 1e-9) * 0.02
    waves = (30.0, 2.3, 0.4), (25.0, 5.1, 1.9), (20.0, 9.7, 3.0)
    asked = sum((size * np.sin(rate * begin + phase) for size, rate, phase in waves), np.zeros_like(begin))
    return STEP * np.clip(asked, -limit, limit)


def test_visits_to_a_limit_of_the_command_count_however_short() -> None:
    """Give each of the short visits to ± 34.3 counts the variance of a rounding that is the same in all of them."""
    commanded = drive(held_command(34.3), noise=None)
    assert limits([commanded]) == {(34.0, STEP), (-34.0, STEP)}
    (known,) = with_shared_rounding([commanded])
    assert known.inflation is not None
    at_limit = np.abs(np.rint(known.reading / STEP)) == 34.0
    visits = int(np.sum(np.diff(at_limit.astype(int), prepend=0) == 1))
    assert visits > 10
    variance = known.inflation * known.std[:, 0] ** 2
    assert variance[at_limit].min() >= (1.0 - 1e-9) * visits * STEP**2 / 12.0
    assert np.all(known.inflation[~at_limit] < visits)


def test_the_error_at_a_limit_is_stated_as_large_as_its_rounding() -> None:
    """Keep the angle of a limited command within two stated deviations; without sharing it is off by four to six."""
    for limit in (33.6, 34.0, 34.45):
        (known,) = with_shared_rounding([drive(held_command(limit), noise=None)])
        at_limit = np.abs(np.rint(known.reading / STEP)) == 34.0
        off = np.abs(known.states[at_limit, 0] - held_command(limit)[at_limit])
        error = np.sqrt(known.shared_error.covariance[at_limit, 0, 0])
        assert np.all(off < 2.0 * error)


def test_turns_of_a_sine_are_no_limit() -> None:
    """Take no angle for cut off that turns smoothly, wherever within a count it does."""
    for top in (33.55, 34.0, 34.49):
        assert not limits([drive(top * STEP * np.sin(2.0 * TIME))])


def test_noise_that_dithers_leaves_no_rest() -> None:
    """Know the angle of a beam that rests better than its count, where noise spreads the readings over several."""
    noisy = drive(between_stops(-34.2, 34.2), noise=STEP)
    assert not list(rests(noisy))
    assert with_shared_rounding([noisy])[0] is noisy
    assert noisy.shared_error is noisy.error


@pytest.mark.parametrize("first", [0, 300])
def test_an_inflated_error_is_a_process_still(first: int) -> None:
    """Go on from stamp to stamp as its covariances say: P₊ = A P Aᵀ + B Bᵀ."""
    (known,) = with_shared_rounding([drive(between_stops(-34.2, 34.2))])
    assert known.inflation is not None
    error = known.shared_error.between(first, len(TIME))
    assert np.allclose(error.covariance[:, 0, 0], (known.inflation * known.error.covariance[:, 0, 0])[first:])
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
