"""Runs of equal positions that no resting ball explains: a sensor that is stuck, gives zeros, or is clipped.

A ball may rest, by friction or at an end stop, and its readings are then equal for seconds. But it leaves from where
it rested, and from rest: t after it, it is at most a t²/2 away. Where a run of equal readings is left faster, the ball
moved during it. Before the run likewise, except at an end of its travel, where an end stop may have stopped it. Where
one run shows that the sensor is clipped at a value, all runs of this value are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.noise import noise_of

SHORTEST = 0.4  # of a run of equal readings; sensors that are read faster than they measure repeat for less [s]
SHORTEST_ZEROS = 0.1  # of zeros that are left and come to like this [s]
FEWEST = 5  # readings of a run
REACH = 0.25  # after and before a run, in which the ball's motion is looked at [s]
SIGMAS = 6.0  # of the noise, beyond what the ball can move
CONSECUTIVE = 3  # readings that far out: for normal noise one false alarm in 1e26 runs
MARGIN = 1.5  # on the largest acceleration: the gain of the angle may be wrong
END = 0.02  # of the range of the positions, next to which an end stop may be


class Fault(StrEnum):
    """What is wrong with a run; values are codes of findings."""

    STUCK = "stuck-position"
    ZEROS = "zeros"
    CLIPPED = "clipped"


@dataclass(frozen=True)
class Run:
    """Readings `first` to `last`, both included, that repeat one value [m] while the ball moves."""

    first: int
    last: int
    value: float
    fault: Fault


def frozen(
    time: FloatArray, position: FloatArray, usable: NDArray[np.bool_], *, resolution: float, acceleration: float
) -> Iterator[Run]:
    """Runs of equal readings during which the ball moved.

    Args:
        time: strictly increasing, shape (n,) [s].
        position: shape (n,) [m].
        usable: positions that are known and no spikes, shape (n,).
        resolution: of the sensor [m], 0 if unknown.
        acceleration: largest possible acceleration of the ball [m/s²].
    """
    at = np.flatnonzero(usable)
    if len(at) < 2 * FEWEST:
        return
    t, s = time[at], position[at]
    reach = max(REACH, (CONSECUTIVE + 1) * float(np.median(np.diff(t))))
    noise = SIGMAS * noise_of(s) + 2.0 * resolution
    limits: set[float] = set()
    doubtful = []
    for first, last in _equal_runs(t, s):
        end = END * float(np.ptp(s))
        inner = s.min() + end < s[first] < s.max() - end
        before, after = slice(max(first - 1, 0), None, -1) if first else slice(0, 0), slice(last + 1, None)
        left = _too_far(t[after] - t[last], s[after] - s[first], reach, noise, acceleration)
        came = _too_far(t[first] - t[before], s[before] - s[first], reach, noise, acceleration)
        zeros = s[first] == 0.0 and left and came
        faulty = zeros or (t[last] - t[first] >= SHORTEST and (left or (came and inner)))
        run = Run(int(at[first]), int(at[last]), float(s[first]), _fault(s, first, last, noise))
        if not faulty:
            doubtful.append(run)
            continue
        if run.fault is Fault.CLIPPED:
            limits.add(run.value)
        yield run
    yield from (replace(run, fault=Fault.CLIPPED) for run in doubtful if run.value in limits)


def _equal_runs(t: FloatArray, s: FloatArray) -> Iterator[tuple[int, int]]:
    """First and last reading of each run of equal ones that is long enough."""
    edges = np.flatnonzero(np.diff(s) != 0.0)
    starts, ends = np.concatenate(([0], edges + 1)), np.concatenate((edges, [len(s) - 1]))
    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        if last - first + 1 >= FEWEST and t[last] - t[first] >= SHORTEST_ZEROS:
            yield first, last


def _too_far(since: FloatArray, away: FloatArray, reach: float, noise: float, acceleration: float) -> bool:
    """Whether consecutive readings are farther away than a ball that was at rest can be."""
    near = since <= reach
    far = np.abs(away[near]) > noise + 0.5 * MARGIN * acceleration * since[near] ** 2
    return (
        bool(np.any(np.convolve(far, np.ones(CONSECUTIVE), "valid") >= CONSECUTIVE))
        if len(far) >= CONSECUTIVE
        else False
    )


def _fault(s: FloatArray, first: int, last: int, noise: float) -> Fault:
    if s[first] == 0.0:
        return Fault.ZEROS
    rest = np.delete(s, slice(first, last + 1))
    if not len(rest):
        return Fault.STUCK
    beyond = s[first] >= rest.max() - noise or s[first] <= rest.min() + noise
    steps = [abs(float(s[i] - s[first])) for i in (first - 1, last + 1) if 0 <= i < len(s)]
    usual = float(np.max(np.abs(np.diff(rest)), initial=0.0)) if len(rest) > 1 else 0.0
    return Fault.CLIPPED if beyond and max(steps) <= usual else Fault.STUCK
