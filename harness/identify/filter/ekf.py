"""Innovations of a model with effects: an extended Kalman filter on the ball and the angle's error, compiled.

The state is (s, ṡ) and the error (e, ė, ë) of the beam's angle, a Gauss–Markov process that follows from how the angle
was smoothed (`harness.signals.error_process`); it is extended by what else that goes on from where the beam lags, by
the internal state of slip or Dahl friction, by the output of a lagging sensor and by the coloured part of its noise.
White process noise on ṡ represents what the model leaves unexplained. Innovations of a complete model are white
(Kailath, IEEE Trans. Automatic Control 13, 1968); those beyond four standard deviations are down-weighted (Masreliez
and Martin, IEEE TAC 22, 1977).

An innovation e with innovation variance S = H P Hᵀ + R and |e| > 4 √S has the weight w = 4 √S/|e|: the correction of
the state and the reduction of the covariance, P − w P Hᵀ H P/S, are w times the usual ones. This is the usual update
with the larger reading variance R' = S/w − H P Hᵀ = R + S (1/w − 1) >= R, so P stays positive semidefinite. To keep
this in floating point, the filter propagates a triangular root of P (Bierman, "Factorization Methods for Discrete
Sequential Estimation", 1977).
"""

from __future__ import annotations

import numpy as np

from analytic.compiled import njit
from analytic.motion import FloatArray
from analytic.slots import DAHL, TRACTION
from harness.identify.filter.any_state import any_state
from harness.identify.filter.arguments import SPIKE, BeamTable, FilterOutput, Memory, Readings, Sensor
from harness.identify.filter.usual_state import usual_state
from harness.signals.error_process import ErrorProcess


def extended_kalman_filter(
    readings: Readings,
    beam: BeamTable,
    p: FloatArray,
    sensor: Sensor,
    process_noise: float,
    error: ErrorProcess,
    points: bool = True,
    *,
    memory: Memory | None = None,
    use: slice = slice(None),
) -> FilterOutput:
    """Innovations, states and their variances of one recording.

    Args:
        readings: of the position.
        beam: its motion on the integration grid.
        p: kernel's vector with effects, shape (SLOTS,) or longer where force laws follow.
        sensor: of the position.
        process_noise: density of the process noise [m²/s³].
        error: of the beam's angle at the stamps.
        points: whether steps to a reading in which dry friction may stop the ball are taken at points.
        memory: what the filter knows before the stamps `use`, and after them when it returns; nothing by default.
        use: consecutive stamps to run over; the output is of these.
    """
    first, last, _ = use.indices(len(readings.time))
    memory = Memory.blank(error) if memory is None else memory
    return FilterOutput(*_filtered(readings, beam, p, sensor, process_noise, error, points, memory, first, last))


@njit(cache=True)
def _filtered(
    readings: Readings,
    beam: BeamTable,
    p: FloatArray,
    sensor: Sensor,
    process_noise: float,
    error: ErrorProcess,
    points: bool,
    memory: Memory,
    first: int,
    last: int,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """The fields of `FilterOutput`.

    As a plain tuple: to make a named one, compiled code would call Python, and crash where a signal raises there.
    """
    n = last - first
    out = FilterOutput(np.zeros(n), np.ones(n), np.empty((n, 4)), np.empty(n))
    local = np.empty((3, beam.table.shape[1]))  # what is borrowed needs an owner that outlives it
    usual = p[TRACTION] == 0.0 and p[DAHL] == 0.0 and sensor.lag <= 0.0 and sensor.colour <= 0.0
    if usual and error.transition.shape[1] == 3:
        usual_state(readings, beam, p, sensor, process_noise, error, points, memory, first, local, out)
    else:
        any_state(readings, beam, p, sensor, process_noise, error, points, memory, first, local, out)
    return out.innovation, out.innovation_variance, out.state, out.position_variance


def penalty(ratio: FloatArray) -> FloatArray:
    """Robust penalty ρ of normalised innovations: squares up to 4, then linear (Huber), same shape."""
    size = np.abs(ratio)
    squared = np.minimum(size, SPIKE)
    return squared * (2.0 * size - squared)


def negative_two_log_likelihood(innovation: FloatArray, innovation_variance: FloatArray | float) -> float:
    """Deviance Σ [log S + ρ(e/√S)] of innovations e, shape (n,) [m], with variances S [m²]."""
    ratio = innovation / np.sqrt(innovation_variance)
    return float(np.sum(np.log(innovation_variance) + penalty(ratio)))
