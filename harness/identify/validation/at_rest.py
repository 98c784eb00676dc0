"""Predictions of the next second against a ball that stays where it was last read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered_ahead
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import HORIZONS, predicted_spans
from harness.numerics import rms

SPAN = HORIZONS[0]
"""Length of the predicted spans [s]."""


@dataclass(frozen=True)
class AgainstRest:
    """RMS errors over all spans of `SPAN`, each predicted from all readings before it.

    Attributes:
        model: of the model [m].
        at_rest: of a ball that stays at its last reading [m].
    """

    model: float
    at_rest: float

    @property
    def worse(self) -> bool:
        """Whether the model predicts worse."""
        return not self.model <= self.at_rest


def against_rest(problem: Problem, fitted: Fit) -> AgainstRest | None:
    """Errors of a fit on the recordings that it was fitted to; `None` where none is long enough to be predicted."""
    model, at_rest = [], []
    for recording in problem.recordings:
        known = np.isfinite(recording.reading)
        spans = predicted_spans(recording.time - recording.time[0], known)
        spans_of_length = [use for name, use in spans if name == f"{SPAN:g} s"]
        _, ahead = filtered_ahead(problem, fitted, recording, spans_of_length)
        for use, out in zip(spans_of_length, ahead, strict=True):
            reading = recording.reading[use][known[use]]
            model.append(out.recorded[known[use]] - reading)
            at_rest.append(recording.reading[: use.start][known[: use.start]][-1] - reading)
    if not model:
        return None
    return AgainstRest(rms(np.concatenate(model)), rms(np.concatenate(at_rest)))
