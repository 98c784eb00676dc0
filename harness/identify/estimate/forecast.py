"""Positions from the angle alone: the filter runs on what is known and goes on where nothing is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import TWO_SIDED, Fit
from harness.identify.estimate.initial_phase import phase_of
from harness.identify.filter.run import FilterRun, run_filter
from harness.identify.problem.problem import PreparedRecording, Problem

_DRAWS = 48


@dataclass(frozen=True)
class Forecast:
    """What is predicted of one recording.

    Attributes:
        time: shape (n,) [s].
        position: what the sensor would record, shape (n,) [m]; where readings are known they are in it.
        deviation: its standard deviation: angle, start, and what the fit leaves open; shape (n,) [m].
        state: s [m] and ṡ [m/s], shape (n, 2).
    """

    time: FloatArray
    position: FloatArray
    deviation: FloatArray
    state: FloatArray

    def table(self) -> dict[str, FloatArray]:
        """`time_s, ball_position_m`, and the 95 % band `low_m, high_m`."""
        reach = TWO_SIDED * self.deviation
        low, high = self.position - reach, self.position + reach
        return {"time_s": self.time, "ball_position_m": self.position, "low_m": low, "high_m": high}


def filtered(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> FilterRun:
    """One recording under a fitted hypothesis, from other readings than its own; φ₀ is found from these."""
    phase = phase_of(problem, found, recording, reading)
    return run_filter(problem, recording, found.terms, found.process_noise, phase=phase, reading=reading)


def forecast(
    problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray, *, seed: int = 0
) -> Forecast:
    """Predict one recording from the readings that are known, shape (n,), NaN where none is [m].

    The band joins the filter's own, which grows with the angle's error, and the spread of runs with values drawn from
    what the fit leaves open.
    """
    best = filtered(problem, found, recording, reading)
    variance = best.position_variance * best.gain**2
    count = len(found.theta)
    if count:
        scale = found.hypothesis.scale(problem)
        root = problem.settings.inflation * _root(found.covariance / np.outer(scale, scale))
        low, high = found.hypothesis.bounds(problem)
        generator = np.random.default_rng(seed)
        square = np.zeros(len(recording.time))
        phase = phase_of(problem, found, recording, reading)
        for _ in range(_DRAWS):
            theta = np.clip(found.theta + root @ generator.standard_normal(count), low, high)
            at = found.hypothesis.terms(theta, problem)
            drawn = run_filter(problem, recording, at, found.process_noise, phase=phase, reading=reading)
            square += (drawn.recorded - best.recorded) ** 2
        variance = variance + square / _DRAWS
    return Forecast(recording.time, best.recorded, np.sqrt(variance), best.state[:, :2])


def _root(covariance: FloatArray) -> FloatArray:
    """Its symmetric root; a badly determined fit has a covariance with eigenvalues just below zero, taken for zero."""
    values, vectors = np.linalg.eigh(covariance)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
