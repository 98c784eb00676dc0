"""Imperfections of a record, one at a time, on a run that is given: each does what it says, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.simulator import Encoder, Imperfections, Laser, Record, Run, Sensors, Servo, WornPlace
from harness.simulator.imperfect_record import TICK, coloured, dropouts, imperfect_record, read_times, stamps
from harness.simulator.moves import SERVO

STEP, RATE, DURATION = 2e-4, 100.0, 20.0
TIME: FloatArray = np.arange(round(DURATION / STEP) + 1) * STEP
FINEST = 1e-9  # resolution of sensors that round nothing [m], [rad]
EXACT = Sensors(
    encoder=Encoder(counts=round(2 * np.pi / FINEST)),
    laser=Laser(near=-9.0, far=9.0, noise_near=0.0, noise_far=0.0, resolution=FINEST),
    rate=RATE,
)
NOISY = replace(EXACT, laser=replace(EXACT.laser, noise_near=1e-3, noise_far=1e-3))


def run_of(position: FloatArray, shaft: FloatArray | None = None) -> Run:
    """A run with this position [m] and this angle of the shaft [rad]; nothing else of it is recorded."""
    nothing = np.zeros_like(TIME)
    angle = nothing if shaft is None else shaft
    return Run(TIME, angle, nothing, nothing, angle, nothing, position, *(nothing for _ in range(9)))


def recorded(imperfections: Imperfections, position: FloatArray, sensors: Sensors = EXACT) -> Record:
    """The record of a ball that was at these positions [m]."""
    return imperfect_record(run_of(position), None, sensors, imperfections, seed=3)


SWING: FloatArray = 0.3 + 0.1 * np.sin(1.3 * TIME)


def test_without_imperfections_the_record_is_what_happened() -> None:
    """Record angle and position as they are at the stamps, at the sensors' rate."""
    shaft = 0.05 * np.cos(2.1 * TIME)
    record = imperfect_record(run_of(SWING, shaft), None, EXACT, Imperfections(), seed=1)
    np.testing.assert_allclose(record.time, np.arange(2001) / RATE, atol=1e-12)
    np.testing.assert_allclose(record.position, SWING[::50], atol=FINEST)
    np.testing.assert_allclose(record.angle, shaft[::50], atol=FINEST)


def test_sensor_lag_is_a_first_order_step_response() -> None:
    """Follow a step of the position by 1 − e^(−t/τ)."""
    stepped = np.where(TIME < 1.0, 0.2, 0.4)
    record = recorded(Imperfections(sensor_lag=0.05), stepped)
    since = np.maximum(record.time - 1.0, 0.0)
    # the step is linear over one plant step, half of which, 0.1 ms, it may seem late: 0.2 m · 0.1 ms/50 ms
    np.testing.assert_allclose(record.position, 0.2 + 0.2 * (1.0 - np.exp(-since / 0.05)), atol=5e-4)


@pytest.mark.parametrize("uneven", [0.0, 0.15])
def test_coloured_noise_is_as_correlated_as_asked(uneven: float) -> None:
    """Correlate readings Δt apart by e^(−Δt/τ), with unit variance, also where the intervals vary."""
    tau, n = 0.03, 40_000
    read = read_times(n / RATE, RATE, uneven, np.random.default_rng(5))
    noise = coloured(read, tau, np.random.default_rng(6))
    expected = float(np.mean(np.exp(-np.diff(read) / tau)))
    # standard errors of a first-order process (Bartlett): of r₁ √((1 − ρ²)/n), of the variance
    # √(2 (1 + ρ²)/(1 − ρ²)/n); four of each
    rho2 = expected**2
    assert np.mean(noise[1:] * noise[:-1]) / np.mean(noise**2) == pytest.approx(
        expected, abs=4 * np.sqrt((1 - rho2) / n)
    )
    assert np.mean(noise**2) == pytest.approx(1.0, abs=4 * np.sqrt(2 * (1 + rho2) / (1 - rho2) / n))


def test_noise_without_a_correlation_time_is_white() -> None:
    """Scatter independently by the laser's noise."""
    error = recorded(Imperfections(), SWING, NOISY).position - SWING[::50]
    # 2001 readings: standard error of r₁ 1/√n = 2.2 %, of the deviation 1/√(2 n) = 1.6 %; four of each
    assert np.std(error) == pytest.approx(1e-3, rel=0.064)
    assert abs(np.mean(error[1:] * error[:-1])) / 1e-6 < 0.09


@pytest.mark.parametrize("side", [-1, 1])
def test_spikes_go_to_one_side(side: int) -> None:
    """Displace the share asked for, by a size between the bounds, to one side only, and nothing else."""
    asked = Imperfections(spiked=0.05, spike_low=0.03, spike_high=0.06, spike_side=side)
    error = side * (recorded(asked, SWING).position - SWING[::50])
    spikes = error > 1e-6
    # binomial of 2001 readings: 5 % ± four times 0.49 %
    assert spikes.mean() == pytest.approx(0.05, abs=0.02)
    assert error[spikes].min() >= 0.03 - FINEST
    assert error[spikes].max() <= 0.06 + FINEST
    np.testing.assert_allclose(error[~spikes], 0.0, atol=FINEST)


def test_drop_outs_repeat_or_blank_readings() -> None:
    """Repeat the last reading before, or leave blank, as often as asked; all others are as they are."""
    repeating = recorded(Imperfections(repeated=0.2), SWING, NOISY).position
    plain = recorded(Imperfections(), SWING, NOISY).position
    same = repeating[1:] == repeating[:-1]
    assert 0.1 < same.mean() < 0.3  # of 2001 readings in runs of three: 0.2 ± 4 · 0.018, and the odd equal pair
    np.testing.assert_array_equal(repeating[1:][~same], plain[1:][~same])
    blank = recorded(Imperfections(missing=0.2), SWING, NOISY).position
    assert 0.1 < np.isnan(blank).mean() < 0.3
    known = ~np.isnan(blank)
    np.testing.assert_array_equal(blank[known], plain[known])


def test_drop_outs_have_the_share_and_length_asked_for() -> None:
    """Make runs of the mean length, and of all readings the share, of a two-state chain."""
    n, share, length = 200_000, 0.15, 3.0
    out = dropouts(n, share, length, np.random.default_rng(8))
    begins = int(np.sum(out[1:] & ~out[:-1]))
    # Runs are geometric, of deviation √(L (L − 1)) = 2.4: the mean of 10⁴ runs has 0.8 %. The chain forgets by
    # r = 1 − 1/L − p a step, p the chance to begin: deviation of the share √(s (1 − s)(1 + r)/(1 − r)/n) = 0.17 %.
    assert out.sum() / begins == pytest.approx(length, rel=0.032)
    assert out.mean() == pytest.approx(share, abs=4 * 0.0017)
    assert not out[0]


def test_a_worn_place_displaces_only_the_ball_that_is_on_it() -> None:
    """Add its step between its ends and nothing elsewhere."""
    worn = (WornPlace(start=0.30, end=0.32, step=0.007), WornPlace(start=0.35, end=0.36, step=-0.004))
    error = recorded(Imperfections(worn=worn), SWING).position - SWING[::50]
    on = [(SWING[::50] >= one.start) & (SWING[::50] < one.end) for one in worn]
    assert all(here.any() for here in on)
    np.testing.assert_allclose(error, 0.007 * on[0] - 0.004 * on[1], atol=FINEST)


def test_zero_of_the_angle_wanders_slowly_from_nothing() -> None:
    """Begin right, stay within twice the amplitude, and turn no faster than the period asked for."""
    record = recorded(Imperfections(drift=2e-3, drift_period=30.0), SWING)
    assert record.angle[0] == 0.0
    assert 1e-3 < np.max(np.abs(record.angle)) <= 4e-3
    fastest = 2e-3 * 2 * np.pi / 30.0 / RATE  # of a sine, between readings
    assert np.max(np.abs(np.diff(record.angle))) <= fastest + 2 * FINEST
    np.testing.assert_allclose(record.position, SWING[::50], atol=FINEST)


@pytest.mark.parametrize("bunch", [1, 4])
@pytest.mark.parametrize("rate", [10.0, 100.0, 500.0])
def test_stamps_increase_strictly(rate: float, bunch: int) -> None:
    """Give each reading a later stamp, by a tick of the file at least, however wrong stamps are."""
    wild = Imperfections(uneven=0.5, stamp_error=1.0, bunch=bunch)
    read = read_times(DURATION, rate, wild.uneven, np.random.default_rng(1))
    made = stamps(read, rate, wild, np.random.default_rng(2))
    assert np.diff(made).min() > 0.999 * TICK
    assert len({f"{stamp:.4f}" for stamp in made}) == read.size


def test_bunched_readings_bear_the_time_of_the_last() -> None:
    """Stamp four readings when the fourth is there, ticks apart; what was read is not displaced."""
    record = recorded(Imperfections(bunch=4), SWING)
    np.testing.assert_allclose(record.position, SWING[::50], atol=FINEST)
    first = record.time[: 4 * 500].reshape(-1, 4)
    np.testing.assert_allclose(first[:, 0], 0.03 + 0.04 * np.arange(500), atol=1e-9)
    np.testing.assert_allclose(np.diff(first, axis=1), TICK, atol=1e-9)


def test_uneven_sampling_has_true_stamps() -> None:
    """Vary the interval by the share asked for, independently, and read what is there at the stamp."""
    record = recorded(Imperfections(uneven=0.15), SWING)
    np.testing.assert_allclose(record.position, np.interp(record.time, TIME, SWING), atol=0.13 * TICK)  # 0.13 m/s
    steps = np.diff(record.time) * RATE
    # 2000 intervals: standard errors 1/√(2 n) = 1.6 % of the deviation, 1/√n = 2.2 % of the correlation; four of each
    assert np.std(steps) == pytest.approx(0.15, rel=0.064)
    assert abs(np.corrcoef(steps[1:], steps[:-1])[0, 1]) < 0.09
    assert steps.min() >= 0.5 - 2 * TICK * RATE


def test_a_commanded_angle_is_held_between_commands() -> None:
    """Record the latest command, 20 times a second, in place of the beam's angle."""
    command = np.random.default_rng(4).uniform(-0.05, 0.05, 401)
    asked = Imperfections(servo_lag=0.1, control_rate=20.0)
    record = imperfect_record(run_of(SWING), command, EXACT, asked, seed=1)
    np.testing.assert_allclose(record.angle, np.repeat(command, 5)[: record.angle.size], atol=FINEST)
    with pytest.raises(ValueError, match="there are none"):
        imperfect_record(run_of(SWING), None, EXACT, asked, seed=1)


def test_a_servo_lags_as_asked() -> None:
    """Follow a step like a second-order system whose mean delay, ∫(1 − α/α_c) dt, is the lag asked for."""
    asked = Imperfections(servo_lag=0.2, servo_damping=0.7)
    angle, rate, acceleration = (np.zeros_like(TIME) for _ in range(3))
    asked.servo(SERVO).follow(0.05, STEP, angle, rate, acceleration)
    assert float(np.sum(1.0 - angle / 0.05)) * STEP == pytest.approx(0.2, abs=2 * STEP)  # sums for integrals: a step
    overshoot = np.exp(-np.pi * 0.7 / np.sqrt(1 - 0.7**2))
    assert angle.max() / 0.05 - 1.0 == pytest.approx(overshoot, rel=0.02)  # 4.6 %, of steps of 0.1 % of the period
    assert isinstance(asked.servo(SERVO), Servo)
    assert Imperfections().servo(SERVO) is SERVO


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"sensor_lag": -0.1}, "sensor_lag is -0.1"),
        ({"spiked": 0.9}, "spiked is 0.9; a share"),
        ({"spike_side": 0}, "spike_side is 0"),
        ({"spike_low": 0.1}, "spike_high is 0.06"),
        ({"bunch": 0}, "bunch is 0; it must be at least 1"),
        ({"control_rate": 0.0}, "control_rate is 0.0"),
        ({"drift": np.nan}, "drift is nan"),
    ],
)
def test_what_cannot_be_is_refused(wrong: dict[str, float], message: str) -> None:
    """Name the value and what it may be."""
    with pytest.raises(ValueError, match=message):
        Imperfections(**wrong)
