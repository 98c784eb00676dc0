"""Where the ball was pushed: its velocity changes at once, and the beam did not turn as suddenly.

Changes of the velocity over a fraction of a second are regressed on what the recorded angle makes of them, with any
delay up to some tenths of a second: by gravity, whose double integral is taken, and by the acceleration of the beam,
through the lever of the ball; a constant and a drag go with them. It has to stand out without the acceleration too: a
command that answers the recorded positions has their noise, which imitates a lever. What is left is compared with what
is left elsewhere in the recording, so that friction, a rough track and a poor angle count in it. A push leaves a peak
of one sign; where a reading jumps, as on a worn track, two of opposite sign lie beside each other. A ball that goes
back as fast as it came was thrown back by a steep place of the track, which is a law of the position and stays in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.adjacent_lines import AdjacentLines, adjacent_lines, block_length, block_means
from harness.recording.outliers import MAD_TO_SIGMA

SPAN, FEWEST = 0.15, 5  # of the lines before and after an instant [s], readings
LATEST, BETWEEN = 0.6, 0.1  # delay that is allowed for, and from one tried to the next [s]
SMALLEST = 0.15  # push that is reported; a bump of 2 mm throws a slow ball by less [m/s]
SIGMAS = 10.0  # of what is left elsewhere, by its median size
T_VALUE = 6.0  # of the change of velocity, by the scatter of the readings
ABOVE_OTHERS = 6.5  # times the 80th percentile of what is left; four pushes in 14 s reach into the 90th
OPPOSITE = 0.3  # of the peak, that a change of the other sign beside it may have
THROWN_BACK = 0.3  # of the change, that the sum of the velocities before and after may be; of a push it is the change
HALF = 0.5  # of the peak, down to which its readings are left out
MOST = 8  # pushes; beyond, the rig is like that and no single instants are to blame
ROUNDS, INLYING = 8, 4.0  # of each regression, and the deviations within which a change counts in the second one


@dataclass(frozen=True)
class Push:
    """Readings `first` to `last`, both included, during which the velocity changes by `size` [m/s] more than it may."""

    first: int
    last: int
    size: float


def pushes(
    time: FloatArray, angle: FloatArray, position: FloatArray, usable: NDArray[np.bool_], *, gravity: float
) -> tuple[Push, ...]:
    """Pushes in order; none if there are more than `MOST`.

    Args:
        time: strictly increasing, shape (n,) [s].
        angle: shape (n,) [rad].
        position: shape (n,) [m].
        usable: positions that are known, no spikes, not set aside and at no end stop, shape (n,).
        gravity: g [m/s²].
    """
    at = np.flatnonzero(usable)
    block = block_length(time[at]) if len(at) > 1 else 1
    t, s = block_means(time[at], block), block_means(position[at], block)
    if len(t) < 2 * FEWEST:  # few readings, or stamps in bursts, closer together than readings are on average
        return ()
    step = float(np.median(np.diff(t)))
    w = max(FEWEST, round(SPAN / step))
    if len(t) < 4 * w:
        return ()
    seen = adjacent_lines(t, s, w)
    whole = seen.apart < 1.5 * w * step
    pulled, turned = _columns(time, angle, t, seen, gravity)
    if whole.sum() < 4 * (pulled.shape[1] + turned.shape[1]):
        return ()
    both = [_left(columns, seen.turn, whole) for columns in (pulled, np.hstack((pulled, turned)))]
    open_ = whole.copy()
    for left in both:
        open_ &= np.abs(left) > _least(np.abs(left[whole]))
    left = np.where(np.abs(both[0]) < np.abs(both[1]), *both)
    size = np.where(whole, np.abs(left), 0.0)
    open_ &= size > T_VALUE * seen.slope_error
    found: list[Push] = []
    while open_.any():
        peak = int(np.argmax(np.where(open_, size, 0.0)))
        near = slice(max(peak - 2 * w, 0), peak + 2 * w + 1)
        beside = left[near] * np.sign(left[peak])
        bend = near.start + int(np.argmax(np.abs(seen.turn[near])))
        thrown_back = abs(seen.before[bend] + seen.after[bend]) < THROWN_BACK * abs(seen.turn[bend])
        if beside.min() > -OPPOSITE * size[peak] and not thrown_back:
            first = last = peak
            while first > 0 and size[first - 1] >= HALF * size[peak]:
                first -= 1
            while last < len(size) - 1 and size[last + 1] >= HALF * size[peak]:
                last += 1
            begin, end = (first + w - 1) * block, (last + w + 1) * block - 1
            found.append(Push(int(at[begin]), int(at[end]), float(left[peak])))
        open_[near] = False
    return tuple(sorted(found, key=lambda one: one.first)) if len(found) <= MOST else ()


def _least(size: FloatArray) -> float:
    """The least change that may be a push, among what is left of all of them, shape (n,) [m/s]."""
    sigma = MAD_TO_SIGMA * float(np.median(size))
    return max(SMALLEST, SIGMAS * sigma, ABOVE_OTHERS * float(np.quantile(size, 0.8)))


def _columns(
    time: FloatArray, angle: FloatArray, stamps: FloatArray, seen: AdjacentLines, gravity: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What may explain changes of the velocity, shapes (m, 2 + delays) and (m, delays), a column each.

    A constant, in metres a drag, and the tilt's pull [m/s], late by every delay; the beam's turning [rad/s] likewise.
    """
    fallen = gravity * _integral(time, _integral(time, angle))

    def late(signal: FloatArray) -> list[FloatArray]:
        delays = np.arange(0.0, LATEST + 0.5 * BETWEEN, BETWEEN)
        at = (np.interp(np.maximum(stamps - delay, time[0]), time, signal) for delay in delays)
        return [adjacent_lines(stamps, values, seen.width).turn for values in at]

    drag = 0.5 * (seen.before + seen.after) * seen.apart
    return np.column_stack([np.ones(len(drag)), drag, *late(fallen)]), np.column_stack(late(angle))


def _integral(time: FloatArray, values: FloatArray) -> FloatArray:
    """By trapezoids; importing scipy.integrate would delay the first line of every command."""
    return np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))))


def _left(columns: NDArray[np.float64], change: FloatArray, whole: NDArray[np.bool_]) -> FloatArray:
    """What a regression leaves of the changes, shape (n,) [m/s].

    By least absolute deviations, reweighted, and then by least squares without those far out: a controller answers a
    push at once, so that least squares of all would lay much of it to the beam's acceleration.
    """
    left, weight = change, whole.astype(float)
    for number in range(2 * ROUNDS):
        root = np.sqrt(weight)
        left = change - columns @ np.linalg.lstsq(root[:, None] * columns, root * change, rcond=None)[0]
        size = np.abs(left)
        usual = MAD_TO_SIGMA * float(np.median(size[whole]))
        weight = (
            whole / np.maximum(size, usual or 1.0) if number < ROUNDS else 1.0 * (whole & (size <= INLYING * usual))
        )
    return left
