"""Jumps of the position from one reading to the next, which last: an offset, or rows that are lost.

Lines are fitted to the readings before and after each instant; a ball's path is continuous, so that both lines meet.
Constant acceleration bends both alike, which cancels; a change of acceleration moves them apart by a T²/6 at most. The
distance is judged against the scatter about the two lines, which an impact at an end stop raises too, and against the
distances everywhere else in the recording, so that a sensor that always jumps is not reported. Most of it has to lie
between two readings: where a resistive track loses contact, readings wander for some instants, and are spikes. Nor may
readings beside it repeat: a sensor that holds its reading for a while steps to the next without an offset.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.adjacent_lines import adjacent_lines
from harness.recording.noise import noise_of

SPAN = 0.1  # of a line [s]
FEWEST, MOST = 5, 25  # readings of a line
SMALLEST = 0.02  # jump that is reported; worn tracks and time-of-flight sensors jump by up to 1 cm [m]
T_VALUE = 10.0  # of the distance: noise exceeds it at one instant in 17,000 with 5 readings a side, in 4e7 with 10
ABOVE_OTHERS = 3.0  # times the 99th percentile of the distances elsewhere
AT_ONCE = 0.85  # of the jump that lies between two readings
REPEATS = 3  # equal readings beside a jump, which are a held reading
MOST_JUMPS = 6  # beyond, the sensor is like that and no single instants are to blame


@dataclass(frozen=True)
class Jump:
    """The position jumps by `size` [m] before reading `at`; `angle_too` if the angle jumps with it."""

    at: int
    size: float
    angle_too: bool


def jumps(
    time: FloatArray, position: FloatArray, angle: FloatArray, usable: NDArray[np.bool_], *, acceleration: float
) -> tuple[Jump, ...]:
    """Jumps that no motion of the ball explains; none if there are more than `MOST_JUMPS`.

    Args:
        time: strictly increasing, shape (n,) [s].
        position: shape (n,) [m].
        angle: shape (n,) [rad].
        usable: positions that are known, no spikes and not stuck, shape (n,).
        acceleration: largest possible acceleration of the ball [m/s²].
    """
    at = np.flatnonzero(usable)
    if len(at) < 6 * FEWEST:
        return ()
    noise = noise_of(position[at])
    t, s = time[at], position[at]
    step = float(np.median(np.diff(t)))
    w = int(np.clip(round(SPAN / step), FEWEST, MOST))
    seen = adjacent_lines(t, s, w)
    whole = seen.length < 1.5 * (2 * w - 1) * step
    size = np.abs(seen.gap)
    found: list[Jump] = []
    open_ = whole & (size > T_VALUE * seen.gap_error)
    open_ &= size > SMALLEST + acceleration * (w * step) ** 2 / 6.0
    turned = np.abs(adjacent_lines(t, angle[at], w).gap) if open_.any() else size
    while open_.any():
        best = int(np.argmax(np.where(open_, size, 0.0)))
        near = slice(max(best - w, 0), best + w + 1)
        elsewhere = np.ones(len(size), dtype=np.bool_)
        for one in (best, *(int(np.searchsorted(at, each.at)) - w for each in found)):
            elsewhere[max(one - w, 0) : one + w + 1] = False
        others = elsewhere & whole
        if others.sum() >= 4 * w and size[best] > ABOVE_OTHERS * np.quantile(size[others], 0.99):
            if not _at_once(position, int(at[best + w]), float(seen.gap[best]), noise):
                open_[near] = False
                continue
            usual = max(float(np.quantile(turned[others], 0.999)), 1e-9)
            angle_too = bool(turned[max(best - 1, 0) : best + 2].max() > ABOVE_OTHERS * usual)
            found.append(Jump(int(at[best + w]), float(seen.gap[best]), angle_too))
        open_[near] = False
    return tuple(sorted(found, key=lambda one: one.at)) if len(found) <= MOST_JUMPS else ()


def _at_once(position: FloatArray, at: int, size: float, noise: float) -> bool:
    """Whether the jump of `size` [m] about reading `at` lies between two readings, spikes included, neither held."""
    known = position[np.isfinite(position)]
    place = int(np.isfinite(position[:at]).sum())
    begin = max(place - 2, 0)
    step = begin + int(np.argmax(np.sign(size) * np.diff(known[begin : place + 2])))  # before reading step + 1
    held = [known[max(step + 1 - REPEATS, 0) : step + 1], known[step + 1 : step + 1 + REPEATS]]
    if any(len(part) == REPEATS and np.ptp(part) == 0.0 for part in held):
        return False
    return bool(np.sign(size) * (known[step + 1] - known[step]) >= AT_ONCE * abs(size) - 3.0 * noise)
