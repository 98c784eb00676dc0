"""A held command acts from its stamp on, and a beam that lags follows it from there."""

from __future__ import annotations

import numpy as np

from analytic.effects import ANGLE_GAIN, ANGLE_SERVO, acting
from analytic.effects.catalogue import motion_with
from analytic.motion import FloatArray, beam_states
from harness.signals.drive import make_drive
from harness.signals.held_drive import HeldDrive, held_drive

TIME = 0.02 * np.arange(200)
COMMAND = 0.05 * np.sign(np.sin(2.0 * TIME + 0.5)) + np.random.default_rng(1).normal(0.0, 0.02, len(TIME))
LAG, DAMPING = 0.15, 1.0


def held(command: FloatArray = COMMAND) -> HeldDrive:
    """The drive of a command."""
    return held_drive(make_drive(TIME, command))


def followed(command: FloatArray, gain: float = 1.0) -> FloatArray:
    """α [rad] and α̇ [rad/s] of a servo at the stamps, shape (n, 2): Euler steps of 0.02 ms, command by command."""
    steps, own = 1000, DAMPING * 2.0 / LAG  # (T/2ζ)² β̈ + T β̇ + β = α
    angle, rate, out = gain * command[0], 0.0, []
    for value in gain * command:
        out.append((angle, rate))
        for _ in range(steps):
            rate += 0.02 / steps * own**2 * (value - angle - LAG * rate)
            angle += 0.02 / steps * rate
    return np.array(out)


def test_a_beam_that_lags_follows_each_command_from_its_stamp_on() -> None:
    """Give the servo's equation its commands, with and without a gain before it.

    Commands change by 30 mrad, over 0.1 ms about their stamps in place of at once; the servo's rate is up to 0.6 rad/s,
    and Euler's steps of 0.02 ms are late by half of one.
    """
    servo = acting(ANGLE_SERVO.name, {"lag": LAG, "damping": DAMPING})
    for gain in (1.0, 1.3):
        effects = [acting(ANGLE_GAIN.name, {"gain": gain}), servo] if gain != 1.0 else [servo]
        factor = motion_with(held(np.ones(200)), TIME, effects).evaluate(TIME[-1:])[0]
        drive = held()
        states = beam_states(motion_with(drive, drive.time, effects), TIME)
        expected = followed(COMMAND, factor)
        np.testing.assert_allclose(states[:, 0], expected[:, 0], atol=1.2e-5 * factor)


def test_what_follows_is_exact_where_commands_come_fast() -> None:
    """Follow commands of 1 kHz, as those of a tenth of the rate, each ten times."""
    servo = [acting(ANGLE_SERVO.name, {"lag": 1.0, "damping": DAMPING})]
    fast = held_drive(make_drive(1e-3 * np.arange(2000), np.repeat(COMMAND, 10)[:2000]))
    at = 0.01 * np.arange(100)
    slow = held_drive(make_drive(0.01 * np.arange(200), COMMAND))
    one, two = (beam_states(motion_with(each, each.time, servo), at) for each in (slow, fast))
    # Both turn within 0.1 ms; ten steps to the same command are one.
    np.testing.assert_allclose(one[:, 0], two[:, 0], atol=1e-9)


def test_no_later_command_moves_the_beam_before_its_stamp() -> None:
    """Let the last of two commands that differ in one change nothing until that one's stamp."""
    other = COMMAND.copy()
    other[100] += 0.1
    servo = [acting(ANGLE_SERVO.name, {"lag": LAG, "damping": DAMPING})]
    one, two = (beam_states(motion_with(each, each.time, servo), TIME) for each in (held(), held(other)))
    np.testing.assert_allclose(one[:100], two[:100], rtol=0.0, atol=1e-10)  # beside 10 rad/s²
    # Over the 0.05 ms before it, by a mean of 25 mrad at most: (2/0.15)² times that, twice integrated.
    np.testing.assert_allclose(one[100, 0], two[100, 0], rtol=0.0, atol=0.5 * (2.0 / LAG) ** 2 * 0.025 * 5e-5**2)
    assert abs(one[105, 0] - two[105, 0]) > 1e-3


def test_at_a_stamp_the_acceleration_is_the_mean_of_those_before_and_after() -> None:
    """Give steps that end and begin at a stamp what they have together: a servo's acceleration jumps there."""
    servo = [acting(ANGLE_SERVO.name, {"lag": LAG, "damping": DAMPING})]
    drive = held()
    before, at, after = (
        beam_states(motion_with(drive, drive.time, servo), TIME[1:-1] + late)[:, 2] for late in (-1e-4, 0.0, 1e-4)
    )
    # Over 0.1 ms either way the acceleration falls by its rate's and angle's share, 2/T and (2/T)²: 0.3 % of it.
    np.testing.assert_allclose(at, 0.5 * (before + after), atol=0.003 * np.abs(at).max())
    assert np.abs(after - before).max() > 5.0


def test_without_a_lag_it_has_no_rate() -> None:
    """Give the mean over half a hold on either side, and no rate, which a command does not tell."""
    states = held().states_at(TIME[1:-1])
    np.testing.assert_allclose(states[:, 0], 0.5 * (COMMAND[:-2] + COMMAND[1:-1]), atol=1e-12)
    assert not states[:, 1:].any()


def test_engines_get_a_smooth_motion_that_is_as_late() -> None:
    """Delay the smoothed command by half a hold, and change by less from stamp to stamp than the command does."""
    gentle = held(0.05 * np.sin(3.0 * TIME)).gentle
    inner = TIME[20:-20]
    np.testing.assert_allclose(gentle.evaluate(inner), 0.05 * np.sin(3.0 * (inner - 0.01)), atol=1e-4)
    assert np.std(np.diff(held().gentle.evaluate(TIME))) < 0.3 * np.std(np.diff(COMMAND))


def test_an_unknown_angle_leaves_the_command_before() -> None:
    """Hold the last known command where none was recorded."""
    gap = COMMAND.copy()
    gap[50:53] = np.nan
    kept = COMMAND.copy()
    kept[50:53] = kept[49]
    np.testing.assert_array_equal(held(gap).states, held(kept).states)


def test_it_has_next_to_no_error_and_is_not_smoothed() -> None:
    """Be itself whatever is asked of its smoothing, and draw motions that scatter by a millionth of a radian."""
    drive = held()
    assert drive.rougher(100.0) is drive.quieter(0.1) is drive
    scatter = np.array([one.states[:, 0] - drive.states[:, 0] for one in drive.draw(50, seed=0)])
    np.testing.assert_allclose(scatter.std(), 1e-6, rtol=0.05)
    assert drive.error.covariance.shape == (598, 3, 3)
