"""Where the ball lies against an end stop, bounces from one, or is held: no model has the force that does so.

On a tilted beam a free ball leaves any band of positions soon: within T at the latest, where a T²/8 is the width of the
band, even if it was thrown uphill. One that stays at an end of its travel for longer, while the beam falls outwards by
more than friction can hold a rolling ball, lies against a stop. At an impact the velocity turns inwards, in less than
0.1 s, by more than the steepest tilt of the recording could turn it. A ball that does not leave where it is first,
whichever way the beam falls, and for longer than any delay lasts, is held, as by a hand that lets it go. An angle that
is not the beam's, as that of a motor before a linkage, makes any tilt look steep: the ball has to follow the tilt in
the rest of the recording.

A ball that lies against a stop on a less steep beam may as well be held by friction, unless other recordings of the rig
tell that there is a stop.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.adjacent_lines import adjacent_lines, block_length, block_means
from harness.recording.noise import noise_of
from harness.recording.tilt_response import modulating

STEEP = 0.05  # rad, 3°: a rolling ball that friction holds there is none of steel on metal
LEAST, MOST = 0.4, 0.8  # a ball's acceleration over g α
RESPONDS = 0.2  # acceleration over g α, both at the 90th percentile of their sizes, of a ball that follows the tilt
SHORTEST = 0.4  # of a rest [s]
FEWEST = 8  # readings of a rest
SIGMAS = 4.0  # of the noise, about the mean of a rest
BAND = 0.01  # of the range of the positions, at least, on either side of it
INSIDE = 0.95  # share of a rest's readings in the band
END = 0.02  # of the range: how far from the extreme position an end stop may be
HELD = 1.0  # that a ball stays on a steep beam before it is let go [s]
NEAR = 0.05  # of the range: a ball that bounces from a stop and comes back is as near as this
SPAN, FEWEST_OF_LINE = 0.1, 5  # of the lines before and after an impact [s], readings
KICK = 0.1  # m/s that a jerk of the beam may give the ball
T_VALUE = 6.0  # of the change of velocity
FOLLOWING = 0.5  # windows in which it is looked whether the ball follows the tilt [s]


class Touch(StrEnum):
    """What holds or throws the ball; values are words of a sentence."""

    REST = "lies against an end stop"
    BOUNCE = "bounces from an end stop"
    HELD = "is held by something"


@dataclass(frozen=True)
class Contact:
    """Readings `first` to `last`, both included, near an end stop that the ball touches, or in which it is held.

    Attributes:
        first, last: readings.
        place: position of the ball then, or at the stop [m].
        touch: which of these it is.
    """

    first: int
    last: int
    place: float
    touch: Touch


@dataclass(frozen=True)
class Stops:
    """Where the rig's end stops hold the ball; `None` where none is known.

    Attributes:
        low, high: positions of the ball [m].
    """

    low: float | None = None
    high: float | None = None

    def adds_to(self, other: Stops) -> bool:
        """Whether it has a stop that the other has not."""
        pairs = ((self.low, other.low), (self.high, other.high))
        return any(mine is not None and its is None for mine, its in pairs)


NO_STOPS = Stops()


def common_stops(found: Sequence[Stops]) -> Stops:
    """The stops on which two recordings of a rig agree, of what was found in each.

    The outermost place is the stop's: the readings of a ball that bounces may all fall beside the impact.
    """
    lows = [-one.low for one in found if one.low is not None]
    highs = [one.high for one in found if one.high is not None]
    if not lows and not highs:
        return NO_STOPS
    travel = max(highs, default=0.0) + max(lows, default=0.0)
    low, high = (_agreed(places, NEAR * travel) for places in (lows, highs))
    return Stops(None if low is None else -low, high)


def _agreed(places: Sequence[float], apart: float) -> float | None:
    """The largest of the places [m], if another one is no more than `apart` away [m]."""
    ordered = sorted(places)
    return ordered[-1] if len(ordered) > 1 and ordered[-1] - ordered[-2] <= apart else None


def end_stops(
    time: FloatArray,
    angle: FloatArray,
    position: FloatArray,
    usable: NDArray[np.bool_],
    *,
    resolution: float,
    gravity: float,
    known: Stops = NO_STOPS,
) -> tuple[tuple[Contact, ...], Stops]:
    """All contacts, in order, and the stops that this recording tells; none if the ball does not follow the tilt
    elsewhere.

    A stop is found by a rest or an impact that nothing else explains; then all that comes as far is a contact.

    Args:
        time: strictly increasing, shape (n,) [s].
        angle: shape (n,) [rad].
        position: shape (n,) [m].
        usable: positions that are known, no spikes and not set aside, shape (n,).
        resolution: of the positions [m], 0 if unknown.
        gravity: g [m/s²].
        known: stops that other recordings tell.
    """
    at = np.flatnonzero(usable)
    if len(at) < 4 * FEWEST:
        return (), NO_STOPS
    block = block_length(time[at])
    t, alpha, s = (block_means(channel[at], block) for channel in (time, angle, position))
    if len(t) < 4 * FEWEST:
        return (), NO_STOPS
    range_ = float(np.ptp(s))
    band = max(SIGMAS * noise_of(s) + resolution, BAND * range_)
    impacts = list(_impacts(t, alpha, s, gravity))
    found: list[Contact] = []
    own: list[float | None] = []
    for side, elsewhere in ((-1.0, known.low), (1.0, known.high)):
        places = [s[first : last + 1] for first, last in _rests(t, side * alpha, side * s, band, gravity)]
        places += [s[i : i + 1] for i in impacts if side * (s[i] - np.median(s)) > 0.0]
        own.append(float(np.median(np.concatenate(places))) if places else None)
        stop = elsewhere if own[-1] is None else own[-1]
        if stop is not None:
            found += _contacts(t, side * (s - stop), stop, band, max(band, NEAR * range_))
    if not any(one.first == 0 for one in found):
        found += _held_at_first(t, alpha, s, band, gravity)
    if not found or not _follows(t, alpha, s, found, gravity):
        return (), NO_STOPS
    contacts = (
        replace(one, first=int(at[one.first * block]), last=int(at[(one.last + 1) * block - 1])) for one in found
    )
    return tuple(sorted(contacts, key=lambda one: one.first)), Stops(*own)


def _contacts(t: FloatArray, beyond: FloatArray, stop: float, band: float, near: float) -> Iterator[Contact]:
    """Stretches in which the ball is near a stop and touches it; `beyond` is how far it is beyond [m]."""
    for part in _parts(beyond >= -near):
        touching = [part[run] for run in _parts(beyond[part] >= -band)]
        if touching:
            longest = max(float(t[run[-1]] - t[run[0]]) for run in touching)
            touch = Touch.REST if longest >= SHORTEST else Touch.BOUNCE
            yield Contact(int(part[0]), int(part[-1]), stop, touch)


def _rests(
    t: FloatArray, outwards: FloatArray, s: FloatArray, band: float, gravity: float
) -> Iterator[tuple[int, int]]:
    """First and last reading of rests at the upper end of `s` that only a stop explains."""
    end = float(np.max(s)) - max(band, END * float(np.ptp(s)))
    for part in _parts((outwards >= STEEP) & (s >= end)):
        lasted = float(t[part[-1]] - t[part[0]])
        if len(part) < FEWEST or lasted < SHORTEST:
            continue
        inside = np.abs(s[part] - np.median(s[part])) <= band
        if inside.mean() >= INSIDE and _would_leave(lasted, float(np.mean(outwards[part])), band, gravity):
            yield int(part[0]), int(part[-1])


def _held_at_first(t: FloatArray, alpha: FloatArray, s: FloatArray, band: float, gravity: float) -> Iterator[Contact]:
    """The stretch until the ball leaves where it is first, if the beam is steep for so long that it should have."""
    place = float(np.median(s[:FEWEST]))
    near = _parts(np.abs(s - place) <= band)
    if not near:  # a ball that rolls far from one of the first readings to the next
        return
    stay = near[0]
    for side in (-1.0, 1.0):
        for steep in _parts(side * alpha[stay] >= STEEP):
            lasted = float(t[stay[steep[-1]]] - t[stay[steep[0]]])
            tilt = float(np.mean(side * alpha[stay[steep]]))
            if len(steep) >= FEWEST and lasted >= HELD and _would_leave(lasted, tilt, band, gravity):
                yield Contact(0, int(stay[-1]), place, Touch.HELD)
                return


def _would_leave(lasted: float, tilt: float, band: float, gravity: float) -> bool:
    """Whether a free ball leaves a band of ± `band` [m] within this time [s], on a beam of this tilt [rad]."""
    return LEAST * gravity * tilt * lasted**2 > 16.0 * band


def _impacts(t: FloatArray, alpha: FloatArray, s: FloatArray, gravity: float) -> Iterator[int]:
    """Readings that are farthest where the ball is thrown back at an end of its travel."""
    step = float(np.median(np.diff(t)))
    w = max(FEWEST_OF_LINE, round(SPAN / step))
    if len(t) < 4 * w:
        return
    seen = adjacent_lines(t, s, w)
    steepest = MOST * gravity * float(np.max(np.abs(alpha)))
    sudden = np.abs(seen.turn) > KICK + 2.0 * steepest * seen.apart + T_VALUE * seen.slope_error
    whole = seen.apart < 1.5 * w * step
    for part in _parts(sudden & whole, gap=1):
        best = int(part[np.argmax(np.abs(seen.turn[part]))])
        if any(sudden[i] for i in (best - w, best + w) if 0 <= i < len(sudden)):
            continue  # a worn track: the reading moves suddenly, and then as before
        side = -math.copysign(1.0, float(seen.turn[best]))
        farthest = best + int(np.argmax(side * s[best : best + 2 * w]))
        if side * s[farthest] >= float(np.max(side * s)) - END * float(np.ptp(s)) and side * seen.before[best] > 0.0:
            yield farthest


def _parts(flags: NDArray[np.bool_], gap: int = 2) -> list[NDArray[np.intp]]:
    """Indices of each stretch of true flags, in which fewer than `gap` in a row are false."""
    at = np.flatnonzero(flags)
    return np.split(at, np.flatnonzero(np.diff(at) > gap) + 1) if len(at) else []


def _follows(t: FloatArray, alpha: FloatArray, s: FloatArray, contacts: list[Contact], gravity: float) -> bool:
    """Whether the ball accelerates as a rolling ball may where it touches no stop.

    Sizes of acceleration and tilt are compared, so that delays do not matter.
    """
    step = float(np.median(np.diff(t)))
    grid = np.arange(t[0], t[-1] + 0.5 * step, step)
    half = max(FEWEST // 2, round(0.5 * FOLLOWING / step))
    if len(grid) < 4 * half:
        return False
    test, curvature = modulating(half, step)
    acceleration = np.convolve(np.interp(grid, t, s), curvature, "valid") / test.sum()
    tilt = np.convolve(np.interp(grid, t, alpha), test, "valid") / test.sum()
    centre = grid[half : half + len(tilt)]
    apart = np.ones(len(centre), dtype=np.bool_)
    for one in contacts:
        apart &= (centre + half * step <= t[one.first]) | (centre - half * step >= t[one.last])
    if apart.sum() < half:
        return False
    moved, tilted = (float(np.quantile(np.abs(values[apart]), 0.9)) for values in (acceleration, tilt))
    return moved >= RESPONDS * gravity * tilted > 0.0
