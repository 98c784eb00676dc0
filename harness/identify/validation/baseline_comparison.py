"""Is the model better than the yardsticks? All predict the same 3 s from the same 2 s, of pieces that none has seen.

The model's filter, too, knows only the two seconds before a window. How far it trusts its own law within these is its
process noise; the likeliest for the next reading need not be the best for the next seconds, where the model or the
sensor errs in a way that is not white. For this contest it is chosen on the pieces that everything is fitted to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered
from harness.identify.problem.problem import Problem
from harness.identify.validation.baselines import Window, fit_double_integrator, fit_output_error, windows_of
from harness.identify.validation.held_out import Split
from harness.progress import Progress, silent

BEFORE, AFTER = "before", "after"
INTEGRATOR, BLACK_BOX = "double_integrator", "output_error"
YARDSTICKS = (INTEGRATOR, BLACK_BOX)
_LEAST = 4  # windows from which a difference can be judged
_RESAMPLES = 9999
_DENSITIES = 10.0 ** np.arange(-9.0, -1.0)  # of the process noise that are tried [m²/s³]


@dataclass(frozen=True)
class Margin:
    """By how much one is better than another: difference of RMS errors, with its interval [m]."""

    value: float
    low: float
    high: float

    @property
    def sure(self) -> bool:
        """Whether it is better beyond what the choice of windows may do."""
        return self.low > 0.0


@dataclass(frozen=True)
class Contest:
    """RMS error of every window by contender, each of shape (windows,) [m]: before, after, and the yardsticks."""

    misses: Mapping[str, FloatArray]

    @property
    def windows(self) -> int:
        """How many were predicted."""
        return len(self.misses[AFTER])

    def rms(self, contender: str) -> float:
        """Over all windows, which count alike [m]."""
        return float(_rms(self.misses[contender]))

    def margin(self, yardstick: str) -> Margin | None:
        """By how much the model with what was found is better; `None` for too few windows."""
        return None if self.windows < _LEAST else margin(self.misses[yardstick], self.misses[AFTER])

    def won(self, yardstick: str) -> int:
        """Windows that the model with what was found predicts better."""
        return int(np.sum(self.misses[AFTER] < self.misses[yardstick]))


def margin(before: FloatArray, after: FloatArray, chance: float = 0.05) -> Margin:
    """By how much errors of the same windows, shape (windows,) [m], are less `after`.

    The interval is a paired bootstrap's over windows (Efron and Tibshirani, An Introduction to the Bootstrap, 1993,
    chapter 13): windows differ much more among themselves than contenders do on one window.

    Args:
        chance: two-sided share of what the interval leaves out [1].
    """
    drawn = np.random.default_rng(0).integers(len(before), size=(_RESAMPLES, len(before)))
    low, high = np.percentile(_rms(before[drawn]) - _rms(after[drawn]), (50.0 * chance, 100.0 - 50.0 * chance))
    return Margin(float(_rms(before) - _rms(after)), float(low), float(high))


def contest(held: Sequence[Split], progress: Progress = silent) -> Contest | None:
    """Let the model, before and after, and the yardsticks predict what was held out; `None` if that has no window.

    Args:
        held: fits to a part of the recordings, and the rest of them.
    """
    misses: dict[str, list[float]] = {name: [] for name in (BEFORE, AFTER, *YARDSTICKS)}
    for split in held:
        seen, ahead = windows_of(split.problem.records), windows_of(split.left)
        if not seen or not ahead:
            continue
        progress(f"yardsticks for {', '.join(record.name for record in split.left)}")
        before = missed(split.problem, for_horizon(split.problem, split.base, seen), ahead)
        same = split.found.hypothesis == split.base.hypothesis
        misses[BEFORE] += before
        found = split.found if same else for_horizon(split.problem, split.found, seen)
        misses[AFTER] += before if same else missed(split.problem, found, ahead)
        for name, yardstick in zip(YARDSTICKS, (fit_double_integrator(seen), fit_output_error(seen)), strict=True):
            misses[name] += [window.miss(yardstick.predict(window)) for window in ahead]
    if not misses[AFTER]:
        return None
    return Contest({name: np.array(each) for name, each in misses.items()})


def missed(problem: Problem, one: Fit, ahead: Sequence[Window]) -> list[float]:
    """RMS error of the model in each window [m]."""
    return [miss(problem, one, window) for window in ahead]


def miss(problem: Problem, found: Fit, window: Window) -> float:
    """RMS error of the model in a window of which it knows the beginning only [m]."""
    reading = np.full_like(window.record.reading, np.nan)
    reading[window.use] = np.where(window.known, window.reading, np.nan)
    return window.miss(filtered(problem, found, window.record, reading).recorded[window.use])


def for_horizon(problem: Problem, found: Fit, seen: Sequence[Window]) -> Fit:
    """The same fit with the process noise that predicts the windows of its own recordings best."""
    tried = [found, *(replace(found, density=float(density)) for density in _DENSITIES)]
    return min(tried, key=lambda one: sum(miss(problem, one, window) ** 2 for window in seen))


def _rms(misses: FloatArray, axis: int = -1) -> Any:
    return np.sqrt(np.mean(np.square(misses), axis=axis))
