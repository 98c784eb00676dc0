"""Comparison of the model with the baselines: all predict the same 3 s from the same 2 s of held-out recordings.

The process noise of the model's filter is tuned on the windows that everything is fitted to (`tuned_to_windows`).
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
_LEAST = 4  # windows from which a difference can be judged


@dataclass(frozen=True)
class BaselineComparison:
    """RMS error of every window by source, each of shape (windows,) [m]: before, after, and the baselines."""

    errors: Mapping[str, FloatArray]

    @property
    def windows(self) -> int:
        """How many were predicted."""
        return len(self.errors[AFTER])

    def rms(self, source: str) -> float:
        """Over all windows, which count alike [m]."""
        return rms(self.errors[source])

    def margin(self, baseline: str) -> Margin | None:
        """By how much the model with what was found is better; `None` for too few windows."""
        return None if self.windows < _LEAST else rms_reduction(self.errors[baseline], self.errors[AFTER])

    def won(self, baseline: str) -> int:
        """Windows that the model with what was found predicts better."""
        return int(np.sum(self.errors[AFTER] < self.errors[baseline]))


def compare_with_baselines(held: Sequence[HeldOut], progress: Progress = silent) -> BaselineComparison | None:
    """Let the model, before and after, and the baselines predict what was held out; `None` if that has no window.

    Args:
        held: fits to a part of the recordings, and the rest of them.
    """
    errors: dict[str, list[float]] = {name: [] for name in (BEFORE, AFTER, *BASELINES)}
    for split in held:
        seen, ahead = windows_of(split.problem.recordings), windows_of(split.left)
        if not seen or not ahead:
            continue
        progress(f"baselines for {', '.join(recording.name for recording in split.left)}")
        before = window_errors(split.problem, tuned_to_windows(split.problem, split.base, seen), ahead)
        same = split.found.hypothesis == split.base.hypothesis
        errors[BEFORE] += before
        found = split.found if same else tuned_to_windows(split.problem, split.found, seen)
        errors[AFTER] += before if same else window_errors(split.problem, found, ahead)
        for name, baseline in zip(BASELINES, (fit_double_integrator(seen), fit_output_error(seen)), strict=True):
            errors[name] += [window.rms_error(baseline.predict(window)) for window in ahead]
    if not errors[AFTER]:
        return None
    return BaselineComparison({name: np.array(each) for name, each in errors.items()})
