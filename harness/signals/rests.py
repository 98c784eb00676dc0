"""Rests of a beam on the same encoder count, which share one rounding error.

A beam that rests tells no more of its angle than the count, and the error of that stays for as long as it rests. Where
it rests against the same stop again, or where the same command holds it, the error is the same again, and in the next
recording too: six such rests say no more than one, and rests at +3° and at −3°, with opposite errors, look like a gain.

An estimate takes a recording stretch by stretch, with errors that are independent from rest to rest. m rests whose
errors have the m-fold variance each say together as much as one: that is how they are counted. It is right for m equal
errors, and careful where the beam came to rest elsewhere within the count.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from harness.signals.drive import Drive

# Of a count: the standard deviation of an angle at rest is 0.24 to 0.29 (1/√12); it is 0.15 where the beam passes a
# count in ten readings.
_UNRESOLVED = 0.2
_SHORTEST = 3  # stamps

Count = tuple[int, float]
"""Number of a count, and the distance of two counts [rad]."""


def rests(drive: Drive) -> Iterator[tuple[Count, slice]]:
    """Stamps at which the beam rests, by the count; none where noise dithers the rounding."""
    resolution = drive.sensor.resolution
    if not drive.sensor.rounded:
        return
    counts = np.rint(drive.states[:, 0] / resolution).astype(int)
    unresolved = drive.std[:, 0] > _UNRESOLVED * resolution
    for (resting, count), group in groupby(range(len(counts)), key=lambda k: (bool(unresolved[k]), int(counts[k]))):
        stamps = list(group)
        if resting and len(stamps) >= _SHORTEST:
            yield (count, resolution), slice(stamps[0], stamps[-1] + 1)


def with_repeats(drives: Sequence[Drive]) -> list[Drive]:
    """The same drives of one rig, which know how often the beam comes to rest on the same count in all of them."""
    found = [list(rests(drive)) for drive in drives]
    often = Counter(count for each in found for count, _ in each)
    known = []
    for drive, each in zip(drives, found, strict=True):
        repeats = np.ones(len(drive.time))
        for count, stamps in each:
            repeats[stamps] = often[count]
        known.append(replace(drive, repeats=repeats) if repeats.max(initial=1.0) > 1.0 else drive)
    return known
