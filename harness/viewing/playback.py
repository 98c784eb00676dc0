"""What is to be seen at an instant: the beam's angle, the engine's ball and the recorded ball."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.geometry import Channel, channel_of, to_world
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.viewing.runs import ShownRun

LONGEST_GAP = 0.25  # between two readings between which the recorded ball is drawn [s]
BEYOND = 0.05  # by which the drawn beam is longer than the ball needs [m]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Instant:
    """Beam and balls at one time.

    Attributes:
        time: of the recording [s].
        angle: α of the beam [rad].
        position: of the engine's ball along the beam; NaN before its run begins or after it ends [m].
        spin: angle by which that ball has turned about the y axis [rad].
        recorded: position of the recorded ball; NaN where it is not known [m].
    """

    time: float
    angle: float
    position: float
    spin: float
    recorded: float

    @property
    def error(self) -> float:
        """Engine minus recording [m]; NaN where one of them is not known."""
        return self.position - self.recorded


@dataclass(frozen=True)
class Playback:
    """Runs of an engine and the recording, as functions of time.

    Attributes:
        engine: name of the engine.
        runs: the engine's runs, at least one.
        stamps: of the readings that are known and trusted, shape (m,) [s].
        reading: the positions, shape (m,) [m].
        begin, end: of what is shown [s].
        simulated: whether the recording is simulated, not measured.
    """

    engine: str
    runs: tuple[ShownRun, ...]
    stamps: FloatArray
    reading: FloatArray
    begin: float
    end: float
    simulated: bool

    @property
    def recorded_name(self) -> str:
        """What the recorded ball is, in words."""
        return "recorded (simulated)" if self.simulated else "measured"

    @cached_property
    def channel(self) -> Channel:
        """The beam as it is drawn: from the pivot to where the recorded ball gets, and a little more."""
        low, high = float(self.reading.min()), float(self.reading.max())
        return channel_of(self.runs[0].rig, x_from=min(low, 0.0) - BEYOND, x_to=max(high, 0.0) + BEYOND)

    def at(self, run: int, time: float) -> Instant:
        """Beam and balls of one run at `time` [s]."""
        shown, path = self.runs[run], self._paths[run]
        angle = float(shown.motion.evaluate(np.array([time]))[0])
        rolling = shown.time[0] <= time <= shown.time[-1]
        position, rolled = path(time) if rolling else (math.nan, 0.0)
        return Instant(time, angle, float(position), float(rolled) + angle, self._recorded(time))

    def beyond(self, instant: Instant) -> bool:
        """Whether the engine's ball is off the drawn beam."""
        return not (math.isnan(instant.position) or self.channel.x_from <= instant.position <= self.channel.x_to)

    @cached_property
    def _paths(self) -> Sequence[CubicSpline]:
        return [CubicSpline(one.time, np.column_stack((one.position, one.rolled))) for one in self.runs]

    def _recorded(self, time: float) -> float:
        """Position between two readings [m]; NaN in a gap."""
        after = int(np.searchsorted(self.stamps, time))
        if after < len(self.stamps) and self.stamps[after] == time:
            return float(self.reading[after])
        if after in (0, len(self.stamps)) or self.stamps[after] - self.stamps[after - 1] > LONGEST_GAP:
            return math.nan
        return float(np.interp(time, self.stamps[after - 1 : after + 1], self.reading[after - 1 : after + 1]))


def centre_of(rig: Rig, position: float, angle: float) -> Vector:
    """Centre of a ball at `position` [m] along a beam of angle α [rad], in the world frame [m]."""
    return to_world(position, 0.0, rig.eccentricity + rig.rolling_radius, angle)


def turned_by(spin: float) -> tuple[float, float, float, float]:
    """Quaternion (w, x, y, z) of a turn by `spin` [rad] about the y axis."""
    return math.cos(0.5 * spin), 0.0, math.sin(0.5 * spin), 0.0
