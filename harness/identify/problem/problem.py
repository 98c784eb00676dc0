"""What identification works on: recordings with their drives, the rig, what is declared, the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.effects import Acting, motion_with, parameters_with
from analytic.kernel import Grid
from analytic.models import CAM, ORIGIN, Model
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig
from harness.identify.filter.ekf import (
    BeamTable,
    Readings,
    Sensor,
    extended_kalman_filter,
    negative_two_log_likelihood,
)
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.problem.spline_term import Shape
from harness.signals.drive import Drive
from harness.signals.prescribed import nodes

_FLOOR_SPAN, _FLOOR_DRAWS = 0.5, 16  # [s]: longer than the angle's error is correlated, shorter than the ball's moves
_LONGEST_STEP = 1e-2  # [s]: leaves 2e-6 m in 10 s even where the ball stops and turns, a hundredth of any sensor


@dataclass(frozen=True)
class Shifted:
    """A beam motion that is `delay` [s] late; before it began it stands."""

    base: BeamMotion
    delay: float
    begin: float
    end: float

    def _then(self, time: FloatArray) -> FloatArray:
        return np.clip(time - self.delay, self.begin, self.end)

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.base.angle(self._then(time))

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return self.base.rate(self._then(time))

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return self.base.acceleration(self._then(time))


@dataclass(frozen=True)
class Record:
    """One recording: stamps, shape (n,) [s]; readings of the position, NaN where there is none that counts [m]."""

    name: str
    time: FloatArray
    reading: FloatArray
    drive: Drive

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
        delays = [one.values["delay"] for one in effects if one.effect.name == "channel_delay"]
        delay = sum(delays)
        if delay == 0.0 and not any(one.effect.turn is not None for one in effects):
            return self.table
        motion = motion_with(self.drive, self.time, effects)
        if delay != 0.0:
            motion = Shifted(motion, delay, float(self.time[0]), float(self.time[-1]))
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
class Filtered:
    """A recording through the filter.

    Attributes:
        innovation, innovation_variance: shape (n,) [m], [m²].
        state: filtered s [m], ṡ [m/s], what effects remember, and the lagging position [m], shape (n, 4).
        position_variance: of the position that the sensor sees, shape (n,) [m²].
        gain, lag: of the sensor [1], [s].
    """

    innovation: FloatArray
    innovation_variance: FloatArray
    state: FloatArray
    position_variance: FloatArray
    gain: float
    lag: float

    @property
    def recorded(self) -> FloatArray:
        """What the sensor would record of the filtered state, shape (n,) [m]."""
        return self.gain * self.state[:, 3 if self.lag > 0.0 else 0]


@dataclass(frozen=True)
class Problem:
    """Recordings of one rig.

    Attributes:
        records: at least one, each with positions.
        rig: complete.
        declared: effects known to act.
        noise: variance of a position reading, rounding included [m²].
        model: the baseline to which effects are added.
        unknown: effects that stand for what nobody knows of the rig; every hypothesis has them, and none is a finding.
        settings: by which everything is decided.
    """

    records: tuple[Record, ...]
    rig: Rig
    declared: tuple[Acting, ...]
    noise: float
    model: Model = CAM
    unknown: tuple[str, ...] = ()
    settings: Settings = DEFAULT

    @property
    def readings(self) -> int:
        """Number of readings that count."""
        return sum(int(np.isfinite(record.reading).sum()) for record in self.records)

    @cached_property
    def angle_floor(self) -> float:
        """Root density of the acceleration that the angle's own error gives [m/s² per √Hz], from the drive's draws.

        It is what the process noise of a model that lacks nothing comes to.
        """
        densities = []
        for record in self.records:
            step = float(np.median(np.diff(record.time)))
            span = max(int(_FLOOR_SPAN / step), 1)
            for path in record.drive.draw(_FLOOR_DRAWS, seed=0):
                error = path.states[:, 0] - record.drive.states[:, 0]
                turned = np.cumsum(error) * step
                densities.append(np.mean((turned[span::span] - turned[:-span:span]) ** 2) / (span * step))
        return self.rig.gravity * self.rig.rolling_ratio * float(np.sqrt(np.mean(densities)))

    def sensor(self, effects: Sequence[Acting]) -> tuple[float, float]:
        """Gain [1] and lag [s] of the position sensor with `effects` beside those declared."""
        values = {one.effect.name: one.values for one in (*self.declared, *effects)}
        gain = values.get("position_gain", {}).get("gain", 1.0)
        return gain, values.get("position_lag", {}).get("time_constant", 0.0)

    def dynamics(
        self, record: Record, effects: Sequence[Acting], phase: float, shape: Shape | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """The kernel's vector, shape (SLOTS,), and the beam's table of one recording; arguments as of `filtered`."""
        every = phased((*self.declared, *effects), phase)
        p = parameters_with(self.model, self.rig, every)
        p[ORIGIN] = record.origin / self.sensor(effects)[0]
        table = record.table_with(every)
        if shape is not None:
            shape.write(p, phase)
            table = shape.load(table, record.times, self.rig.gravity)
        return p, table

    def filtered(
        self,
        record: Record,
        effects: Sequence[Acting],
        phase: float,
        density: float,
        shape: Shape | None = None,
        reading: FloatArray | None = None,
    ) -> Filtered:
        """One recording through the filter.

        Args:
            effects: beside those declared.
            phase: φ₀, how the ball lies at the recording's start, where it matters [rad].
            density: of the process noise [m²/s³].
            shape: a curve of unknown law beside them.
            reading: other readings than the record's, shape (n,), NaN where there is none [m].
        """
        gain, lag = self.sensor(effects)
        p, table = self.dynamics(record, effects, phase, shape)
        readings = Readings(record.time, record.reading if reading is None else reading)
        beam = BeamTable(record.grid.steps, record.grid.marks, table)
        out = extended_kalman_filter(readings, beam, p, Sensor(gain, lag, self.noise), density)
        return Filtered(*out, gain, lag)

    def predict(
        self, effects: Sequence[Acting], phases: FloatArray, density: float, shape: Shape | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Innovations over all recordings and their variances, both of shape (readings,) [m], [m²]."""
        innovations, variances = [], []
        for record, phase in zip(self.records, phases, strict=True):
            found = self.filtered(record, effects, float(phase), density, shape)
            innovations.append(found.innovation[record.judged])
            variances.append(found.innovation_variance[record.judged])
        return np.concatenate(innovations), np.concatenate(variances)

    def deviance(
        self, effects: Sequence[Acting], phases: FloatArray, density: float, shape: Shape | None = None
    ) -> float:
        """−2 log likelihood of the innovations, but for a constant."""
        each = zip(self.records, phases, strict=True)
        return sum(self.deviance_of(record, effects, float(phase), density, shape) for record, phase in each)

    def deviance_of(
        self, record: Record, effects: Sequence[Acting], phase: float, density: float, shape: Shape | None = None
    ) -> float:
        """−2 log likelihood of one recording's innovations, but for a constant."""
        found = self.filtered(record, effects, phase, density, shape)
        use = record.judged
        return negative_two_log_likelihood(found.innovation[use], found.innovation_variance[use])


def phased(effects: Sequence[Acting], phase: float) -> tuple[Acting, ...]:
    """The same effects on a ball that lies at φ₀ = `phase` at the start [rad]."""
    return tuple(
        Acting(one.effect, {**one.values, "phase": phase}) if one.effect.name == "ball_imbalance" else one
        for one in effects
    )
