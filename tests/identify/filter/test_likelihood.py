"""The filter's likelihood is that of the readings under the posterior of the angle, computed densely."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.models import CAM, coefficients
from analytic.rig import Rig
from analytic.slots import ECCENTRIC, GRAVITY, LINEAR
from harness.identify.filter.any_state import any_state
from harness.identify.filter.arguments import (
    VELOCITY_VARIANCE,
    BeamTable,
    FilterOutput,
    Memory,
    Readings,
    Sensor,
)
from harness.identify.filter.ekf import negative_two_log_likelihood
from harness.identify.filter.usual_state import usual_state
from harness.signals import smooth
from harness.signals.error_process import error_process
from tests.signals.dense_posterior import posterior_covariance

pytestmark = pytest.mark.slow

READING, ANGLE = 2e-4, 4e-4  # standard deviations [m], [rad]


@pytest.mark.parametrize("form", [usual_state, any_state])
@pytest.mark.parametrize("process_noise", [0.0, 1e-6])
def test_the_likelihood_is_the_dense_one(form, process_noise: float) -> None:
    """Give −2 log of the density of all readings, in whose covariance are angle error, process and sensor noise."""
    generator = np.random.default_rng(4)
    n = 24
    time = np.cumsum(generator.uniform(0.005, 0.03, n))
    variance, density = np.full(n, ANGLE**2), np.exp(np.linspace(-6.0, 1.0, n - 1))
    variance[[7, 8]] = np.inf
    error = error_process(smooth(time, np.zeros(n), variance, density), variance)
    p = coefficients(CAM, Rig())
    p[LINEAR] = 1.0
    response = p[GRAVITY]

    # Positions are linear in the start, the errors and the process noise: one row for each stamp.
    errors = 3 * n
    noises = np.zeros((n, 2 + errors + 2 * (n - 1)))
    speeds = np.zeros_like(noises)
    noises[0, 0], speeds[0, 1] = 1.0, 1.0
    for k, h in enumerate(np.diff(time)):
        noises[k + 1], speeds[k + 1] = noises[k] + h * speeds[k], speeds[k]
        here = slice(2 + 3 * k, 5 + 3 * k)
        noises[k + 1, here] += response * h**2 * np.array([1 / 2, h / 6, h**2 / 24])
        speeds[k + 1, here] += response * h * np.array([1.0, h / 2, h**2 / 6])
        for column, change in ((3 + 3 * k, -1.0), (6 + 3 * k, 1.0)):  # of ė, for which the pivot throws the ball back
            noises[k + 1, column] -= p[ECCENTRIC] * 0.5 * h * change
            speeds[k + 1, column] -= p[ECCENTRIC] * change
        root = np.sqrt(process_noise * h) * np.array([[h / np.sqrt(3.0), 0.0], [np.sqrt(0.75), 0.5]])
        there = slice(2 + errors + 2 * k, 4 + errors + 2 * k)
        noises[k + 1, there] += root[0]
        speeds[k + 1, there] += root[1]
    prior = np.eye(noises.shape[1])
    prior[0, 0], prior[1, 1] = READING**2, VELOCITY_VARIANCE
    prior[2 : 2 + errors, 2 : 2 + errors] = posterior_covariance(time, variance, density).reshape(errors, errors)
    covariance = (noises @ prior @ noises.T)[1:, 1:] + READING**2 * np.eye(n - 1)
    position = np.concatenate(([0.0], np.linalg.cholesky(covariance) @ generator.standard_normal(n - 1)))
    position[5] = np.nan
    read = np.flatnonzero(np.isfinite(position))[1:] - 1
    chosen, values = covariance[np.ix_(read, read)], position[1:][read]
    dense = np.linalg.slogdet(chosen)[1] + values @ np.linalg.solve(chosen, values)

    beam = BeamTable(np.diff(time), np.arange(n), np.zeros((2 * n - 1, 3)))
    out = FilterOutput(np.zeros(n), np.ones(n), np.empty((n, 4)), np.empty(n))
    form(
        Readings(time, position),
        beam,
        p,
        Sensor(1.0, 0.0, READING**2),
        process_noise,
        error,
        True,
        Memory.blank(error),
        0,
        np.empty((3, 3)),
        out,
    )
    found = negative_two_log_likelihood(out.innovation[1:][read], out.innovation_variance[1:][read])
    # The model is linear; slopes by differences of 1e-6 carry a rounding of 1e-10, the smoother's covariance an error
    # of 1e-5 of its own size (`test_spline_smoother`), and each reading counts it once.
    assert found == pytest.approx(dense, abs=1e-5 * n)
    without = negative_two_log_likelihood(values, np.diag(chosen))
    assert abs(without - dense) > 1.0  # the test would notice a likelihood that leaves correlations out
