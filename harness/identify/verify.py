"""Before and after: how far predictions are off without and with what was found, on data that did not find it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.fit import Fit, fit
from harness.identify.forecast import filtered
from harness.identify.hypothesis import Hypothesis
from harness.identify.problem import Problem, Record

KNOWN = 2.0  # of each prediction [s]: what comes before it is known
HORIZONS = (1.0, 2.0, 3.0, 5.0)

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Errors:
    """RMS errors [m] by horizon ("1 s" …, "whole"), and how white the innovations are.

    Attributes:
        rms: by horizon.
        whiteness: correlation of neighbouring innovations, near 0 for a right model [1].
        ratio: RMS of innovations over the reading's noise, near 1 at the floor [1].
    """

    rms: Mapping[str, float]
    whiteness: float
    ratio: float


def errors(problem: Problem, found: Fit, records: Sequence[Record], progress: Progress = lambda _: None) -> Errors:
    """Prediction errors of `found` over `records`.

    "3 s" is the RMS over all windows of 3 s, each predicted from everything known before it; "whole" is the rest of the
    recording predicted from its first two seconds.
    """
    squares: dict[str, list[FloatArray]] = {}
    white, ratios = [], []
    for record in records:
        progress(f"errors of {record.name}")
        time = record.time - record.time[0]
        known = np.isfinite(record.reading)
        for name, first, last in _windows(time):
            reading = np.where((time < first) & known, record.reading, np.nan)
            judged = known & (time >= first) & (time < last)
            if np.isfinite(reading).sum() > 5 and judged.any():
                out = filtered(problem, found, record, reading)
                squares.setdefault(name, []).append((out.recorded - record.reading)[judged] ** 2)
        whole = filtered(problem, found, record, record.reading)
        z = (whole.miss / np.sqrt(whole.spread))[record.judged]
        white.append(float(np.mean(z[1:] * z[:-1]) / np.mean(z**2)))
        ratios.append(float(np.mean(whole.miss[record.judged] ** 2) / problem.noise))
    rms = {name: float(np.sqrt(np.mean(np.concatenate(each)))) for name, each in squares.items()}
    return Errors(rms, float(np.mean(white)), float(np.sqrt(np.mean(ratios))))


def _windows(time: FloatArray) -> list[tuple[str, float, float]]:
    """Name, begin and end of every prediction [s]."""
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


def held_out(problem: Problem, base: Fit, found: Fit, progress: Progress) -> Comparison:
    """On each recording in turn, values fitted to the others; a single recording is split in the middle."""
    before, after = [], []
    for rest, left in _splits(problem):
        progress(f"held out: {', '.join(record.name for record in left)}")
        sub = replace(problem, records=rest)
        shape = found.hypothesis.shape
        plain = fit(sub, Hypothesis(()), density=base.density)
        again = fit(sub, Hypothesis(found.hypothesis.names, shape), density=found.density, known=found.values())
        before.append(errors(sub, plain, left))
        after.append(errors(sub, again, left))
    return Comparison(_mean(before), _mean(after))


def _splits(problem: Problem) -> list[tuple[tuple[Record, ...], tuple[Record, ...]]]:
    records = problem.records
    if len(records) > 1:
        return [(tuple(r for r in records if r is not left), (left,)) for left in records]
    (one,) = records
    middle = len(one.time) // 2
    halves = [_piece(one, slice(0, middle)), _piece(one, slice(middle, None))]
    return [((halves[0],), (halves[1],)), ((halves[1],), (halves[0],))]


def _piece(record: Record, where: slice) -> Record:
    return Record(record.name, record.time[where], record.reading[where], record.drive)


def _mean(each: Sequence[Errors]) -> Errors:
    names = dict.fromkeys(name for one in each for name in one.rms)
    rms = {name: float(np.sqrt(np.mean([one.rms[name] ** 2 for one in each if name in one.rms]))) for name in names}
    return Errors(rms, float(np.mean([e.whiteness for e in each])), float(np.sqrt(np.mean([e.ratio**2 for e in each]))))
