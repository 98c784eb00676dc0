"""Prediction of positions from the angle: the filter uses the known readings and runs on without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.drawn import drawn_terms
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.own_values import estimates_own, own_deviations, own_of
from harness.identify.filter.run import FilterRun, run_ahead, run_filter
from harness.identify.problem.hypothesis import Own
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.numerics import TWO_SIDED

_DRAWS = 48  # Monte Carlo draws of the parameters


@dataclass(frozen=True)
class Forecast:
    """Prediction of one recording.

    Attributes:
        time: stamps, shape (n,) [s].
        position: predicted reading, filtered where readings are known, within the travel of the fit, shape (n,) [m].
        deviation: its standard deviation by the band of the fit, shape (n,) [m].
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
    """Run the filter of a fit over a recording with these readings, shape (n,) [m], which also give its own values."""
    own = own_of(problem, found, recording, reading)
    return run_filter(problem, recording, found.terms, found.process_noise, own=own, reading=reading)


def filtered_ahead(
    problem: Problem, found: Fit, recording: PreparedRecording, spans: Sequence[slice]
) -> tuple[FilterRun, list[FilterRun]]:
    """The filter of a fit over a recording, and over each of some spans from the readings before it, without its own.

    Where the recording was not fitted, the readings before a span also give the recording's own values.

    Args:
        spans: consecutive stamps each, with a begin and an end.

    Returns:
        The run over all stamps, and one over the stamps of each span.
    """
    own = own_of(problem, found, recording, recording.reading)
    if not estimates_own(found, recording):
        return run_ahead(problem, recording, found.terms, found.process_noise, spans, own=own)
    ahead: dict[int, FilterRun] = {}
    for begin in {span.start for span in spans}:
        before = np.where(np.arange(len(recording.time)) < begin, recording.reading, np.nan)
        then = own_of(problem, found, recording, before)
        same = [i for i, span in enumerate(spans) if span.start == begin]
        runs = run_ahead(problem, recording, found.terms, found.process_noise, [spans[i] for i in same], own=then)[1]
        ahead |= dict(zip(same, runs, strict=True))
    whole = run_filter(problem, recording, found.terms, found.process_noise, own=own)
    return whole, [ahead[i] for i in range(len(spans))]


def forecast(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> Forecast:
    """Predict one recording from the known readings, shape (n,), NaN where missing [m].

    The variance is that of the filter plus that of runs with parameters drawn from the covariance of the fit, and what
    the recording has of its own from its deviations; the deviation follows from it and the time since the last reading
    by the band of the fit. Positions are kept within the travel of the fit and what is known of the recording; their
    deviation is that of a free ball.
    """
    own = own_of(problem, found, recording, reading)
    best = run_filter(problem, recording, found.terms, found.process_noise, own=own, reading=reading)
    apart = own_deviations(problem, found, recording, reading, own)
    generator = np.random.default_rng(0)  # so that it is the same again
    square, drawn = np.zeros(len(recording.time)), 0
    for terms in drawn_terms(problem, found, _DRAWS, generator):
        each = Own(
            generator.normal(own.phase, apart.phase),
            {name: generator.normal(value, apart.values[name]) for name, value in own.values.items()},
        )
        run = run_filter(problem, recording, terms, found.process_noise, own=each, reading=reading)
        square += (run.recorded - best.recorded) ** 2
        drawn += 1
    foreseen = best.recorded_variance + square / max(drawn, 1)
    variance = found.band.variance(foreseen, _since_reading(recording.time, reading))
    position = found.travel.kept(best.recorded, reading)
    return Forecast(recording.time, position, np.sqrt(variance), best.state[:, :2])


def _since_reading(time: FloatArray, reading: FloatArray) -> FloatArray:
    """Time since the last reading, or since the first stamp before there is one, shape (n,) [s]."""
    latest = np.maximum.accumulate(np.where(np.isfinite(reading), time, time[0]))
    return np.asarray(time - latest)
