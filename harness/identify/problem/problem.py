"""What identification works on: recordings with their drives, the rig, what is declared, the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.effects import Acting, motion_with, sensor_with
from analytic.kernel import Grid
from analytic.models import CAM, Model
from analytic.motion import DelayedMotion, FloatArray
from analytic.rig import Rig
from harness.identify.problem.settings import DEFAULT, Settings
from harness.preparation.recordings import Observed
from harness.signals.drive import Drive
from harness.signals.prescribed import nodes

_FLOOR_SPAN, _FLOOR_DRAWS = 0.5, 16  # [s]: longer than the angle's error is correlated, shorter than the ball's moves
_LONGEST_STEP = 1e-2  # [s]: leaves 2e-6 m in 10 s even where the ball stops and turns, a hundredth of any sensor


@dataclass(frozen=True)
class PreparedRecording:
    """One recording: stamps, shape (n,) [s]; readings of the position, NaN where there is none that counts [m]."""

    name: str
    time: FloatArray
    reading: FloatArray
    drive: Drive

    @classmethod
    def of(cls, observed: Observed) -> PreparedRecording:
        """From a prepared recording, under the recording's name."""
        return cls(observed.recording.name, np.array(observed.recording.time), observed.reading, observed.drive)

    @cached_property
    def grid(self) -> Grid:
        """Integration steps between the stamps."""
        return Grid.over(self.time, _LONGEST_STEP)

    @cached_property
    def table(self) -> FloatArray:
        """The beam's motion as measured, on the grid."""
        return self.grid.tabulate(self.drive)

    @cached_property
    def times(self) -> FloatArray:
        """Times of the table's rows [s]."""
        return nodes(self.grid)

    def table_with(self, effects: Sequence[Acting]) -> FloatArray:
        """The beam's motion on the grid when `effects` act on the angle, or delay the position against it."""
        delay = sensor_with(effects).delay
        if delay == 0.0 and all(one.effect.turn is None and one.effect.transmission is None for one in effects):
            return self.table
        motion = motion_with(self.drive, self.time, effects)
        if delay != 0.0:
            motion = DelayedMotion(motion, delay, float(self.time[0]), float(self.time[-1]))
        return self.grid.tabulate(motion)

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Readings that are predicted: all but the first, which starts the filter."""
        use = np.isfinite(self.reading)
        use[np.argmax(use)] = False
        return use

    @property
    def origin(self) -> float:
        """Position from which the rolled angle is counted: the first one known [m]."""
        return float(self.reading[np.isfinite(self.reading)][0])


@dataclass(frozen=True)
class Problem:
    """Recordings of one rig.

    Attributes:
        recordings: at least one, each with positions.
        rig: complete.
        declared: effects known to act.
        reading_variance: variance of a position reading, rounding included [m²].
        model: the baseline to which effects are added.
        unknown: effects that stand for what nobody knows of the rig; every hypothesis has them, and none is a finding.
        settings: by which everything is decided.
    """

    recordings: tuple[PreparedRecording, ...]
    rig: Rig
    declared: tuple[Acting, ...]
    reading_variance: float
    model: Model = CAM
    unknown: tuple[str, ...] = ()
    settings: Settings = DEFAULT

    @classmethod
    def of(
        cls, observed: Sequence[Observed], rig: Rig, declared: tuple[Acting, ...], unknown: tuple[str, ...] = ()
    ) -> Problem:
        """From prepared recordings, whose variances of a reading are averaged."""
        variance = float(np.mean([one.noise**2 for one in observed]))
        return cls(tuple(map(PreparedRecording.of, observed)), rig, declared, variance, unknown=unknown)

    @property
    def readings(self) -> int:
        """Number of readings that count."""
        return sum(int(np.isfinite(record.reading).sum()) for record in self.recordings)

    @cached_property
    def visited(self) -> FloatArray:
        """All positions that were read, shape (readings,) [m]."""
        return np.concatenate([record.reading[np.isfinite(record.reading)] for record in self.recordings])

    @cached_property
    def angle_floor(self) -> float:
        """Root density of the acceleration that the angle's own error gives [m/s² per √Hz], from the drive's draws.

        It is what the process noise of a model that lacks nothing comes to.
        """
        process_noises = []
        for record in self.recordings:
            step = float(np.median(np.diff(record.time)))
            span = max(int(_FLOOR_SPAN / step), 1)
            for path in record.drive.draw(_FLOOR_DRAWS, seed=0):
                error = path.states[:, 0] - record.drive.states[:, 0]
                turned = np.cumsum(error) * step
                process_noises.append(np.mean((turned[span::span] - turned[:-span:span]) ** 2) / (span * step))
        return self.rig.gravity * self.rig.rolling_ratio * float(np.sqrt(np.mean(process_noises)))

    def sensor(self, effects: Sequence[Acting]) -> tuple[float, float]:
        """Gain [1] and lag [s] of the position sensor with `effects` beside those declared."""
        law = sensor_with((*self.declared, *effects))
        return law.gain, law.lag
