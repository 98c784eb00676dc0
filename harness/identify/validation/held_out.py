"""Prediction errors before and after, without and with the identified terms, on recordings fitted to or held out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered_ahead
from harness.identify.estimate.refit import refit
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import folds, predicted_spans
from harness.identify.validation.beam_dependence import Dependence, beam_dependence, joined
from harness.progress import Progress, silent


@dataclass(frozen=True)
class Errors:
    """Prediction errors and tests of the innovations.

    Attributes:
        rms: RMS error by horizon ("1 s" …, "whole") [m].
        innovation_correlation: lag-1 autocorrelation of the normalised innovations, near 0 for a complete model [1].
        innovation_over_noise: RMS innovation over the standard deviation of a reading, near 1 at best [1].
        beam: dependence of the innovations on the beam's past "angle", "rate" and "acceleration".
    """

    rms: Mapping[str, float]
    innovation_correlation: float
    innovation_over_noise: float
    beam: Mapping[str, Dependence] = field(default_factory=dict)


def errors(
    problem: Problem, found: Fit, recordings: Sequence[PreparedRecording], progress: Progress = silent
) -> Errors:
    """Prediction errors of `found` over `recordings`.

    "3 s" is the RMS over all spans of 3 s, each predicted from all readings before it; "whole" is the rest of the
    recording predicted from its known part, two seconds or half of a short recording.
    """
    squares: dict[str, list[FloatArray]] = {}
    correlations, variance_ratios, beam = [], [], []
    for recording in recordings:
        progress(f"prediction errors: {recording.name}")
        time = recording.time - recording.time[0]
        known = np.isfinite(recording.reading)
        spans = predicted_spans(time, known)
        one_step, ahead = filtered_ahead(problem, found, recording, [use for _, use in spans])
        for (name, use), out in zip(spans, ahead, strict=True):
            squares.setdefault(name, []).append((out.recorded - recording.reading[use])[known[use]] ** 2)
        normalised = one_step.innovation / np.sqrt(one_step.innovation_variance)
        z = normalised[recording.judged]
        correlations.append(float(np.mean(z[1:] * z[:-1]) / np.mean(z**2)))
        variance_ratios.append(float(np.mean(one_step.innovation[recording.judged] ** 2) / problem.reading_variance))
        beam.append(beam_dependence(recording.time, normalised, recording.judged, recording.drive))
    rms = {name: float(np.sqrt(np.mean(np.concatenate(each)))) for name, each in squares.items()}
    return Errors(rms, float(np.mean(correlations)), float(np.sqrt(np.mean(variance_ratios))), joined(beam))


@dataclass(frozen=True)
class BeforeAfter:
    """Errors without and with the identified terms."""

    before: Errors
    after: Errors


_UNKNOWN = Errors({}, math.nan, math.nan)
UNKNOWN = BeforeAfter(_UNKNOWN, _UNKNOWN)
"""In place of errors that could not be computed."""


def on_identify(problem: Problem, base: Fit, found: Fit, progress: Progress) -> BeforeAfter:
    """Errors on the recordings that were fitted to."""
    return BeforeAfter(
        errors(problem, base, problem.recordings, progress), errors(problem, found, problem.recordings, progress)
    )


def on_another(
    problem: Problem, base: Fit, found: Fit, recording: PreparedRecording, progress: Progress
) -> BeforeAfter:
    """Errors on a recording that nothing was fitted to."""
    return BeforeAfter(errors(problem, base, (recording,), progress), errors(problem, found, (recording,), progress))


@dataclass(frozen=True)
class HeldOut:
    """Fits to some recordings, and recordings, held-out ones or the same, with which predictions are compared.

    Attributes:
        problem: the recordings fitted to.
        base, found: fits to them, without and with the identified terms.
        compared: recordings to predict.
    """

    problem: Problem
    base: Fit
    found: Fit
    compared: tuple[PreparedRecording, ...]


def fit_folds(problem: Problem, base: Fit, found: Fit, progress: Progress = silent) -> tuple[HeldOut, ...]:
    """Both hypotheses fitted anew without each recording in turn; for a single recording, without each half."""
    held = []
    for fold in folds(problem):
        progress(f"fit with {fold.title} held out")
        rest = fold.problem
        held.append(HeldOut(rest, refit(rest, base), refit(rest, found), fold.left))
    return tuple(held)


def on_held_out(parts: Sequence[HeldOut]) -> BeforeAfter:
    """Errors on held-out recordings, averaged over the folds."""
    return BeforeAfter(
        _mean([errors(part.problem, part.base, part.compared) for part in parts]),
        _mean([errors(part.problem, part.found, part.compared) for part in parts]),
    )


def _mean(parts: Sequence[Errors]) -> Errors:
    names = dict.fromkeys(name for part in parts for name in part.rms)
    rms = {name: float(np.sqrt(np.mean([part.rms[name] ** 2 for part in parts if name in part.rms]))) for name in names}
    return Errors(
        rms,
        float(np.mean([part.innovation_correlation for part in parts])),
        float(np.sqrt(np.mean([part.innovation_over_noise**2 for part in parts]))),
        joined(part.beam for part in parts),
    )
