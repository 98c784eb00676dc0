"""Rests of a beam on the same encoder count, which share one rounding error.

A beam that rests tells no more of its angle than the count, and the error of that stays for as long as it rests. Where
it rests against the same stop again, or where the same command holds it, the error is the same again, and in the next
recording too: six such rests say no more than one, and rests at +3° and at −3°, with opposite errors, look like a gain.
A command that a controller limits comes back to its limit without resting there, for two readings or for one: each
visit has the same error again.

An estimate takes a recording stretch by stretch, with errors that are independent from rest to rest. m rests whose
errors have the m-fold variance each say together as much as one: that is how they are counted. It is right for m equal
errors, and careful where the beam came to rest elsewhere within the count.

Where readings scatter about a smooth motion for another reason, stamps that are wrong or a command that is held, the
scatter is taken for noise, which averages out. A beam at rest shows that its rounding does not: many readings in a row
on one count, which such noise would not give.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TypeVar

import numpy as np

from harness.signals.drive import Drive

# Of a count: the standard deviation of an angle at rest is 0.24 to 0.29 (1/√12); it is 0.15 where the beam passes a
# count in ten readings.
_UNRESOLVED = 0.2
_SHORTEST = 3  # stamps
_BY_NOISE = 1e-3  # probability that noise gives readings on one count for so long; some hundred runs are looked at
# Readings on the outermost count over those on any of the next ones. A sine that turns at the far edge of its outermost
# count is there √1/(√2 − √1) = 2.4 times as often as on the next; one that is cut off more often.
_CUT_OFF, _NEXT = 4.0, 3  # the second: counts beside the outermost one

T = TypeVar("T")
Count = tuple[float, float]
"""Number of a count, and the distance of two counts [rad]."""


def rests(drive: Drive) -> Iterator[tuple[Count, slice]]:
    """Stamps at which the beam rests, by the count; where noise dithers the rounding, none but those it cannot give."""
    sensor = drive.sensor
    if sensor.resolution == 0.0:
        return
    if sensor.rounded:
        counts = np.rint(drive.states[:, 0] / sensor.resolution).tolist()
        unresolved = (drive.std[:, 0] > _UNRESOLVED * sensor.resolution).tolist()
        least = _SHORTEST
    else:
        counts, unresolved = _read(drive), [True] * len(drive.time)
        on_one = math.erf(0.5 * sensor.resolution / (math.sqrt(2.0) * sensor.noise))  # of two readings, at the most
        least = max(_SHORTEST, 1 + math.ceil(math.log(_BY_NOISE) / math.log(on_one)))
    for (resting, count), stamps in _runs(zip(unresolved, counts, strict=True)):
        if resting and stamps.stop - stamps.start >= least:
            yield (count, sensor.resolution), stamps


def limits(drives: Sequence[Drive]) -> set[Count]:
    """Counts at which the angle is cut off: its outermost ones in all recordings, if far more readings are on them than
    on those next to them."""
    often: Counter[Count] = Counter()
    for drive in drives:
        often.update((number, drive.sensor.resolution) for number in _read(drive) if math.isfinite(number))
    found = set()
    for resolution in {resolution for _, resolution in often}:
        counts = [count for count, its in often if its == resolution]
        for outermost, inwards in ((max(counts), -1), (min(counts), 1)):
            beside = max(often[outermost + inwards * k, resolution] for k in range(1, _NEXT + 1))
            if often[outermost, resolution] >= _CUT_OFF * max(beside, 1):
                found.add((outermost, resolution))
    return found


def visits(drive: Drive, limits: set[Count]) -> Iterator[tuple[Count, slice]]:
    """Stamps at which the angle is read on one of these counts, visit by visit.

    Limits to both sides that are as large have opposite errors, and say no more of a gain than one: both bear the
    number of the positive one.
    """
    resolution = drive.sensor.resolution
    for number, stamps in _runs(_read(drive)):
        if (number, resolution) in limits:
            yield (abs(number) if (-number, resolution) in limits else number, resolution), stamps


def with_shared_rounding(drives: Sequence[Drive]) -> list[Drive]:
    """The same drives of one rig, which know what their errors share where the beam comes to the same count again in
    any of them, to rest there or because its angle is limited.

    Limits count where scatter is taken for noise. Where rounding alone limits the readings, rests say as much, and
    short visits are resolved by the motion around them.
    """
    at = limits(drives)
    found = [
        list(rests(one))
        if one.sensor.rounded
        else [*(each for each in rests(one) if each[0] not in at), *visits(one, at)]
        for one in drives
    ]
    often = Counter(count for each in found for count, _ in each)
    known = []
    for drive, each in zip(drives, found, strict=True):
        variance, inflation = drive.std[:, 0] ** 2, np.ones(len(drive.time))
        rounding = drive.sensor.resolution**2 / 12.0
        for count, stamps in each:
            own = variance[stamps]
            shared = np.minimum(own, rounding) if drive.sensor.rounded else rounding
            inflation[stamps] = (np.maximum(own, shared) + (often[count] - 1) * shared) / own
        known.append(replace(drive, inflation=inflation) if inflation.max(initial=1.0) > 1.0 else drive)
    return known


def _read(drive: Drive) -> list[float]:
    """Number of the count that is read at each stamp, NaN where none is; empty for a continuous angle."""
    resolution = drive.sensor.resolution
    return np.rint(drive.reading / resolution).tolist() if resolution > 0.0 else []


def _runs(values: Iterable[T]) -> Iterator[tuple[T, slice]]:
    """Each value with the stamps at which it stands in a row."""
    for value, group in groupby(enumerate(values), key=lambda numbered: numbered[1]):
        stamps = [k for k, _ in group]
        yield value, slice(stamps[0], stamps[-1] + 1)
