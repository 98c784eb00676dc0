"""Before and after: how far predictions are off without and with what was found, on data that did not find it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.fit import Fit, fit
from harness.identify.forecast import filtered
from harness.identify.hypothesis import Hypothesis
from harness.identify.independence import Dependence, joined, on_beam
from harness.identify.problem import Problem, Record

KNOWN = 2.0  # of each prediction [s]: what comes before it is known
HORIZONS = (1.0, 2.0, 3.0, 5.0)

Progress = Callable[[str], None]


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


def errors(problem: Problem, found: Fit, records: Sequence[Record], progress: Progress = lambda _: None) -> Errors:
    """Prediction errors of `found` over `records`.

    "3 s" is the RMS over all windows of 3 s, each predicted from everything known before it; "whole" is the rest of the
    recording predicted from its first two seconds.
    """
    squares: dict[str, list[FloatArray]] = {}
    white, ratios, beam = [], [], []
    for record in records:
        progress(f"errors of {record.name}")
        time = record.time - record.time[0]
        known = np.isfinite(record.reading)
        for name, first, last in windows(time):
            reading = np.where((time < first) & known, record.reading, np.nan)
            judged = known & (time >= first) & (time < last)
            if np.isfinite(reading).sum() > 5 and judged.any():
                out = filtered(problem, found, record, reading)
                squares.setdefault(name, []).append((out.recorded - record.reading)[judged] ** 2)
        whole = filtered(problem, found, record, record.reading)
        ratio = whole.innovation / np.sqrt(whole.innovation_variance)
        z = ratio[record.judged]
        white.append(float(np.mean(z[1:] * z[:-1]) / np.mean(z**2)))
        ratios.append(float(np.mean(whole.innovation[record.judged] ** 2) / problem.noise))
        beam.append(on_beam(record.time, ratio, record.judged, record.drive))
    rms = {name: float(np.sqrt(np.mean(np.concatenate(each)))) for name, each in squares.items()}
    return Errors(rms, float(np.mean(white)), float(np.sqrt(np.mean(ratios))), joined(beam))


def windows(time: FloatArray) -> list[tuple[str, float, float]]:
    """Name, begin and end of every prediction [s], for stamps that begin at 0, shape (n,)."""
    end = float(time[-1])
    found = []
    for horizon in HORIZONS:
        count = int((end - KNOWN) / horizon + 1e-6)
        found += [(f"{horizon:g} s", KNOWN + i * horizon, KNOWN + (i + 1) * horizon) for i in range(count)]
    return [*found, ("whole", KNOWN, end + 1.0)]


@dataclass(frozen=True)
class Comparison:
    """Errors without and with what was found."""

    before: Errors
    after: Errors


def on_identify(problem: Problem, base: Fit, found: Fit, progress: Progress) -> Comparison:
    """On the recordings that it was found from."""
    return Comparison(
        errors(problem, base, problem.records, progress), errors(problem, found, problem.records, progress)
    )


def on_another(problem: Problem, base: Fit, found: Fit, record: Record, progress: Progress) -> Comparison:
    """On a recording that nothing was fitted to."""
    return Comparison(errors(problem, base, (record,), progress), errors(problem, found, (record,), progress))


@dataclass(frozen=True)
class Split:
    """Fits to a part of the recordings, and the recordings that they have not seen.

    Attributes:
        problem: of the part that was fitted to.
        base, found: fits to it, without and with what was found.
        left: what was held out.
    """

    problem: Problem
    base: Fit
    found: Fit
    left: tuple[Record, ...]


def splits(problem: Problem, base: Fit, found: Fit, progress: Progress = lambda _: None) -> tuple[Split, ...]:
    """Each recording in turn, values fitted to the others; of a single one, either half of its positions."""
    made = []
    for rest, left in parts(problem):
        progress(f"held out: {', '.join(record.name for record in left)}")
        sub = replace(problem, records=rest)
        plain = fit(sub, Hypothesis(problem.unknown), density=base.density, known=base.values())
        again = fit(sub, found.refined, density=found.density, known=found.values())
        made.append(Split(sub, plain, again, left))
    return tuple(made)


def held_out(parts: Sequence[Split]) -> Comparison:
    """On recordings that the values were not fitted to."""
    return Comparison(
        _mean([errors(one.problem, one.base, one.left) for one in parts]),
        _mean([errors(one.problem, one.found, one.left) for one in parts]),
    )


def parts(problem: Problem) -> list[tuple[tuple[Record, ...], tuple[Record, ...]]]:
    """Recordings to fit to and recordings to judge on: each in turn, or halves of a single one's positions."""
    records = problem.records
    if len(records) > 1:
        return [(tuple(r for r in records if r is not left), (left,)) for left in records]
    (one,) = records
    known = np.flatnonzero(np.isfinite(one.reading))
    middle = int(known[len(known) // 2])  # of what is known: there may be nothing after its first seconds
    halves = [_piece(one, "first half", slice(0, middle)), _piece(one, "second half", slice(middle, None))]
    return [((halves[0],), (halves[1],)), ((halves[1],), (halves[0],))]


def _piece(record: Record, part: str, where: slice) -> Record:
    return Record(f"{record.name}, {part}", record.time[where], record.reading[where], record.drive)


def _mean(each: Sequence[Errors]) -> Errors:
    names = dict.fromkeys(name for one in each for name in one.rms)
    rms = {name: float(np.sqrt(np.mean([one.rms[name] ** 2 for one in each if name in one.rms]))) for name in names}
    return Errors(
        rms,
        float(np.mean([e.whiteness for e in each])),
        float(np.sqrt(np.mean([e.ratio**2 for e in each]))),
        joined(e.beam for e in each),
    )
