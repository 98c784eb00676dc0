"""Before and after: how far predictions are off without and with what was found, on data that did not find it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.forecast import filtered
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import folds, horizon_spans
from harness.identify.validation.whiteness import Dependence, beam_dependence, joined
from harness.progress import Progress, silent


@dataclass(frozen=True)
class Errors:
    """RMS errors [m] by horizon ("1 s" …, "whole"), and what the innovations still know.

    Attributes:
        rms: by horizon.
        whiteness: correlation of neighbouring innovations, near 0 for a right model [1].
        ratio: RMS of innovations over the reading's noise, near 1 at the floor [1].
        beam: how innovations go with the beam's "angle", "rate" and "acceleration" before them.
    """

    rms: Mapping[str, float]
    whiteness: float
    ratio: float
    beam: Mapping[str, Dependence] = field(default_factory=dict)


def errors(
    problem: Problem, found: Fit, recordings: Sequence[PreparedRecording], progress: Progress = silent
) -> Errors:
    """Prediction errors of `found` over `recordings`.

    "3 s" is the RMS over all windows of 3 s, each predicted from everything known before it; "whole" is the rest of the
    recording predicted from its first two seconds.
    """
    squares: dict[str, list[FloatArray]] = {}
    white, ratios, beam = [], [], []
    for recording in recordings:
        progress(f"errors of {recording.name}")
        time = recording.time - recording.time[0]
        known = np.isfinite(recording.reading)
        for name, first, last in horizon_spans(time):
            reading = np.where((time < first) & known, recording.reading, np.nan)
            judged = known & (time >= first) & (time < last)
            if np.isfinite(reading).sum() > 5 and judged.any():
                out = filtered(problem, found, recording, reading)
                squares.setdefault(name, []).append((out.recorded - recording.reading)[judged] ** 2)
        whole = filtered(problem, found, recording, recording.reading)
        ratio = whole.innovation / np.sqrt(whole.innovation_variance)
        z = ratio[recording.judged]
        white.append(float(np.mean(z[1:] * z[:-1]) / np.mean(z**2)))
        ratios.append(float(np.mean(whole.innovation[recording.judged] ** 2) / problem.reading_variance))
        beam.append(beam_dependence(recording.time, ratio, recording.judged, recording.drive))
    rms = {name: float(np.sqrt(np.mean(np.concatenate(each)))) for name, each in squares.items()}
    return Errors(rms, float(np.mean(white)), float(np.sqrt(np.mean(ratios))), joined(beam))


@dataclass(frozen=True)
class BeforeAfter:
    """Errors without and with what was found."""

    before: Errors
    after: Errors


def on_identify(problem: Problem, base: Fit, found: Fit, progress: Progress) -> BeforeAfter:
    """On the recordings that it was found from."""
    return BeforeAfter(
        errors(problem, base, problem.recordings, progress), errors(problem, found, problem.recordings, progress)
    )


def on_another(
    problem: Problem, base: Fit, found: Fit, recording: PreparedRecording, progress: Progress
) -> BeforeAfter:
    """On a recording that nothing was fitted to."""
    return BeforeAfter(errors(problem, base, (recording,), progress), errors(problem, found, (recording,), progress))


@dataclass(frozen=True)
class HeldOut:
    """Fits to a part of the recordings, and the recordings that they have not seen.

    Attributes:
        problem: of the part that was fitted to.
        base, found: fits to it, without and with what was found.
        left: what was held out.
    """

    problem: Problem
    base: Fit
    found: Fit
    left: tuple[PreparedRecording, ...]


def fit_folds(problem: Problem, base: Fit, found: Fit, progress: Progress = silent) -> tuple[HeldOut, ...]:
    """Each recording in turn, values fitted to the others; of a single one, either half of its positions."""
    made = []
    for fold in folds(problem):
        progress(f"held out: {fold.title}")
        sub = fold.problem
        plain = fit(sub, Hypothesis(problem.unknown), process_noise=base.process_noise, known=base.values())
        again = fit(sub, found.refined, process_noise=found.process_noise, known=found.values())
        made.append(HeldOut(sub, plain, again, fold.left))
    return tuple(made)


def on_held_out(parts: Sequence[HeldOut]) -> BeforeAfter:
    """On recordings that the values were not fitted to."""
    return BeforeAfter(
        _mean([errors(one.problem, one.base, one.left) for one in parts]),
        _mean([errors(one.problem, one.found, one.left) for one in parts]),
    )


def _mean(each: Sequence[Errors]) -> Errors:
    names = dict.fromkeys(name for one in each for name in one.rms)
    rms = {name: float(np.sqrt(np.mean([one.rms[name] ** 2 for one in each if name in one.rms]))) for name in names}
    return Errors(
        rms,
        float(np.mean([e.whiteness for e in each])),
        float(np.sqrt(np.mean([e.ratio**2 for e in each]))),
        joined(e.beam for e in each),
    )
