"""Whether the beam turns far between two readings of its angle, which then do not tell where it was meanwhile.

Each reading is compared with a cubic through two neighbours on either side. Of a beam that moves smoothly it is off by
little of the swing; of one that turns faster than it is sampled, by most of it, as the neighbours know nothing of it.
White noise of the angle does the same, but moves no ball: what is declared of it is taken off, and what counts is how
far the ball would be off a second later, if the beam were off as much from reading to reading.

A command that a controller computes from each reading jumps from row to row as well, and is known in between. Where it
answers the position of its own row it is told (`harness.recording.commanded`), and nothing is said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from analytic.motion import FloatArray
from harness.recording.commanded import answers_readings
from harness.recording.findings import DataFinding, abbreviated
from harness.recording.known_rig import Sensors
from harness.recording.plausibility import STANDARD_GRAVITY, USUAL_SLOPE
from harness.recording.recording import Recording

_SIDE = 2  # neighbours on either side
_FEWEST = 20  # readings that are compared
_EVEN = (0.5, 2.0)  # median intervals: across others a cubic tells nothing
# Share of the swing, and the ball's way within a second [m], beyond which some of what is named does not act, and
# beyond which readings of the angle know nothing of each other (docs/diagnosis_experiments.md).
_WARNED, _STOPPED = (0.1, 0.005), (0.9, 0.030)


class Between(NamedTuple):
    """What the angle does between its readings.

    Attributes:
        share: root mean square of a reading about the cubic through its neighbours, over that about their mean [1].
        way: how far a ball would be off after a second [m].
    """

    share: float
    way: float

    def beyond(self, limits: tuple[float, float]) -> bool:
        """Whether both are larger than these limits."""
        return self.share > limits[0] and self.way > limits[1]


def slow_angle_findings(recordings: Mapping[str, Recording], sensors: Sensors) -> Iterator[DataFinding]:
    """A warning of recordings of a beam that turns far between its readings, and one of those that it makes useless.

    Args:
        recordings: of one rig, by name.
        sensors: of the rig.
    """
    declared = math.hypot(sensors.angle_noise or 0.0, (sensors.angle_resolution or 0.0) / math.sqrt(12.0))
    found = {name: between_readings(one.time, one.angle, declared) for name, one in recordings.items()}
    warned = {name: one for name, one in found.items() if one.beyond(_WARNED)}
    if not warned or answers_readings(recordings.values()):
        return
    stopped = {name: one for name, one in warned.items() if one.beyond(_STOPPED)}
    others = {name: one for name, one in warned.items() if name not in stopped}
    if stopped:
        yield DataFinding("warning", abbreviated(list(stopped)), f"{_told(recordings, stopped)}.", "undersampled-angle")
    if others:
        text = (
            f"{_told(recordings, others)}. Until then, do not rely on what tells a delay from a lag or a hold, nor on "
            "a force that grows with the position, such as a bending beam's: it may be the centrifugal one of turns "
            "that were not seen."
        )
        yield DataFinding("warning", abbreviated(list(others)), text, "slow-angle")


def _told(recordings: Mapping[str, Recording], found: Mapping[str, Between]) -> str:
    """What was seen in these recordings, and the remedy."""
    rate = min(1.0 / float(np.median(np.diff(recordings[name].time))) for name in found)
    share, way = (max(getattr(one, key) for one in found.values()) for key in Between._fields)
    return (
        f"the beam turns far between readings of its angle, which come {rate:.3g} times a second: they are off from "
        f"what their neighbours tell by up to {100.0 * share:.0f} % of the swing, enough to move a ball by "
        f"{1e3 * way:.0f} mm within a second. Record the angle at least three times as often, or move the beam more "
        "slowly; if it is noise of the sensor, say so by angle_noise_rad in [sensors]"
    )


def between_readings(time: FloatArray, angle: FloatArray, noise: float = 0.0) -> Between:
    """What the angle does between its readings.

    Args:
        time: strictly increasing, shape (n,) [s].
        angle: shape (n,) [rad].
        noise: standard deviation of a reading of it, as far as it is known [rad].
    """
    inner = np.arange(_SIDE, len(time) - _SIDE)
    if len(inner) < _FEWEST or np.ptp(angle) == 0.0:
        return Between(0.0, 0.0)
    neighbours = inner[:, None] + np.array([-2, -1, 1, 2])
    t = time[neighbours] - time[inner, None]
    weights = np.ones_like(t)
    for j in range(t.shape[1]):  # Lagrange's polynomials of the neighbours, at the reading
        for other in range(t.shape[1]):
            if other != j:
                weights[:, j] *= -t[:, other] / (t[:, j] - t[:, other])
    off = angle[inner] - (weights * angle[neighbours]).sum(axis=1)
    interval = float(np.median(np.diff(time)))
    gaps = np.diff(np.insert(t, _SIDE, 0.0, axis=1), axis=1) / interval
    even = ((gaps > _EVEN[0]) & (gaps < _EVEN[1])).all(axis=1)
    if even.sum() < _FEWEST:
        return Between(0.0, 0.0)
    of_noise = noise**2 * (1.0 + float(np.mean((weights[even] ** 2).sum(axis=1))))
    size = math.sqrt(max(float(np.mean(off[even] ** 2)) - of_noise, 0.0))
    # An error of each interval h by itself, as white noise of the acceleration, moves a ball by K g √(h/3) within 1 s.
    return Between(size / float(angle.std()), USUAL_SLOPE * STANDARD_GRAVITY * size * math.sqrt(interval / 3.0))
