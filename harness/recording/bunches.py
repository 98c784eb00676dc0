"""Stamps that come in bunches: of a logger that stamps readings when it fetches them, several at once.

A program that reads a serial line when there is time finds several readings there, and gives all of them nearly the
same time, that of the last. On such stamps the beam and the ball seem to jump and to rest in turn. Readings that a rig
takes at an even rate lie evenly between the last of one bunch and the last of the next.

A rig may also take several readings in a row and then pause, and its stamps are right. The signals tell which it is: of
readings taken together, one hardly differs from the next.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.findings import DataFinding

_CLOSE = 0.25  # steps below this share of the mean one lie within a bunch: uneven sampling by a third has one in 80
_MANY = 0.25  # share of such steps from which stamps come in bunches, of four readings in three on average
_LARGEST = 10.0  # readings of a bunch on average; beyond, the clock is too coarse for the motion to be told
_PAUSE = 3.0  # time between bunches beyond which readings are missing, in median ones
# Change from one reading to the next within bunches over that from bunch to bunch. It is 1 for readings at an even
# rate, and at most a third for three or more taken in a quarter of the time or less; noise alone makes it 1 in both.
# Readings of a slow rig are few, and their ratio is known no better than its standard error, which it may be off by.
_AS_MUCH = 0.6


def evened(path: Path, time: FloatArray, signals: Iterable[FloatArray]) -> tuple[FloatArray, list[DataFinding]]:
    """Stamps with those of each bunch spread evenly over the time since the last reading before it.

    Args:
        path: of the recording.
        time: not decreasing, shape (n,) [s].
        signals: what was read, shape (n,) each, NaN where it was not.

    Returns:
        The stamps, shape (n,), unchanged where they do not come in bunches, and a warning where they do.
    """
    steps = np.diff(time)
    if len(steps) < 2 or not (steps > 0.0).any():
        return time, []
    close = steps < _CLOSE * np.mean(steps)
    if np.mean(close) < _MANY or not all(_changes_evenly(one, close) for one in signals):
        return time, []
    last = np.append(np.flatnonzero(~close), len(time) - 1)  # readings that end a bunch
    sizes = np.diff(last, prepend=-1)
    if np.mean(sizes) > _LARGEST:
        return time, []
    since = np.diff(time[last])
    pause = float(np.median(since))
    interval = pause / float(np.mean(sizes))
    # the first bunch, and one after a gap, lasts as long as so many readings take
    lasts = np.append(sizes[0] * interval, np.where(since > _PAUSE * pause, sizes[1:] * interval, since))
    place = np.concatenate([np.arange(size - 1, -1, -1) for size in sizes])  # readings until the end of the bunch
    spread = np.repeat(time[last], sizes) - place * np.repeat(lasts / sizes, sizes)
    text = (
        f"stamps come in bunches of {np.mean(sizes):.2g} readings on average, {pause:.3g} s apart, but the readings "
        "change as evenly as if taken one after the other: several are stamped at once, when they are fetched or by a "
        f"coarse clock. Those of each bunch are spread evenly over the time since the one before, {interval:.3g} s a "
        "reading; record the time at which each is taken, with enough digits."
    )
    return spread, [DataFinding("warning", path.name, text, "bunched-stamps")]


def _changes_evenly(signal: FloatArray, close: NDArray[np.bool_]) -> bool:
    """Whether a signal changes as much between stamps that are close as between those that are not.

    So does one that never changes; of one that is not known at stamps of both kinds, nothing can be said: false.
    """
    change = np.abs(np.diff(signal))
    within, between = change[close & np.isfinite(change)], change[~close & np.isfinite(change)]
    if not len(within) or not len(between):
        return False
    least = _AS_MUCH * np.mean(between)
    error = np.hypot(*(share * np.std(one) / np.sqrt(len(one)) for share, one in ((1.0, within), (_AS_MUCH, between))))
    return bool(np.mean(within) + error >= least)
