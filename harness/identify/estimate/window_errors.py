"""Prediction errors of a fitted model over windows, of which it knows the first part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window

_DENSITIES = 10.0 ** np.arange(-9.0, -1.0)  # grid of the process noise [m²/s³]


def window_error(problem: Problem, found: Fit, window: Window) -> float:
    """RMS error over the predicted part of a window [m]."""
    reading = np.full_like(window.recording.reading, np.nan)
    reading[window.use] = np.where(window.known, window.reading, np.nan)
    return window.rms_error(filtered(problem, found, window.recording, reading).recorded[window.use])


def window_errors(problem: Problem, found: Fit, windows: Sequence[Window]) -> list[float]:
    """RMS error of every window [m]."""
    return [window_error(problem, found, window) for window in windows]


def tuned_to_windows(problem: Problem, found: Fit, windows: Sequence[Window]) -> Fit:
    """The same fit with the process noise that predicts `windows` best.

    Where errors of model or sensor are not white, the process noise of maximum likelihood, which is best for the next
    reading, is not the best for seconds.
    """
    fits = [found, *(replace(found, process_noise=float(density)) for density in _DENSITIES)]
    return min(fits, key=lambda fit: sum(error**2 for error in window_errors(problem, fit, windows)))
