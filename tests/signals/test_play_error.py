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


def through_play(angle: FloatArray, begin: float, width: float = WIDTH) -> FloatArray:
    """The beam behind each angle, shape (n,) [rad], which begins `begin` above the first one [rad]."""
    beam = np.empty_like(angle)
    at = angle[0] + begin
    for k, here in enumerate(angle):
        at = min(max(at, here - 0.5 * width), here + 0.5 * width)
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


def test_the_beam_is_known_as_well_as_drawn_ones_scatter(drive: Drive, error: ErrorProcess, drawn: FloatArray) -> None:
    """State their variance where nothing has met the beam, and where it has been met from both sides."""
    stated, found = np.sqrt(error.covariance[:, 0, 0]), np.sqrt(np.mean(drawn**2, axis=0))
    # At first the gap over √12 beside the angle's; a deviation from 1500 draws is off by at most 4/√3000, 7 %.
    at_first = np.hypot(WIDTH / np.sqrt(12.0), np.sqrt(drive.error.covariance[:30, 0, 0]))
    np.testing.assert_allclose(stated[:30], at_first, rtol=1e-3)  # 32 places in the gap: 1/(2 · 32²)
    np.testing.assert_allclose(found[:30], stated[:30], rtol=0.07)
    # Later, that of a beam which stands is of the turn, and the angle's on average.
    later = TIME > 2.2
    assert stated[later].max() < 0.1 * stated[0]
    np.testing.assert_allclose(np.mean(stated[later] ** 2), np.mean(found[later] ** 2), rtol=0.25)


def test_a_narrow_play_tells_no_more_of_the_beam_than_of_the_angle(drive: Drive) -> None:
    """State as much variance behind a play of a third of a count as drawn beams have, and as quickly forgotten."""
    width, apart = STEP / 3.0, 10
    begins = np.random.default_rng(5).uniform(-0.5, 0.5, 600) * width
    assumed = through_play(drive.states[:, 0], 0.0, width)
    paths = [path.states[:, 0] for path in drive.draw(600, seed=2)]
    drawn = np.array(
        [through_play(path, begin, width) for path, begin in zip(paths, begins, strict=True)]
    ) - assumed  # fmt: skip
    error = behind_play(drive.error, drive, TIME, width, 0.0)
    use = np.flatnonzero(TIME > 2.2)[:-apart]
    covariance = error.covariance[use]
    for k in range(apart):
        covariance = error.transition[use + k] @ covariance
    found = np.mean(drawn[:, use + apart] * drawn[:, use], axis=0)
    scale = np.mean(drawn[:, use] ** 2)
    # 270 instants that share the error of a count for some tens of ms, of 600 draws: 2 % of the variance each way; that
    # a beam stands within the gap now and then is left out, which is 1 % of it.
    assert np.mean(error.covariance[use, 0, 0]) / scale == pytest.approx(1.0, abs=0.1)
    assert np.mean(covariance[:, 0, 0]) / scale == pytest.approx(np.mean(found) / scale, abs=0.06)


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
    """State a beam's error behind a play of 1 nrad as without one."""
    for made, known in zip(behind_play(drive.error, drive, TIME, 1e-9, 0.0), drive.error, strict=True):
        np.testing.assert_allclose(made, known, rtol=1e-9, atol=1e-12 * np.abs(known).max())


def test_behind_an_angle_that_is_known_exactly_only_the_beginning_is_not(drive: Drive) -> None:
    """State the gap's variance until the beam has been met from both sides, and none from then on."""
    n = len(TIME)
    known = ErrorProcess(np.zeros((n, 3, 3)), drive.error.transition, np.zeros((n - 1, 3, 3)))
    made = behind_play(known, drive, TIME, WIDTH, 0.0)
    deviation = np.sqrt(made.covariance[:, 0, 0])
    np.testing.assert_allclose(deviation[:30], WIDTH / np.sqrt(12.0), rtol=1e-3)  # 32 places in the gap: 1/(2 · 32²)
    assert not deviation[TIME > 2.2].any()
    after = made.transition @ made.covariance[:-1] @ made.transition.transpose(0, 2, 1)
    after += made.root @ made.root.transpose(0, 2, 1)
    np.testing.assert_allclose(after, made.covariance[1:], atol=1e-9 * WIDTH**2)
