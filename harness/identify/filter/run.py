"""A recording, or all of a problem's, through the filter, with terms added to the baseline model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.effects import parameters_with
from analytic.models import ORIGIN
from analytic.motion import FloatArray
from harness.identify.filter.ekf import (
    BeamTable,
    Readings,
    Sensor,
    extended_kalman_filter,
    negative_two_log_likelihood,
)
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import PreparedRecording, Problem


@dataclass(frozen=True)
class FilterRun:
    """A recording through the filter.

    Attributes:
        innovation, innovation_variance: shape (n,) [m], [m²].
        state: filtered s [m], ṡ [m/s], what effects remember, and the lagging position [m], shape (n, 4).
        position_variance: of the position that the sensor sees, shape (n,) [m²].
        gain, lag: of the sensor [1], [s].
    """

    innovation: FloatArray
    innovation_variance: FloatArray
    state: FloatArray
    position_variance: FloatArray
    gain: float
    lag: float

    @property
    def recorded(self) -> FloatArray:
        """What the sensor would record of the filtered state, shape (n,) [m]."""
        return self.gain * self.state[:, 3 if self.lag > 0.0 else 0]


def dynamics(
    problem: Problem, recording: PreparedRecording, added: Terms, phase: float
) -> tuple[FloatArray, FloatArray]:
    """The kernel's vector, shape (SLOTS,), and the beam's table of one recording.

    Args:
        added: terms beside the known effects.
        phase: φ₀, how the ball lies at the recording's start, where it matters [rad].
    """
    every = (*problem.declared, *added.effects)
    p = parameters_with(problem.model, problem.rig, every, phase=phase)
    p[ORIGIN] = recording.origin / problem.sensor(added.effects)[0]
    table = recording.table_with(every)
    if added.spline is not None:
        added.spline.write(p, phase)
        table = added.spline.load(table, recording.times, problem.rig.gravity)
    return p, table


def run_filter(
    problem: Problem,
    recording: PreparedRecording,
    added: Terms,
    process_noise: float,
    *,
    phase: float | None = None,
    reading: FloatArray | None = None,
) -> FilterRun:
    """One recording through the filter.

    Args:
        added: terms beside the known effects.
        density: of the process noise [m²/s³].
        phase: φ₀ of the recording [rad]; by default as in the terms.
        reading: other readings than the recording's, shape (n,), NaN where there is none [m].
    """
    gain, lag = problem.sensor(added.effects)
    p, table = dynamics(problem, recording, added, added.phase_of(recording.name) if phase is None else phase)
    readings = Readings(recording.time, recording.reading if reading is None else reading)
    beam = BeamTable(recording.grid.steps, recording.grid.marks, table)
    return FilterRun(
        *extended_kalman_filter(readings, beam, p, Sensor(gain, lag, problem.reading_variance), process_noise),
        gain,
        lag,
    )


def innovations(problem: Problem, added: Terms, process_noise: float) -> tuple[FloatArray, FloatArray]:
    """Innovations over all recordings and their variances, both of shape (readings,) [m], [m²]."""
    runs = [(one, run_filter(problem, one, added, process_noise)) for one in problem.recordings]
    return (
        np.concatenate([run.innovation[one.judged] for one, run in runs]),
        np.concatenate([run.innovation_variance[one.judged] for one, run in runs]),
    )


def deviance(problem: Problem, added: Terms, process_noise: float) -> float:
    """−2 log likelihood of the innovations over all recordings, but for a constant."""
    return negative_two_log_likelihood(*innovations(problem, added, process_noise))


def deviance_of(
    problem: Problem,
    recording: PreparedRecording,
    added: Terms,
    process_noise: float,
    *,
    phase: float | None = None,
    reading: FloatArray | None = None,
) -> float:
    """The same of one recording; arguments as of `run_filter`."""
    run = run_filter(problem, recording, added, process_noise, phase=phase, reading=reading)
    use = recording.judged if reading is None else predicted(reading)
    return negative_two_log_likelihood(run.innovation[use], run.innovation_variance[use])


def predicted(reading: FloatArray) -> np.ndarray:
    """Which readings, shape (n,), are predicted: all known ones but the first, which starts the filter."""
    use = np.isfinite(reading)
    use[np.argmax(use)] = False
    return use
