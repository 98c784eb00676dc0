"""The error of a beam's angle behind a lag: as drawn paths scatter that a solver of the test's own takes through it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from analytic.effects import ANGLE_HOLD, ANGLE_LAG, ANGLE_SERVO, Follower
from analytic.motion import FloatArray
from harness.signals.drive import Drive, make_drive
from harness.signals.error_process import ErrorProcess
from harness.signals.follower_error import behind_follower

STEP = 2.0 * np.pi / 4096
DRAWS, FINE = 600, 20  # paths, and instants from one stamp to the next at which they are solved
TIME = np.arange(0.0, 5.0, 0.01)
# To and fro, then at rest, so that the error of rounding changes quickly and then stays.
ANGLE = 0.06 * np.sin(2.0 * np.pi * 0.6 * np.minimum(TIME, 3.3))
LATER = TIME > 1.5  # the solver begins with the beam at rest: after seven lags nothing is left of that


@pytest.fixture(scope="module")
def drive() -> Drive:
    """The angle as a coarse encoder shows it."""
    return make_drive(TIME, np.rint(ANGLE / STEP) * STEP, resolution=STEP, noise=0.0)


@pytest.fixture(scope="module")
def errors(drive: Drive) -> FloatArray:
    """Errors of the measured angle at `FINE` instants a stamp, shape (instants, draws) [rad]."""
    fine = np.linspace(TIME[0], TIME[-1], FINE * (len(TIME) - 1) + 1)
    return np.array([path.evaluate(fine) - drive.evaluate(fine) for path in drive.draw(DRAWS, seed=1)]).T


def followed(errors: FloatArray, transfer: list[float]) -> FloatArray:
    """Those of a beam behind 1/(transfer₀ p² + transfer₁ p + 1), at the stamps, shape (n, draws) [rad]."""
    step = (TIME[1] - TIME[0]) / FINE
    denominator = transfer if transfer[0] else transfer[1:]
    over, under, _ = cont2discrete(([1.0], [*denominator, 1.0]), step, method="foh")
    return lfilter(np.ravel(over), under, errors, axis=0)[::FINE]


def lag_one(error: ErrorProcess) -> FloatArray:
    """Covariance of e with that at the stamp before, shape (n − 1,) [rad²]."""
    return (error.transition @ error.covariance[:-1])[:, 0, 0]


@pytest.mark.parametrize(
    ("follower", "transfer"),
    [
        (ANGLE_SERVO.follower({"lag": 0.15, "damping": 0.7}), [(0.075 / 0.7) ** 2, 0.15]),
        (ANGLE_SERVO.follower({"lag": 0.03, "damping": 2.0}), [(0.015 / 2.0) ** 2, 0.03]),
        (ANGLE_LAG.follower({"time_constant": 0.1}), [0.0, 0.1]),
    ],
)
def test_a_beam_behind_a_lag_is_known_as_well_as_followers_scatter(
    drive: Drive, errors: FloatArray, follower: Follower, transfer: list[float]
) -> None:
    """State their deviation, and the covariance from stamp to stamp, both smaller than those of the measured angle."""
    stated, scatter = behind_follower(drive.error, TIME, follower), followed(errors, transfer)
    deviation = np.sqrt(stated.covariance[LATER, 0, 0])
    found = np.sqrt(np.mean(scatter[LATER] ** 2, axis=1))
    # A deviation from 600 draws is off by 1/√1200, 2.9 %; neighbours share it, some tens of 350 do not: 4.5 times that.
    np.testing.assert_allclose(found, deviation, rtol=0.13)
    both = np.mean(scatter[1:] * scatter[:-1], axis=1)
    np.testing.assert_allclose(both[LATER[1:]], lag_one(stated)[LATER[1:]], rtol=0.26)
    moving = LATER & (TIME < 3.2)
    assert np.mean(stated.covariance[moving, 0, 0]) < 0.95 * np.mean(drive.error.covariance[moving, 0, 0])


@pytest.mark.parametrize("apart", [5, 20, 30])
def test_what_is_known_of_a_beam_behind_a_servo_lasts_as_long_as_followers_show(
    drive: Drive, errors: FloatArray, apart: int
) -> None:
    """State the covariance of errors 50 to 300 ms apart, which rests on the measured angle's error in between."""
    stated = behind_follower(drive.error, TIME, ANGLE_SERVO.follower({"lag": 0.06, "damping": 0.7}))
    scatter = followed(errors, [(0.03 / 0.7) ** 2, 0.06])
    moving = np.flatnonzero(LATER & (TIME < 3.2))[:-apart]
    carried = stated.covariance[moving]
    for k in range(apart):
        carried = stated.transition[moving + k] @ carried
    found = np.mean(scatter[moving + apart] * scatter[moving], axis=1)
    scale = np.mean(stated.covariance[moving, 0, 0])
    # Each of 150 products of 600 draws is known to 4 %, neighbours together. A process of (b, ḃ, b̈) alone, with the
    # same covariances from stamp to stamp, is off by a third of the variance at 200 ms and by two thirds at 300 ms.
    assert np.mean(carried[:, 0, 0]) / scale == pytest.approx(np.mean(found) / scale, abs=0.04)


def test_a_held_angle_is_known_as_well_as_means_scatter(drive: Drive, errors: FloatArray) -> None:
    """State the deviation of a mean over 50 ms by the lag that has its first two moments."""
    count = 5 * FINE
    sums = np.cumsum(np.vstack((np.zeros(DRAWS), errors)), axis=0)
    means = ((sums[count:] - sums[:-count]) / count)[FINE - 1 :: FINE]  # up to the stamps from the fifth on
    stated = behind_follower(drive.error, TIME, ANGLE_HOLD.follower({"interval": 0.05}))
    use = LATER[-len(means) :]
    deviation = np.sqrt(stated.covariance[-len(means) :, 0, 0])[use]
    found = np.sqrt(np.mean(means[use] ** 2, axis=1))
    assert np.sqrt(np.mean(found**2)) == pytest.approx(np.sqrt(np.mean(deviation**2)), rel=0.05)


@pytest.mark.parametrize("follower", [Follower(0.15, 0.01), Follower(1.0, 0.0625), Follower(1e-4, 4e-9)])
def test_each_step_leads_to_the_stated_covariance(drive: Drive, follower: Follower) -> None:
    """Go on from stamp to stamp by A P Aᵀ + B Bᵀ, behind slow and quick followers."""
    covariance, A, B = behind_follower(drive.error, TIME, follower)
    after = A @ covariance[:-1] @ A.transpose(0, 2, 1) + B @ B.transpose(0, 2, 1)
    deviation = np.sqrt(np.einsum("kii->ki", covariance[1:]))
    scale = deviation[:, :, None] * deviation[:, None, :]
    # What the state before tells is left out where it is less than 1e-8 of a number, the rest is rounding.
    assert np.max(np.abs(after - covariance[1:]) / np.where(scale > 0.0, scale, np.inf)) < 1e-6


def test_a_lag_of_nothing_leaves_the_error_as_it_is(drive: Drive) -> None:
    """State the measured angle's own error behind a lag of 10 µs, at whatever stamps."""
    uneven = TIME + np.where(np.arange(len(TIME)) % 2, 0.002, 0.0)
    jittered = make_drive(uneven, drive.reading, resolution=STEP, noise=0.0)
    for each in (drive, jittered):
        made = behind_follower(each.error, each.time, Follower(1e-5))
        # At most 0.25 rad/s² of error times 10 µs is 0.1 % of the smallest deviation of 50 µrad, twice that its
        # variance; from step to step, the process itself comes within 1.1 % of the covariances that it states.
        np.testing.assert_allclose(made.covariance[:, 0, 0], each.error.covariance[:, 0, 0], rtol=1.3e-2)
        np.testing.assert_allclose(lag_one(made), lag_one(each.error), rtol=1.3e-2)


def test_an_angle_that_is_known_exactly_moves_a_beam_that_is(drive: Drive) -> None:
    """Pass on no error as none."""
    n = len(TIME)
    known = ErrorProcess(np.zeros((n, 3, 3)), drive.error.transition, np.zeros((n - 1, 3, 3)))
    made = behind_follower(known, TIME, Follower(0.1, 0.004))
    assert all(np.isfinite(part).all() for part in made)
    assert not made.covariance.any()
    assert not made.root.any()
