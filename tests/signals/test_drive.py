from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import BPoly

from analytic.kernel import simulate
from analytic.models import CAM
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from harness.signals import smooth
from harness.signals.drive import Drive, make_drive
from tests.shared_data import CASES
from tests.signals.known_angles import KnownAngle, encoder, rms, servo_angle, travel

TIME = np.arange(0.0, 16.0, 0.01)


def drives(counts: int, noise: float, seeds: range, *, time: FloatArray = TIME, declared: bool = False):
    """Drives read from an encoder, with the true states, the readings and the resolution."""
    for seed in seeds:
        truth = servo_angle(seed, holds=seed % 3 > 0).states(time)
        reading, step = encoder(truth[:, 0], counts, noise, seed)
        yield make_drive(time, reading, resolution=step, noise=noise * step if declared else None), truth, reading, step


@pytest.mark.parametrize(("counts", "noise"), [(40000, 0.0), (12800, 0.0), (4096, 0.0), (4096, 0.2), (40000, 1.0)])
def test_drive_beats_counts_and_white_noise(counts, noise):
    """Leave smaller errors of α, α̇, α̈ than differences of counts and than white-noise smoothing do."""
    errors = []
    for drive, truth, reading, step in drives(counts, noise, range(6)):
        white = smooth(TIME, reading, (1.0 / 12.0 + noise**2) * step**2).mean
        rate = np.gradient(reading, TIME)
        differences = np.column_stack((reading, rate, np.gradient(rate, TIME)))
        errors.append([[rms((x - truth)[:, i]) for i in range(3)] for x in (drive.states, white, differences)])
        # α̈ is usable: the worst encoder leaves less than half of it unknown, where differences leave three times it.
        assert rms(drive.states[:, 2] - truth[:, 2]) < 0.5 * rms(truth[:, 2])
    ours, white, differences = np.mean(errors, axis=0)
    # One density must serve rest and motion alike; measured gains are 13–33 % (docs/drive.md), so 5 % is safe.
    assert np.all(ours < 0.95 * white)
    # The shortest moves last 15 readings and the freedom of 6 numbers: 2.5 readings to each, √2.5 = 1.6 for α, and
    # each derivative gains more, because differences amplify errors of short waves.
    assert ours[0] < differences[0] / 1.5
    assert np.all(ours[1:] < differences[1:] / 2.0)


@pytest.mark.parametrize(("counts", "noise"), [(40000, 0.0), (12800, 0.0), (4096, 0.0), (4096, 0.2), (4096, 0.5)])
def test_error_bars_of_the_angle_cover(counts, noise):
    """State errors that come true: z of RMS near 1, nineteen of twenty errors within two deviations."""
    scores = np.concatenate(
        [(drive.states[:, 0] - truth[:, 0]) / drive.std[:, 0] for drive, truth, *_ in drives(counts, noise, range(8))]
    )
    # Some 60 independent errors per record would scatter by 3 % in all; the prior is not the servo, hence the width.
    assert 0.7 < rms(scores) < 1.4
    assert np.mean(np.abs(scores) < 2.0) > 0.88


@pytest.mark.parametrize(("counts", "noise"), [(40000, 0.0), (4096, 0.0), (4096, 0.5)])
def test_angle_is_neither_late_nor_shrunk_nor_shifted(counts, noise):
    """Show no delay, gain or offset beyond what its own error bars allow: they would pass for physics later on."""
    found, spread = [], []
    for drive, truth, *_ in drives(counts, noise, range(8)):
        columns = np.column_stack((truth[:, 0], -truth[:, 1], np.ones(len(TIME))))  # gain, delay, offset
        found.append(np.linalg.lstsq(columns, drive.states[:, 0] - truth[:, 0])[0])
        paths = np.array([path.states[:, 0] - drive.states[:, 0] for path in drive.draw(20, 0)])
        spread.append(np.linalg.lstsq(columns, paths.T)[0].std(axis=1))
    # The mean over 8 records, in units of what the drive's own draws make of the same regression. Holds are half as
    # uncertain again as the draws say (docs/drive.md), hence 1.5 · 3 standard errors.
    error = np.sqrt(np.sum(np.square(spread), axis=0)) / len(spread)
    assert np.all(np.abs(np.mean(found, axis=0)) < 4.5 * error)
    if counts == 40000:
        gain, delay, offset = np.mean(found, axis=0)
        assert abs(gain) < 1e-3
        assert abs(delay) < 2e-4
        assert abs(offset) < 0.1 * 2 * np.pi / counts


def test_travel_error_is_foreseen():
    """Foresee by draws how far the angle's error carries the ball, which errors taken for independent miss by far."""
    actual, foreseen, independent = [], [], []
    generator = np.random.default_rng(0)
    for drive, truth, _, _ in drives(4096, 0.2, range(12)):
        actual.append(travel(TIME, drive.states[:, 0] - truth[:, 0])[-1])
        ends = [travel(TIME, path.states[:, 0] - drive.states[:, 0])[-1] for path in drive.draw(20, 0)]
        foreseen.append(rms(np.array(ends)))
        independent.append(travel(TIME, drive.std[:, 0] * generator.standard_normal(len(TIME)))[-1])
    # Twelve ends tell their deviation to 20 %.
    assert 0.5 < rms(np.array(actual)) / rms(np.array(foreseen)) < 1.6
    assert rms(np.array(independent)) < 0.5 * rms(np.array(foreseen))


def test_rate_and_acceleration_are_the_derivatives_of_the_angle():
    """Return one motion: α̇ and α̈ are the derivatives of α on any grid, and α̈ has no jumps."""
    drive, *_ = next(drives(4096, 0.0, range(1, 2)))
    inner = np.linspace(0.1, 15.8, 5003)
    h = 1e-5
    rate, acceleration = drive.derivative, partial(drive.derivative, order=2)
    for value, slope, scale in ((drive.evaluate, rate, 0.5), (rate, acceleration, 5.0)):
        difference = (value(inner + h) - value(inner - h)) / (2 * h)
        # h² x⁗/6 with third derivatives of 1e3 scale units within 10 ms; rounding 1e-16 · 16 s / h adds 1e-10.
        assert np.max(np.abs(difference - slope(inner))) < 1e-4 * scale
    eps = 1e-12
    jump = acceleration(TIME[1:-1] + eps) - acceleration(TIME[1:-1] - eps)
    # α⃛ of up to 1e4 rad/s³ over 2e-12 s; coefficients of h⁻⁵ = 1e10 at 1e-16 · 0.05 rad · h³ round to 1e-10.
    assert np.max(np.abs(jump)) < 1e-6
    assert np.allclose(drive.evaluate(TIME), drive.states[:, 0], rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("offset", [0.0, 0.2, 0.45, -0.3])
@pytest.mark.parametrize("counts", [4096, 40000])
def test_a_hold_is_a_hold(counts, offset):
    """Stand still between two quick moves, wherever within its count: no staircase, no tremble, no creeping."""
    step = 2 * np.pi / counts
    level = (0.03 // step + offset) * step
    states = [[0.0] * 3, [0.0] * 3, [level, 0.0, 0.0], [level, 0.0, 0.0], [-0.02, 0.0, 0.0], [-0.02, 0.0, 0.0]]
    truth = KnownAngle(BPoly.from_derivatives(np.array([0.0, 1.0, 1.3, 4.3, 4.6, 6.0]), states))
    time = np.arange(0.0, 6.0, 0.01)
    reading, _ = encoder(truth.states(time)[:, 0], counts)
    drive = make_drive(time, reading, resolution=step, noise=0.0)
    # The count stops changing before the beam does, and changes again after it starts: a margin of 0.2 s.
    inside = (time > 1.5) & (time < 4.1)
    assert np.ptp(reading[inside]) < 0.5 * step
    assert np.ptp(drive.states[inside, 0]) < 0.1 * step
    # A tremble by a tenth of a count within 0.1 s would be a rate of q/s, by a twentieth one of half of it.
    assert np.max(np.abs(drive.states[inside, 1])) < 0.5 * step
    assert rms(drive.states[inside, 2]) < 5.0 * step
    assert np.all(np.abs(drive.states[inside, 0] - level) < 3.0 * drive.std[inside, 0])


def test_slow_ramp_is_no_staircase():
    """See a ramp of one count in 0.5 s as a ramp: constant rate where counts jump."""
    rate, step = 2 * 2 * np.pi / 4096, 2 * np.pi / 4096
    truth = rate * TIME
    drive = make_drive(TIME, np.rint(truth / step) * step, resolution=step, noise=0.0)
    inner = slice(100, -100)
    # The thresholds' times are known to 10 ms of 0.5 s, that is 2 % of a count, edges are trusted to 5 %.
    assert rms(drive.states[inner, 0] - truth[inner]) < 0.06 * step
    assert rms(drive.states[inner, 1] - rate) < 0.1 * rate


def test_continuous_noisy_angle():
    """Read an analogue angle of 0.005 rad noise at 200 Hz to a quarter of it, whether the noise is declared or not."""
    time = np.arange(0.0, 16.0, 0.005)
    for seed in range(3):
        truth = servo_angle(seed).states(time)[:, 0]
        reading = truth + 0.005 * np.random.default_rng(seed).standard_normal(len(time))
        declared, found = make_drive(time, reading, noise=0.005), make_drive(time, reading)
        assert found.sensor.estimated
        assert found.sensor.noise == pytest.approx(0.005, rel=0.06)  # 1/√(2n) = 1.3 %, and the motion's freedom
        for drive in (declared, found):
            error = drive.states[:, 0] - truth
            # A move of 0.4 s is some 5 free numbers, rests fewer: at least 16 readings to each, hence σ/4.
            assert rms(error) < 0.25 * 0.005
            assert 0.7 < rms(error / drive.std[:, 0]) < 1.5
            assert drive.residual_ratio == pytest.approx(1.0, rel=0.06)


def test_ten_readings_a_second_are_enough_to_know_what_is_not_known():
    """Widen the error bars where 10 Hz sampling misses the moves, instead of being wrong."""
    time = np.arange(0.0, 16.0, 0.1)
    scores = [
        (drive.states[:, 0] - truth[:, 0]) / drive.std[:, 0]
        for drive, truth, *_ in drives(12800, 0.0, range(8), time=time, declared=True)
    ]
    assert 0.6 < rms(np.concatenate(scores)) < 1.4


def test_uneven_stamps_and_dropouts():
    """Keep the error bars right when stamps jitter, readings are missing and half a second is gone."""
    scores = []
    for seed in range(6):
        generator = np.random.default_rng(seed)
        time = TIME + generator.uniform(-0.004, 0.004, len(TIME))
        time = time[(generator.random(len(time)) > 0.1) & ((time < 5.0) | (time > 5.5))]
        truth = servo_angle(seed).states(time)[:, 0]
        reading, step = encoder(truth, 12800)
        reading[::17] = np.nan
        drive = make_drive(time, reading, resolution=step)
        scores.append((drive.states[:, 0] - truth) / drive.std[:, 0])
        assert np.all(np.isfinite(drive.states))
    assert 0.7 < rms(np.concatenate(scores)) < 1.4


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0, None])
def test_exact_angle_stays_exact(noise):
    """Pass an angle without noise or rounding through, declared so or not: nothing is smoothed away."""
    truth = servo_angle(0, holds=False).states(TIME)
    drive = make_drive(TIME, truth[:, 0], noise=noise)
    # A quintic spline at 10 ms through α⁗ jumps of 60 · 0.1/0.15⁴ = 1e4 rad/s⁴: 0.01⁴ · 1e4 / 384 = 3e-7 rad.
    assert np.max(np.abs(drive.states[:, 0] - truth[:, 0])) < 1e-6
    # α̈ has kinks there, of up to 60 · 0.1/0.15³ = 2e3 rad/s³: a smooth curve misses a corner by about a tenth of that
    # times 10 ms, 2 rad/s², over two readings of the 40 of a move whose α̈ is some 10 rad/s²: √(2/40) · 2/10 = 4 %.
    assert rms(drive.states[:, 2] - truth[:, 2]) < 0.05 * rms(truth[:, 2])


def test_drive_is_deterministic():
    """Return the same drive and draws for the same record, bit for bit."""
    first, second = (next(drives(4096, 0.2, range(1)))[0] for _ in range(2))
    assert np.array_equal(first.states, second.states)
    assert all(
        np.array_equal(a.states, b.states) for a, b in zip(first.draw(2, seed=7), second.draw(2, seed=7), strict=True)
    )


@pytest.mark.parametrize("share", [0.2, 5.0])
def test_misdeclared_noise_shows(share):
    """Tell by the residual ratio that a sensor's noise is five times larger or smaller than declared."""
    truth = servo_angle(0).states(TIME)[:, 0]
    reading = truth + 2e-3 * np.random.default_rng(0).standard_normal(len(TIME))
    # Right, it scatters by 1/√(2n) = 2 % about 1. Declared too large, the residual keeps its size. Declared too small,
    # noise passes for motion, and the residual is a smoother's own small one.
    assert make_drive(TIME, reading, noise=2e-3).residual_ratio == pytest.approx(1.0, rel=0.1)
    assert make_drive(TIME, reading, noise=share * 2e-3).residual_ratio < 0.75


def test_less_noise_is_more_motion():
    """Follow readings more closely the less of their noise is an error; leave those of mere rounding as they are."""
    ((noisy, _, reading, step),) = drives(40000, 3.0, range(1))
    followed = [rms(noisy.quieter(share).states[:, 0] - reading) for share in (1.0, 0.5, 0.1)]
    assert followed[0] > followed[1] > followed[2]
    # Of the noise nothing else is left than a tenth, and the rounding by up to half a count on either side.
    assert followed[2] < 0.1 * noisy.sensor.noise + 0.5 * step
    assert noisy.quieter(0.1).sensor.noise == pytest.approx(0.1 * noisy.sensor.noise)
    assert noisy.quieter(0.1).sensor.resolution == step
    ((rounded, *_),) = drives(4096, 0.0, range(1))
    assert rounded.quieter(0.1) is rounded


@pytest.mark.parametrize("rate", [0.0, 0.1])
def test_exact_reading_without_noise(rate):
    """Read a continuous angle that shows no noise at all, resting or on a ramp, as it stands."""
    angle = 0.01 + rate * TIME
    drive = make_drive(TIME, angle)
    # The motion is one of the prior's own, so that only rounding of doubles is left.
    assert np.abs(drive.states[:, 0] - angle).max() < 1e-12
    assert np.isfinite(drive.std).all()


def test_record_without_angles_is_refused():
    """Refuse a record of fewer than three angles."""
    with pytest.raises(ValueError, match="fewer than three"):
        make_drive(TIME[:4], np.array([0.0, np.nan, np.nan, 0.1]))


@pytest.mark.skipif(not CASES.exists(), reason="the folder ../shared is absent")
def test_free_run_on_an_effect_free_recording():
    """Drive CAM by an encoder of 40,000 counts to within what the drive's own draws foresee after 16 s."""
    record = pd.read_csv(CASES / "null_plain" / "rec_03.csv")
    truth = pd.read_csv(CASES / "null_plain" / "rec_03_true.csv").ball_position_m.to_numpy()
    time = record.time_s.to_numpy()
    drive: Drive = make_drive(time, record.beam_angle_rad.to_numpy(), resolution=2 * np.pi / 40000)
    start = State(float(truth[0]), 0.0)
    error = simulate([CAM], Rig(), drive, start, time)[0].position - truth
    runs = [simulate([CAM], Rig(), path, start, time)[0].position for path in drive.draw(20, 0)]
    # 20 draws tell their deviation to 16 %; the plant's own truth has another 0.4 mm.
    assert rms(error) < 2.5 * rms(np.std(runs, axis=0)) + 4e-4
    assert rms(error) < 2e-3


def test_of_noise_that_moves_no_ball_no_share_is_taken() -> None:
    """Keep the error of an angle that is known to a ten-millionth of a radian: less leaves no digits of it."""
    time = np.arange(200) / 100
    known = 1e-7 * np.random.default_rng(0).standard_normal(200) + 0.02
    drive = make_drive(time, known)
    assert drive.sensor.noise < 1e-6
    quieter = drive.quieter(0.01)
    assert quieter.sensor.noise == drive.sensor.noise
    assert np.isfinite(quieter.error.covariance).all()
    noisy = make_drive(time, 0.02 + 1e-3 * np.random.default_rng(0).standard_normal(200))
    assert noisy.quieter(0.01).sensor.noise == pytest.approx(0.01 * noisy.sensor.noise)
