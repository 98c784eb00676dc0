"""Errors of a fitted model over windows, of each of which it knows the beginning only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window

_DENSITIES = 10.0 ** np.arange(-9.0, -1.0)  # of the process noise that are tried [m²/s³]


def window_error(problem: Problem, found: Fit, window: Window) -> float:
    """RMS error over the judged part of a window [m]."""
    reading = np.full_like(window.recording.reading, np.nan)
    reading[window.use] = np.where(window.known, window.reading, np.nan)
    return window.rms_error(filtered(problem, found, window.recording, reading).recorded[window.use])


def window_errors(problem: Problem, found: Fit, windows: Sequence[Window]) -> list[float]:
    """RMS error of every window [m]."""
    return [window_error(problem, found, one) for one in windows]


def tuned_to_windows(problem: Problem, found: Fit, seen: Sequence[Window]) -> Fit:
    """The same fit with the process noise that predicts the windows `seen` best.

    The likeliest process noise for the next reading need not be the best for the next seconds, where model or sensor
    errs in a way that is not white.
    """
    tried = [found, *(replace(found, process_noise=float(process_noise)) for process_noise in _DENSITIES)]
    return min(tried, key=lambda one: sum(error**2 for error in window_errors(problem, one, seen)))
