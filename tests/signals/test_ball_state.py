from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analytic.kernel import simulate
from analytic.models import CAM, Model, Reading
from analytic.motion import FloatArray, State
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from harness.signals.ball_state import BallEstimate, estimate_ball
from harness.signals.drive import make_drive
from tests.shared_data import SHARED
from tests.signals.known_angles import rms, servo_angle

TIME = np.arange(0.0, 12.0, 0.01)
NOISE, RESOLUTION = 3e-4, 1e-4
RESISTED = CAM.variant("resisted", reading=Reading.COULOMB)
# K f_b g with K = 0.666: the friction's deceleration is 0.026 m/s²
RIG = Rig(friction_coefficient=0.004, transition_velocity=1e-3)
DECELERATION = 0.026


def motion(seed: int) -> QuinticMotion:
    """A beam that swings about level within 2°, so that the ball does."""
    phase = np.random.default_rng(seed).uniform(0.0, 6.3)
    a, w = 0.035, 1.9
    swing = w * TIME + phase
    return QuinticMotion(TIME, np.column_stack((a * np.sin(swing), a * w * np.cos(swing), -a * w * w * np.sin(swing))))


def run(seed: int, model: Model = CAM) -> tuple[QuinticMotion, FloatArray, FloatArray, FloatArray]:
    """Beam, true position and velocity, and readings of a ball."""
    beam = motion(seed)
    truth = simulate([model], RIG, beam, State(0.35, 0.02), TIME)[0]
    shaken = truth.position + NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
    return beam, truth.position, truth.velocity, np.rint(shaken / RESOLUTION) * RESOLUTION


def deviation(ball: BallEstimate) -> FloatArray:
    """Of s, ṡ and residual, shape (n, 3)."""
    return np.sqrt(np.diagonal(ball.covariance, axis1=1, axis2=2))


@pytest.mark.parametrize("declared", [NOISE, None])
def test_state_covers_the_truth(declared):
    """Give position, velocity and start state with error bars that come true, noise declared or not."""
    scores, starts = [], []
    for seed in range(24):
        beam, position, velocity, readings = run(seed, RESISTED)
        ball = estimate_ball(TIME, readings, beam, Rig(), noise=declared, resolution=RESOLUTION)
        off = np.column_stack((ball.position - position, ball.velocity - velocity)) / deviation(ball)[:, :2]
        scores.append([rms(off[:, 0]), rms(off[:, 1])])
        error = np.array([ball.position[0] - position[0], ball.velocity[0] - velocity[0]])
        starts.append(error @ np.linalg.solve(ball.state_covariance(0), error))
        assert ball.noise == pytest.approx(NOISE, rel=0.08)  # 1/√(2n) = 2 %, times 3.5 or so
        assert ball.noise_estimated == (declared is None)
        assert ball.trusted.mean() > 0.99
    # Friction jumps where the smooth remainder bends: velocities there are off by more than a Gaussian would allow.
    assert np.all(np.mean(scores, axis=0) < [1.3, 1.7])
    assert np.all(np.mean(scores, axis=0) > 0.6)
    # χ² with 2 degrees of freedom has the median 1.4 and exceeds 10 once in 150; where the friction jumps right after
    # the start the error is up to half as large again, χ² twice.
    assert np.median(starts) < 4.0
    assert max(starts) < 20.0


def test_residual_is_what_the_model_lacks():
    """Show a resistance of ±0.026 m/s² as a square wave against the velocity, and nothing where nothing acts."""
    beam, _, velocity, readings = run(0, RESISTED)
    ball = estimate_ball(TIME, readings, beam, Rig(), noise=NOISE, resolution=RESOLUTION)
    moving = np.abs(velocity) > 0.02
    away = np.convolve(~moving, np.ones(61), "same") < 0.5  # a jump takes the smoother some 0.3 s
    assert away.sum() > 200
    expected = -DECELERATION * np.sign(velocity)
    error = (ball.residual - expected)[away]
    assert abs(float(np.mean(error * np.sign(velocity[away])))) < 0.15 * DECELERATION
    assert rms(error) < 2.0 * rms(deviation(ball)[away, 2])
    beam, _, _, readings = run(0)
    free = estimate_ball(TIME, readings, beam, Rig(), noise=NOISE, resolution=RESOLUTION)
    assert rms(free.residual) < 0.05 * DECELERATION


def test_model_need_not_be_right():
    """Give the same state with a rig that is wrong by a quarter: what the model lacks goes to the remainder."""
    beam, position, velocity, readings = run(1)
    wrong = Rig().with_(gravity=9.81 * 1.25, level_angle=0.02)
    ball = estimate_ball(TIME, readings, beam, wrong, noise=NOISE, resolution=RESOLUTION)
    assert rms((ball.position - position) / deviation(ball)[:, 0]) < 1.4
    assert rms((ball.velocity - velocity) / deviation(ball)[:, 1]) < 1.6
    assert rms(ball.velocity - velocity) < 3e-3


@pytest.mark.parametrize(("low", "high"), [(-0.05, -0.01), (-0.05, -0.03), (-0.05, 0.05)])
def test_spikes_do_not_drag_the_ball(low, high):
    """Follow the core of the readings when a sixth of them drop out, downwards or to both sides."""
    generator = np.random.default_rng(5)
    for seed in range(3):
        beam, position, _, readings = run(seed, RESISTED)
        hit = generator.random(len(TIME)) < 0.16
        readings[hit] += generator.uniform(low, high, int(hit.sum()))
        ball = estimate_ball(TIME, readings, beam, Rig(), resolution=RESOLUTION)
        assert rms((ball.position - position) / deviation(ball)[:, 0]) < 1.5
        wild = hit & (np.abs(readings - position) > 10.0 * NOISE)
        assert not np.any(ball.trusted[wild])
        assert np.mean(ball.trusted[~hit]) > 0.98


def test_positions_of_the_beginning_only():
    """Know the start as well as 1.5 s allow, and be ever less sure after them."""
    for seed in range(4):
        beam, position, velocity, readings = run(seed)
        readings[TIME > 1.5] = np.nan
        ball = estimate_ball(TIME, readings, beam, Rig(), noise=NOISE, resolution=RESOLUTION)
        spread = deviation(ball)
        assert abs(ball.position[0] - position[0]) < 3.5 * spread[0, 0]
        assert abs(ball.velocity[0] - velocity[0]) < 3.5 * spread[0, 1]
        assert np.all(np.diff(spread[200:, 0]) > 0.0)
        assert not ball.trusted[TIME > 1.5].any()


def test_blank_beginning():
    """Work when the first second of positions is unknown."""
    beam, position, _, readings = run(2)
    readings[:100] = np.nan
    ball = estimate_ball(TIME, readings, beam, Rig(), noise=NOISE, resolution=RESOLUTION)
    assert rms(((ball.position - position) / deviation(ball)[:, 0])[100:]) < 1.4
    assert np.argmax(ball.trusted) == 100


def test_coarse_positions():
    """Read positions of 2 mm resolution to a fraction of it: a moving ball dithers them."""
    beam, position, _, _ = run(3)
    ball = estimate_ball(TIME, np.rint(position / 2e-3) * 2e-3, beam, Rig(), resolution=2e-3)
    # q/√12 = 0.58 mm per reading, and at least ten readings to each free number of a smooth remainder
    assert rms(ball.position - position) < 0.58e-3 / np.sqrt(10.0)
    assert ball.noise < 0.3e-3


def test_too_few_positions_are_refused():
    """Refuse a record with two positions."""
    readings = np.full(len(TIME), np.nan)
    readings[[3, 9]] = 0.3
    with pytest.raises(ValueError, match="fewer than three"):
        estimate_ball(TIME, readings, motion(0), Rig())


def test_angle_read_by_an_encoder():
    """Cover the truth also with a drive read from 4096 counts, whose error the remainder takes up."""
    states = servo_angle(1).states(TIME)
    step = 2 * np.pi / 4096
    drive = make_drive(TIME, np.rint(states[:, 0] / step) * step, resolution=step)
    truth = simulate([CAM], Rig(), QuinticMotion(TIME, states), State(0.0, 0.0), TIME)[0]
    readings = truth.position + NOISE * np.random.default_rng(0).standard_normal(len(TIME))
    ball = estimate_ball(TIME, readings, drive, Rig(), noise=NOISE)
    assert rms((ball.position - truth.position) / deviation(ball)[:, 0]) < 1.5
    assert rms((ball.velocity - truth.velocity) / deviation(ball)[:, 1]) < 1.7


@pytest.mark.skipif(not SHARED.exists(), reason="the folder ../shared is absent")
def test_sensor_that_drops_out_downwards():
    """Follow the upper core of a real record an eighth of whose readings lie some 3 cm too low."""
    record = pd.read_csv(SHARED / "recordings" / "uts" / "rec_03.csv")
    time, readings = record.time_s.to_numpy(), record.ball_position_m.to_numpy()
    drive = make_drive(time, record.beam_angle_rad.to_numpy(), noise=0.005)
    ball = estimate_ball(time, readings, drive, Rig(), noise=0.012)
    assert 0.05 < np.mean(~ball.trusted) < 0.25
    below = readings[~ball.trusted] < ball.position[~ball.trusted]
    assert np.mean(below) > 0.95
    assert ball.noise < 0.012
    # At rest in the end, the mean of all readings is dragged down by a share of 0.13 · 31 mm = 4 mm.
    rest = time > 8.0
    assert 2e-3 < np.mean(ball.position[rest]) - np.mean(readings[rest]) < 6e-3
