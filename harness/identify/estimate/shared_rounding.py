"""What an encoder's rounding adds to a covariance where the beam comes to rest on the same count again and again.

A beam that rests tells no more of its angle than the count, and the error of that stays for as long as it rests: this
much the filter knows. But a beam that rests against the same stop, or that the same command holds, has the same error
each time, and in the next recording too. Six such rests say no more than one, and rests at +3° and at −3°, with
opposite errors, look like a gain. The filter takes a recording stretch by stretch and cannot know.

So the estimate's response to an angle that is off by one standard deviation in all rests on one count is computed: its
square takes the place of the sum of squares of the responses to the single rests. Where that is less, because the
responses cancel, the rests stay independent: a servo may as well come to rest elsewhere within the count.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.problem import PreparedRecording, Problem

# Of a count: the standard deviation of an angle at rest is 0.24 to 0.29 (1/√12); it is 0.15 where the beam passes a
# count in ten readings.
_UNRESOLVED = 0.2
_SHORTEST = 3  # stamps
_MOST = 100  # rests, those of the counts on which the beam rests longest; each costs a run over its recording


@dataclass(frozen=True)
class _Rest:
    """Stamps of a recording's drive at which the beam rests on one count.

    Attributes:
        recording: number of the recording.
        count: number of the count, and the distance of two counts [rad].
        stamps: of the drive.
        duration: from the first to the last stamp [s].
    """

    recording: int
    count: tuple[int, float]
    stamps: slice
    duration: float


def shared_rounding(problem: Problem, found: Fit, jacobian: FloatArray, covariance: FloatArray) -> FloatArray:
    """What repeated rests on the same counts add to a covariance that takes all rests for independent, shape (k, k).

    Args:
        jacobian: of the residuals by the scaled parameters, shape (readings, k).
        covariance: of the parameters in their units, shape (k, k).

    Returns:
        A positive semidefinite matrix, in the units of `covariance`.
    """
    residuals = Residuals(problem, found.hypothesis, found.process_noise)
    per_residual = -covariance / found.hypothesis.scale(problem) @ jacobian.T  # of the parameters, shape (k, readings)
    added = np.zeros_like(covariance)
    for rests in _repeated(problem):
        total = np.zeros(len(covariance))
        for rest in rests:
            recording = problem.recordings[rest.recording]
            deviation = rest.count[1] / math.sqrt(12.0)
            rows, change = residuals.change(found.theta, rest.recording, _turned(recording, rest.stamps, deviation))
            response = per_residual[:, rows] @ change
            total += response
            stated = float(np.mean(recording.drive.std[rest.stamps, 0])) / deviation
            added -= stated**2 * np.outer(response, response)
        added += np.outer(total, total)
    return _positive_part(added, covariance)


def _turned(recording: PreparedRecording, stamps: slice, angle: float) -> PreparedRecording:
    """The recording with a beam that lay `angle` [rad] higher at these stamps of its drive."""
    states = recording.drive.states.copy()
    states[stamps, 0] += angle
    return replace(recording, drive=replace(recording.drive, states=states))


def _repeated(problem: Problem) -> list[list[_Rest]]:
    """The rests on each count that has several, the longest altogether first; no more than `_MOST` of them."""
    by_count: dict[tuple[int, float], list[_Rest]] = {}
    for number, recording in enumerate(problem.recordings):
        for rest in _rests(number, recording):
            by_count.setdefault(rest.count, []).append(rest)
    several = [rests for rests in by_count.values() if len(rests) > 1]
    several.sort(key=lambda rests: sum(rest.duration for rest in rests), reverse=True)
    within = np.cumsum([len(rests) for rests in several]) <= _MOST
    return [rests for rests, taken in zip(several, within, strict=True) if taken]


def _rests(number: int, recording: PreparedRecording) -> Iterator[_Rest]:
    """The rests of a recording whose angle is rounded: the count is all that is known there."""
    drive = recording.drive
    resolution = drive.sensor.resolution
    if not drive.sensor.rounded:
        return
    counts = np.rint(drive.states[:, 0] / resolution).astype(int)
    unresolved = drive.std[:, 0] > _UNRESOLVED * resolution
    for (resting, count), group in groupby(range(len(counts)), key=lambda k: (bool(unresolved[k]), int(counts[k]))):
        stamps = list(group)
        if resting and len(stamps) >= _SHORTEST:
            duration = float(drive.time[stamps[-1]] - drive.time[stamps[0]])
            yield _Rest(number, (count, resolution), slice(stamps[0], stamps[-1] + 1), duration)


def _positive_part(added: FloatArray, covariance: FloatArray) -> FloatArray:
    """`added` without the directions in which it is negative, measured against a positive semidefinite `covariance`."""
    value, direction = np.linalg.eigh(covariance / _units(covariance))
    kept = value > 1e-12 * value.max(initial=0.0)
    root = direction[:, kept] * np.sqrt(value[kept])  # covariance = units · root rootᵀ
    inverse = (direction[:, kept] / np.sqrt(value[kept])).T
    share, along = np.linalg.eigh(inverse @ (added / _units(covariance)) @ inverse.T)
    return (root @ along * share.clip(min=0.0)) @ (root @ along).T * _units(covariance)


def _units(covariance: FloatArray) -> FloatArray:
    """Products of the parameters' standard deviations, 1 for one that is known, shape (k, k)."""
    deviation = np.sqrt(np.diag(covariance).clip(min=0.0))
    deviation[deviation == 0.0] = 1.0
    return np.outer(deviation, deviation)
