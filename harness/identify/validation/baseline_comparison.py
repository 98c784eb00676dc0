"""Comparison of the model with the baselines: all predict the same 3 s from the same 2 s of held-out recordings.

The process noise of the model's filter is tuned to the windows of the fit (`tuned_to_windows`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.window_errors import tuned_to_windows, window_errors
from harness.identify.problem.windows import windows_of
from harness.identify.validation.baselines import fit_double_integrator, fit_output_error
from harness.identify.validation.held_out import HeldOut
from harness.metrics.bootstrap import Margin, rms_reduction
from harness.numerics import rms
from harness.progress import Progress, silent

BEFORE, AFTER = "before", "after"
INTEGRATOR, BLACK_BOX = "double_integrator", "output_error"
BASELINES = (INTEGRATOR, BLACK_BOX)
_FEWEST = 4  # windows for an interval of a difference


@dataclass(frozen=True)
class BaselineComparison:
    """RMS error of every window by source (before, after, and the baselines), shape (windows,) each [m]."""

    errors: Mapping[str, FloatArray]

    @property
    def windows(self) -> int:
        """Number of windows."""
        return len(self.errors[AFTER])

    def rms(self, source: str) -> float:
        """RMS error of a source over all windows, equally weighted [m]."""
        return rms(self.errors[source])

    def margin(self, baseline: str) -> Margin | None:
        """Reduction of the RMS error from a baseline to the model after [m]; `None` for too few windows."""
        return None if self.windows < _FEWEST else rms_reduction(self.errors[baseline], self.errors[AFTER])

    def won(self, baseline: str) -> int:
        """Number of windows that the model after predicts better than a baseline."""
        return int(np.sum(self.errors[AFTER] < self.errors[baseline]))


def compare_with_baselines(held: Sequence[HeldOut], progress: Progress = silent) -> BaselineComparison | None:
    """Errors of the model, before and after, and of the baselines on held-out windows; `None` without any window."""
    errors: dict[str, list[float]] = {name: [] for name in (BEFORE, AFTER, *BASELINES)}
    for split in held:
        fitted, held_out = windows_of(split.problem.recordings), windows_of(split.compared)
        if not fitted or not held_out:
            continue
        progress(f"baselines: {', '.join(recording.name for recording in split.compared)}")
        before = window_errors(split.problem, tuned_to_windows(split.problem, split.base, fitted), held_out)
        same = split.found.hypothesis == split.base.hypothesis
        errors[BEFORE] += before
        found = split.found if same else tuned_to_windows(split.problem, split.found, fitted)
        errors[AFTER] += before if same else window_errors(split.problem, found, held_out)
        for name, baseline in zip(BASELINES, (fit_double_integrator(fitted), fit_output_error(fitted)), strict=True):
            errors[name] += [window.rms_error(baseline.predict(window)) for window in held_out]
    if not errors[AFTER]:
        return None
    return BaselineComparison({name: np.array(values) for name, values in errors.items()})
