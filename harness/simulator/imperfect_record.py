"""How a run is written down by a rig with imperfections."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.simulator.channel import Channel
from harness.simulator.imperfections import Imperfections, WornPlace
from harness.simulator.plant import Run
from harness.simulator.protocol import Record, Sensors

TICK = 1e-4  # of the clock: as a record is written [s]
SHORTEST, LONGEST = 0.5, 2.0  # interval over its mean; uneven sampling does not go beyond


def imperfect_record(
    run: Run, command: FloatArray | None, sensors: Sensors, imperfections: Imperfections, seed: int
) -> Record:
    """Write down a run.

    Args:
        run: what happened.
        command: angles commanded at 0, 1/`control_rate`, …, shape (m,) [rad]; asked for where the servo lags.
        sensors: what is read, and how often on average.
        imperfections: of the record.
        seed: of all that is random in it.

    Returns:
        The record; its stamps increase strictly, by a tick of 0.1 ms at least.

    Raises:
        ValueError: the servo lags and there is no command.
    """
    # One generator each, so that an imperfection does not depend on which others there are.
    clock, angle, noise, spikes, repeats, blanks, zero = (
        np.random.default_rng(one) for one in np.random.SeedSequence((seed, 4)).spawn(7)
    )
    dt = float(run.time[1] - run.time[0])
    read = read_times(float(run.time[-1]), sensors.rate, imperfections.uneven, clock)
    if imperfections.servo_lag > 0.0:
        if command is None:
            raise ValueError("a servo that lags is recorded by its commands; there are none")
        number = np.floor(read * imperfections.control_rate + 1e-9).astype(np.int64)
        shown = command[np.minimum(number, command.size - 1)]
    else:
        shown = sensors.channel.beside(run.shaft, dt, read)
    shown = shown + wandering(read, imperfections, float(zero.uniform(0.0, 2.0 * np.pi)))

    lagged = Channel(time_constant=imperfections.sensor_lag).read(run.position, dt, run.time)
    position = sensors.channel.read(lagged, dt, read)
    position = position + worn_steps(position, imperfections.worn)
    position = sensors.laser.read(position, coloured(read, imperfections.noise_time, noise))
    struck = spikes.uniform(size=read.size) < imperfections.spiked
    size = spikes.uniform(imperfections.spike_low, imperfections.spike_high, read.size)
    position = np.where(struck, position + imperfections.spike_side * size, position)
    position = repeated(position, dropouts(read.size, imperfections.repeated, imperfections.dropout_length, repeats))
    gone = dropouts(read.size, imperfections.missing, imperfections.dropout_length, blanks)
    return Record(
        stamps(read, sensors.rate, imperfections, clock),
        sensors.encoder.measure(shown, angle),
        np.where(gone, np.nan, position),
    )


def read_times(duration: float, rate: float, uneven: float, generator: np.random.Generator) -> FloatArray:
    """When the sensors are read, from 0 to `duration` [s]: intervals are independent, 0.5 to 2 times their mean."""
    count = round(duration * rate)
    steps = np.clip(1.0 + uneven * generator.standard_normal(2 * count), SHORTEST, LONGEST) / rate
    times = np.concatenate(([0.0], np.cumsum(steps if uneven > 0.0 else np.full(count, 1.0 / rate))))
    return times[times <= duration + 1e-9].clip(max=duration)


def stamps(read: FloatArray, rate: float, imperfections: Imperfections, generator: np.random.Generator) -> FloatArray:
    """What the clock writes for readings at the times `read`, shape (n,) [s]; the same shape, strictly increasing [s].

    Readings of a bunch bear the time of its last, each a tick after the one before.
    """
    order = np.arange(read.size)
    last = np.minimum((order // imperfections.bunch + 1) * imperfections.bunch, read.size) - 1
    written = (read + imperfections.stamp_error / rate * generator.standard_normal(read.size))[last]
    ticks = np.rint(np.maximum(written, 0.0) / TICK).astype(np.int64)
    # each at least a tick after the largest before: n_i − i must not decrease
    increasing: FloatArray = (np.maximum.accumulate(ticks - order) + order).astype(np.float64)
    return increasing * TICK


def coloured(read: FloatArray, correlation_time: float, generator: np.random.Generator) -> FloatArray:
    """Stationary first-order autoregressive noise of variance 1 at the times `read`, shape (n,) [s]; the same shape."""
    white = generator.standard_normal(read.size)
    if correlation_time == 0.0:
        return white
    kept = np.exp(-np.diff(read) / correlation_time)
    made = white.copy()
    for i, share in enumerate(kept.tolist(), 1):
        made[i] = share * made[i - 1] + np.sqrt(1.0 - share * share) * white[i]
    return made


def dropouts(count: int, share: float, length: float, generator: np.random.Generator) -> NDArray[np.bool_]:
    """Which of `count` readings drop out: runs of the mean `length`, which make up `share` of all; never the first."""
    out, now = np.zeros(count, dtype=np.bool_), False
    begin = share / (length * (1.0 - share))
    for i, drawn in enumerate(generator.uniform(size=count).tolist()):
        now = i > 0 and (drawn >= 1.0 / length if now else drawn < begin)
        out[i] = now
    return out


def repeated(position: FloatArray, out: NDArray[np.bool_]) -> FloatArray:
    """The positions, shape (n,), each that is `out` replaced by the last before it that is not [m]."""
    return position[np.maximum.accumulate(np.where(out, 0, np.arange(position.size)))]


def worn_steps(position: FloatArray, worn: Sequence[WornPlace]) -> FloatArray:
    """What a worn track adds at s, any shape [m]; the same shape [m]."""
    return sum(
        (np.where((position >= one.start) & (position < one.end), one.step, 0.0) for one in worn),
        np.zeros_like(position),
    )


def wandering(time: FloatArray, imperfections: Imperfections, phase: float) -> FloatArray:
    """Error of the recorded angle, shape (n,) [rad]: a slow sine from 0 at t = 0."""
    turned = 2.0 * np.pi * time / imperfections.drift_period + phase
    return imperfections.drift * (np.sin(turned) - np.sin(phase))
