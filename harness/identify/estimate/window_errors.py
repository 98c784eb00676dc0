"""Prediction errors of a fitted model over windows, of which it knows the first part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.band import Foreseen
from harness.identify.estimate.drawn import drawn_terms
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.own_values import own_of
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.run import Excerpt, FilterRun, run_parts
from harness.identify.problem.hypothesis import Own
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window
from harness.numerics import rms

_DRAWS = 24  # of the parameters: a standard deviation within 15 %, and that of a block's readings closer
FARTHEST = 100.0  # of a prediction [m]
DENSITIES = 10.0 ** np.arange(-8.0, -1.0)  # grid of the process noise [m²/s³]


def window_errors(problem: Problem, found: Fit, windows: Sequence[Window]) -> list[float]:
    """RMS error over the predicted part of every window [m].

    The filter runs over the known part and on without readings.
    """
    return [rms(errors) for errors in forecast_errors(problem, found, windows)]


def forecast_errors(problem: Problem, found: Fit, windows: Sequence[Window]) -> list[FloatArray]:
    """Prediction − reading in the predicted part of every window, shape (its readings,) each [m]."""
    runs = _runs(problem, found, windows, _own_of_windows(problem, found, windows))
    return [
        (_kept(found, run, window) - window.reading)[window.judged] for window, run in zip(windows, runs, strict=True)
    ]


def foreseen_errors(problem: Problem, found: Fit, windows: Sequence[Window]) -> Foreseen:
    """Errors of the predicted parts of all windows, and the variances that a forecast foresees.

    They are those of the filter and of the parameters, without `Fit.band`, which follows from these errors.
    """
    own = _own_of_windows(problem, found, windows)
    runs = _runs(problem, found, windows, own)
    variances = [np.nan_to_num(run.recorded_variance) for run in runs]
    for terms in drawn_terms(problem, found, _DRAWS, np.random.default_rng(0)):
        drawn = _runs(problem, replace(found, terms=terms), windows, own)
        for variance, one, other in zip(variances, drawn, runs, strict=True):
            variance += (bounded(one.recorded) - bounded(other.recorded)) ** 2 / _DRAWS
    errors = [_kept(found, run, window) - window.reading for window, run in zip(windows, runs, strict=True)]
    ahead = [window.time - window.time[window.known][-1] for window in windows]

    def judged(each: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([one[window.judged] for window, one in zip(windows, each, strict=True)])

    return Foreseen(judged(errors), judged(variances), judged(ahead))


def _own_of_windows(problem: Problem, found: Fit, windows: Sequence[Window]) -> list[Own | None]:
    """What the recording of each window has of its own, estimated from the window's known part.

    `None` where the fit has it, or there is nothing of the kind.
    """
    fitted = set(found.terms.recordings)
    return [
        own_of(problem, found, window.recording, _known_of(window))
        if found.hypothesis.own and window.recording.name not in fitted
        else None
        for window in windows
    ]


def _runs(problem: Problem, found: Fit, windows: Sequence[Window], own: Sequence[Own | None]) -> list[FilterRun]:
    """Filter runs over the known part of each window and on."""
    runs: dict[int, FilterRun] = {}
    by_recording: dict[int, list[int]] = {}
    for i, window in enumerate(windows):
        by_recording.setdefault(id(window.recording), []).append(i)
    model = Dynamics(problem, found.terms)
    for places in by_recording.values():
        recording = windows[places[0]].recording
        parts = [Excerpt(windows[i].use, np.where(windows[i].known, windows[i].reading, np.nan)) for i in places]
        if all(own[i] is None for i in places):
            done = run_parts(model, recording, found.process_noise, parts)
        else:
            done = [
                run_parts(model, recording, found.process_noise, [part], own=own[i])[0]
                for i, part in zip(places, parts, strict=True)
            ]
        runs |= dict(zip(places, done, strict=True))
    return [runs[i] for i in range(len(windows))]


def _kept(found: Fit, run: FilterRun, window: Window) -> FloatArray:
    """Predictions of a window, within the travel of the fit, shape (m,) [m]."""
    # What comes to no number stays far away: it is no prediction of the end.
    return bounded(found.travel.kept(run.recorded, window.reading[window.known]))


def bounded(predicted: FloatArray) -> FloatArray:
    """Predictions, those set to a bound of 100 that leave any beam or come to no number; same shape and unit."""
    return np.clip(np.nan_to_num(predicted, nan=FARTHEST), -FARTHEST, FARTHEST)


def _known_of(window: Window) -> FloatArray:
    """Readings of the known part among the stamps of the whole recording, shape (n,) [m]."""
    reading = np.full_like(window.recording.reading, np.nan)
    reading[window.use] = np.where(window.known, window.reading, np.nan)
    return reading


def errors_by_density(problem: Problem, found: Fit, windows: Sequence[Window]) -> FloatArray:
    """`window_errors` at each of `DENSITIES` of the process noise, shape (densities, windows) [m].

    At each of them what the recordings have of their own is estimated anew, as a forecast with that density would.
    """
    fits = (replace(found, process_noise=float(density)) for density in DENSITIES)
    return np.array([window_errors(problem, fit, windows) for fit in fits])


def tuned_to_windows(problem: Problem, found: Fit, windows: Sequence[Window]) -> Fit:
    """The same fit with the process noise that predicts `windows` best.

    Where errors of model or sensor are not white, the process noise of maximum likelihood, which is best for the next
    reading, is not the best for seconds.
    """
    fits = [found, *(replace(found, process_noise=float(density)) for density in DENSITIES)]
    return min(fits, key=lambda fit: sum(error**2 for error in window_errors(problem, fit, windows)))
