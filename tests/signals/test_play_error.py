"""The error of a beam's angle behind a play: as drawn paths through a play of the test's own scatter."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.signals.drive import Drive, make_drive
from harness.signals.error_process import ErrorProcess
from harness.signals.play_error import behind_play

STEP = 2.0 * np.pi / 4096
WIDTH, DRAWS = 0.01, 1500
TIME = np.arange(0.0, 5.0, 0.01)
# Rests 0.5 s, goes to and fro: the beam is met at +5 mrad for the first time, and from both sides within 2 s.
ANGLE = np.where(TIME > 0.5, 0.03 * np.sin(2.0 * np.pi * 0.5 * (TIME - 0.5)), 0.0)


def through_play(angle: FloatArray, begin: float) -> FloatArray:
    """The beam behind each angle, shape (n,) [rad], which begins `begin` above the first one [rad]."""
    beam = np.empty_like(angle)
    at = angle[0] + begin
    for k, here in enumerate(angle):
        at = min(max(at, here - 0.5 * WIDTH), here + 0.5 * WIDTH)
        beam[k] = at
    return beam


@pytest.fixture(scope="module")
def drive() -> Drive:
    """The angle as a coarse encoder shows it."""
    return make_drive(TIME, np.rint(ANGLE / STEP) * STEP, resolution=STEP, noise=0.0)


@pytest.fixture(scope="module")
def drawn(drive: Drive) -> FloatArray:
    """Errors of beams that begin anywhere in the gap, against one that begins in its middle, shape (draws, n) [rad]."""
    begins = np.random.default_rng(3).uniform(-0.5, 0.5, DRAWS) * WIDTH
    assumed = through_play(drive.states[:, 0], 0.0)
    paths = [path.states[:, 0] for path in drive.draw(DRAWS, seed=1)]
    return np.array([through_play(path, begin) for path, begin in zip(paths, begins, strict=True)]) - assumed


@pytest.fixture(scope="module")
def error(drive: Drive) -> ErrorProcess:
    """What is stated of the same."""
    return behind_play(drive.error, drive, TIME, WIDTH, 0.0)


def carried(error: ErrorProcess, first: int, last: int) -> FloatArray:
    """Covariance of the state at `last` with that at `first`, shape (3, 3)."""
    covariance = error.covariance[first]
    for k in range(first, last):
        covariance = error.transition[k] @ covariance
    return covariance


def test_the_beam_is_known_as_well_as_drawn_ones_scatter(drive: Drive, error: ErrorProcess, drawn: FloatArray) -> None:
    """State their variance where nothing has met the beam, where it stands, and where the linkage moves it."""
    stated, found = np.sqrt(error.covariance[:, 0, 0]), np.sqrt(np.mean(drawn**2, axis=0))
    # At first the gap over √12 beside the angle's; a deviation from 1500 draws is off by at most 4/√3000, 7 %.
    at_first = np.hypot(WIDTH / np.sqrt(12.0), np.sqrt(drive.error.covariance[0, 0, 0]))
    np.testing.assert_allclose(stated[:30], at_first, rtol=1e-3)  # 32 places in the gap: 1/(2 · 32²)
    np.testing.assert_allclose(found[:30], stated[:30], rtol=0.07)
    # Later, an error of the turn is of the path at its highest, which the smoothed angle reaches within a stamp.
    later = TIME > 2.2
    assert stated[later].max() < 0.1 * stated[0]
    np.testing.assert_allclose(np.mean(stated[later] ** 2), np.mean(found[later] ** 2), rtol=0.25)


def test_a_beam_that_stands_keeps_its_error(error: ErrorProcess, drawn: FloatArray) -> None:
    """Carry the error on through the gap unchanged, as drawn beams do, and lose it once the linkage has met them."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(ANGLE))) != 0)
    turn = int(turns[TIME[turns] > 2.2][0])
    stand = range(turn + 3, turn + 12)  # the gap of 10 mrad takes 0.26 s of a cosine of 30 mrad and 2 s
    assert all(np.ptp(drawn[:, k] - drawn[:, k - 1]) == 0.0 for k in stand[1:])
    first, last = stand[0], stand[-1]
    assert carried(error, first, last)[0, 0] == pytest.approx(error.covariance[first, 0, 0], rel=1e-9)
    behind = turn + 60
    correlation = carried(error, first, behind)[0, 0] / np.sqrt(
        error.covariance[first, 0, 0] * error.covariance[behind, 0, 0]
    )
    # 1/√1500 is what a correlation of 0 shows; 0.2 is five of these and what is left after a third of a second.
    assert abs(correlation) < 0.2
    assert abs(np.corrcoef(drawn[:, first], drawn[:, behind])[0, 1]) < 0.2


def test_each_step_leads_to_the_stated_covariance(drive: Drive, error: ErrorProcess) -> None:
    """Go on from stamp to stamp by A P Aᵀ + B Bᵀ through stands and meetings, as exactly as the angle's own process."""

    def mismatch(process: ErrorProcess) -> float:
        covariance, A, B = process
        after = A @ covariance[:-1] @ A.transpose(0, 2, 1) + B @ B.transpose(0, 2, 1)
        deviation = np.sqrt(np.einsum("kii->ki", covariance[1:]))
        scale = deviation[:, :, None] * deviation[:, None, :]
        return float(np.max(np.abs(after - covariance[1:]) / np.where(scale > 0.0, scale, np.inf)))

    assert mismatch(error) <= mismatch(drive.error)


def test_a_play_of_no_width_leaves_the_error_as_it_is(drive: Drive) -> None:
    """Forecast a moving beam's error behind a play of 1 nrad as without one, but where it turns."""
    error = behind_play(drive.error, drive, TIME, 1e-9, 0.0)
    moving = slice(60, 90)
    np.testing.assert_allclose(error.covariance[moving, 0, 0], drive.error.covariance[moving, 0, 0], rtol=1e-9)
    np.testing.assert_allclose(error.transition[moving], drive.error.transition[moving], rtol=1e-9, atol=1e-12)


def test_an_error_that_nothing_renews_is_met_again_without_noise(drive: Drive) -> None:
    """Keep roots real where the error at the turn tells all of the later one, and rounding less than nothing."""
    step = TIME[1] - TIME[0]
    F = np.array([[1.0, step, 0.5 * step**2], [0.0, 1.0, step], [0.0, 0.0, 1.0]])
    # The first error tells all, and by numbers that round: one of many rows of such processes.
    for tells in np.random.default_rng(5).normal(size=(20, 3)) * [1e-3, 1e-2, 1e-1]:
        states = [tells]
        for _ in TIME[1:]:
            states.append(F @ states[-1])
        covariance = np.array([np.outer(state, state) for state in states])
        known = ErrorProcess(covariance, np.tile(F, (len(TIME) - 1, 1, 1)), np.zeros((len(TIME) - 1, 3, 3)))
        met = behind_play(known, drive, TIME, WIDTH, 0.0)
        assert all(np.isfinite(part).all() for part in met)
        variance = np.einsum("kii->ki", met.covariance)[1:, :, None]
        assert np.all((met.root**2 <= 1e-9 * variance)[TIME[1:] > 2.2])
