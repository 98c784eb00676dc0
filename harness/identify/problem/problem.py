"""The problem to be identified: recordings with their drives, the rig, its known effects, the reading variance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.effects import (
    Acting,
    Follower,
    SensorLaw,
    Transmission,
    followers_with,
    motion_with,
    sensor_with,
    transmission_with,
)
from analytic.kernel import Grid
from analytic.models import CAM, Model
from analytic.motion import DelayedMotion, FloatArray, ScaledMotion
from analytic.rig import Rig
from harness.identify.problem.settings import DEFAULT, Settings
from harness.numerics import evenly_chosen
from harness.preparation.recordings import Observed, observe
from harness.recording import Recording, Sensors
from harness.signals.drive import Drive
from harness.signals.error_process import ErrorProcess
from harness.signals.follower_error import behind_follower
from harness.signals.play_error import behind_play
from harness.signals.rests import with_shared_rounding
from harness.signals.sparse_drive import sparse

_CELL = 0.04  # of thinned recordings, and of free runs over them, whose errors are centimetres [s]
_QUICK_LENGTH = 60.0  # of the recordings of a quick search [s]: effects far above the noise show in a minute
_FEWEST_OF_EACH = 50  # readings of the beginning of a recording
_ROUNDING = 1e-6  # of a cell: stamps are not exact multiples of the sampling interval
_TABLES = 8  # of a recording that are kept: of a fit and of its differences by two parameters, in two threads
_LONGEST_STEP = 1e-2  # [s]: error 2e-6 m in 10 s even where the ball reverses, a hundredth of any sensor's noise


def filtered_against(reading: FloatArray) -> NDArray[np.bool_]:
    """Mask of the readings that the filter predicts, shape (n,): all but the first, which initialises it."""
    use = np.isfinite(reading)
    use[np.argmax(use)] = False
    return use


@dataclass(frozen=True)
class Moving:
    """What moves the beam otherwise than measured, and a delay of the position, which looks alike.

    Attributes:
        gain: by which the motion is multiplied in the end [1]; of no weight where two are compared.
        names: of `effects`, with their values.
        delay: of the position [s].
        effects: those that do anything else to the motion than that gain.
    """

    gain: float = field(compare=False)
    names: tuple[tuple[object, ...], ...]
    delay: float
    effects: tuple[Acting, ...] = field(compare=False)

    @classmethod
    def by(cls, effects: Sequence[Acting]) -> Moving:
        """What `effects` do of that: among what is linear, a gain may come last, and change no table but its scale."""
        moving, gain = tuple(one for one in effects if one.effect.moves_beam), 1.0
        through = transmission_with(moving)
        linear = all(one.effect.transmission is not None or one.effect.follower is not None for one in moving)
        if linear and through.play == 0.0:
            moving, gain = tuple(one for one in moving if one.effect.follower is not None), through.gain
        names = tuple((one.effect.name, *one.values.items()) for one in moving)
        return cls(gain, names, sensor_with(effects).delay, moving)


@dataclass(frozen=True)
class PreparedRecording:
    """One recording.

    Attributes:
        time: stamps, shape (n,) [s].
        reading: position readings, NaN where missing or an outlier, shape (n,) [m].
        drive: the beam's motion, over these stamps or longer.
        longest_step: of the integration [s].
        error_of: effects through which the angle's error passes whatever else acts (`error_with`); None for those that
            act.
    """

    name: str
    time: FloatArray
    reading: FloatArray
    drive: Drive
    longest_step: float = _LONGEST_STEP
    error_of: tuple[Acting, ...] | None = None

    @classmethod
    def of(cls, observed: Observed) -> PreparedRecording:
        """From a prepared recording, under its name: at the stamps of the readings used (`UsedReadings`)."""
        used, time = observed.used, np.array(observed.recording.time)
        drive = sparse(observed.drive, used.every)
        return cls(observed.recording.name, time[used.stamps], used.position[used.stamps], drive)

    @classmethod
    def at_all_stamps(cls, observed: Observed) -> PreparedRecording:
        """The same readings among all stamps of the recording, for a prediction at each of them."""
        time = np.array(observed.recording.time)
        return cls(observed.recording.name, time, observed.used.position, observed.drive)

    @cached_property
    def grid(self) -> Grid:
        """Integration grid: the steps between the stamps."""
        return Grid.over(self.time, self.longest_step)

    @cached_property
    def table(self) -> FloatArray:
        """α, α̇, α̈ of the measured beam motion on the grid of m steps, shape (2 m + 1, 3) [rad, s]."""
        return self.grid.tabulate(self.drive)

    @cached_property
    def times(self) -> FloatArray:
        """Times of the table's rows, shape (2 m + 1,) [s]."""
        return self.grid.edges

    def moved_table(self, moving: Moving) -> FloatArray:
        """`table`, same shape, where effects change the beam motion or delay the recorded position."""
        table = self._tabulated(moving) if moving.names or moving.delay != 0.0 else self.table
        return table if moving.gain == 1.0 else moving.gain * table

    @cached_property
    def _tabulated(self) -> Callable[[Moving], FloatArray]:
        """The table of a moved beam; the latest are kept, since most fits change anything but that from run to run."""

        def tabulated(moving: Moving) -> FloatArray:
            stamps = self.drive.time  # a part of a recording began with the whole
            motion = motion_with(self.drive, stamps, moving.effects)
            if moving.delay != 0.0:
                motion = DelayedMotion(motion, moving.delay, float(stamps[0]), float(stamps[-1]))
            return self.grid.tabulate(motion)

        return lru_cache(maxsize=_TABLES)(tabulated)

    def __getstate__(self) -> dict[str, Any]:
        """Its fields: what is computed from them and kept is computed anew where it is unpickled."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def rougher(self, factor: float) -> PreparedRecording:
        """The same with a rougher motion of the beam (`Drive.rougher`)."""
        return self if factor == 1.0 else replace(self, drive=self.drive.rougher(factor))

    @cached_property
    def thinned(self) -> PreparedRecording:
        """Mean readings of cells of 40 ms, at their mean stamps: free runs differ from readings slowly.

        On a ball that accelerates by 1 m/s² the mean position is off by 0.07 mm from that at the mean time.
        """
        known = np.isfinite(self.reading)
        time, reading = self.time[known], self.reading[known]
        _, cell = np.unique(np.floor(time / _CELL + _ROUNDING), return_inverse=True)
        count = np.bincount(cell)
        return PreparedRecording(
            self.name, np.bincount(cell, time) / count, np.bincount(cell, reading) / count, self.drive, _CELL
        )

    @cached_property
    def coarse(self) -> PreparedRecording:
        """The first reading of each cell of 40 ms, with as long steps of the integration."""
        known = np.flatnonzero(np.isfinite(self.reading))
        _, first = np.unique(np.floor(self.time[known] / _CELL + _ROUNDING), return_index=True)
        kept = known[first]
        return PreparedRecording(self.name, self.time[kept], self.reading[kept], self.drive, _CELL)

    def beginning(self, count: int) -> PreparedRecording:
        """Its first `count` known readings."""
        stop = int(np.flatnonzero(np.isfinite(self.reading))[:count][-1]) + 1
        return PreparedRecording(self.name, self.time[:stop], self.reading[:stop], self.drive, self.longest_step)

    @cached_property
    def error(self) -> ErrorProcess:
        """The error of the measured angle at the stamps, which are stamps of the drive."""
        return self._at_stamps(self.drive.error)

    @cached_property
    def shared_error(self) -> ErrorProcess:
        """The same for an estimate from all recordings, which rests on one count inform once (`Drive.shared_error`)."""
        return self.error if self.drive.inflation is None else self._at_stamps(self.drive.shared_error)

    @cached_property
    def _behind(self) -> Callable[[Transmission, tuple[Follower, ...], float, bool], ErrorProcess]:
        """`error`, or `shared_error`, behind a play and what smooths it; the latest are kept, as tables are."""

        def behind(through: Transmission, followers: tuple[Follower, ...], delay: float, shared: bool) -> ErrorProcess:
            stamps = self.drive.time
            error = (self.drive.shared_error if shared else self.drive.error).scaled(through.gain)
            if through.play > 0.0:
                error = behind_play(error, ScaledMotion(self.drive, through.gain), stamps, through.play, delay)
            for follower in followers:
                error = behind_follower(error, stamps, follower)
            return self._at_stamps(error)

        return lru_cache(maxsize=_TABLES)(behind)

    def _at_stamps(self, error: ErrorProcess) -> ErrorProcess:
        stamps = np.searchsorted(self.drive.time, self.time)
        if stamps[-1] - stamps[0] == len(stamps) - 1:
            return error.between(int(stamps[0]), int(stamps[-1]) + 1)
        return error.at(stamps)

    def error_with(self, effects: Sequence[Acting], *, shared: bool = False) -> ErrorProcess:
        """`error`, or `shared_error`, of the beam's angle, where `effects` stand between it and the measured one.

        To first order: a gain multiplies the error, and what a delay of the position shifts it by is short against the
        time over which its variance changes. Behind a play or a lag it is another one (`behind_play`,
        `behind_follower`). A command has no error behind them either.
        """
        if self.drive.commanded:
            return self.error
        effects = effects if self.error_of is None else self.error_of
        through, followers = transmission_with(effects), followers_with(effects)
        if through.play > 0.0 or followers:
            return self._behind(through, followers, sensor_with(effects).delay, shared)
        error = self.shared_error if shared else self.error
        return error if through.gain == 1.0 else error.scaled(through.gain)

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Mask of the readings that the filter predicts, shape (n,)."""
        return filtered_against(self.reading)

    @cached_property
    def origin(self) -> float:
        """Position at which the rolled angle is φ₀: the first reading [m]."""
        return float(self.reading[np.isfinite(self.reading)][0])


@dataclass(frozen=True)
class Colour:
    """What of the reading noise is coloured: a first-order Gauss–Markov process, e^(−|Δt|/τ) correlated.

    Attributes:
        share: of the variance of a reading; 0 for white noise [1].
        time: correlation time τ [s].
    """

    share: float = 0.0
    time: float = 1.0


WHITE = Colour()


@dataclass(frozen=True)
class Problem:
    """Recordings of one rig, with what is known of it.

    Attributes:
        recordings: at least one, each with positions.
        rig: with values for all quantities.
        declared: known effects, part of every model.
        reading_variance: of one of the recordings' position readings, which may be means, quantisation included [m²].
        model: the baseline model to which effects are added.
        unknown: stand-ins for unknown rig quantities; in every hypothesis, never reported as found.
        settings: of the identification.
        colour: of the reading noise.
        roughness: factor on the density of the beam's third derivative that the angle readings tell [1].
        noise_share: of the scatter of the angle's readings: what of it is an error, by which they are smoothed [1].
        held_command: whether the angle is a command that is held from stamp to stamp.
        readings_in_mean: how many readings make one that `reading_variance` is of.
    """

    recordings: tuple[PreparedRecording, ...]
    rig: Rig
    declared: tuple[Acting, ...]
    reading_variance: float
    model: Model = CAM
    unknown: tuple[str, ...] = ()
    settings: Settings = DEFAULT
    colour: Colour = WHITE
    roughness: float = 1.0
    noise_share: float = 1.0
    held_command: bool = False
    readings_in_mean: int = 1

    @classmethod
    def of(
        cls, observed: Sequence[Observed], rig: Rig, declared: tuple[Acting, ...], unknown: tuple[str, ...] = ()
    ) -> Problem:
        """From prepared recordings, whose variances of a reading, and numbers of readings in a mean, are averaged."""
        variance = float(np.mean([one.used.noise**2 for one in observed]))
        in_mean = round(float(np.mean([one.used.every for one in observed])))
        recordings = _knowing_rests([PreparedRecording.of(one) for one in observed])
        return cls(recordings, rig, declared, variance, unknown=unknown, readings_in_mean=in_mean)

    def rougher(self, factor: float) -> Problem:
        """The same recordings with a beam that moves more roughly than in this problem (`Drive.rougher`)."""
        if factor == 1.0:
            return self
        recordings = _knowing_rests([one.rougher(factor) for one in self.recordings])
        return replace(self, recordings=recordings, roughness=factor * self.roughness)

    def observed(self, recording: Recording, sensors: Sensors) -> Observed:
        """Another recording, as those of this problem are prepared.

        Raises:
            InputError: as of `observe`.
        """
        return observe(recording, sensors, self.rig, self.noise_share, held_command=self.held_command)

    def quieter(self, share: float) -> Problem:
        """The same recordings with an angle of which only `share` of the scatter is an error (`Drive.quieter`)."""
        if share == 1.0:
            return self
        recordings = _knowing_rests([replace(one, drive=one.drive.quieter(share)) for one in self.recordings])
        return replace(self, recordings=recordings, noise_share=share * self.noise_share)

    @property
    def readings(self) -> int:
        """Number of readings n."""
        return sum(int(np.isfinite(recording.reading).sum()) for recording in self.recordings)

    @property
    def least_gain(self) -> float:
        """Decrease of the deviance [1] from which on one more parameter is kept: its price in the BIC and `keep`."""
        return self.settings.keep + math.log(self.readings)

    @property
    def steps(self) -> int:
        """Number of integration steps of one run over all recordings."""
        return sum(len(recording.grid.steps) for recording in self.recordings)

    @cached_property
    def coarse(self) -> Problem:
        """The same with coarse recordings, of at most a minute altogether but two of them, for a quick search."""
        recordings = self.recordings
        mean = float(np.mean([one.time[-1] - one.time[0] for one in recordings]))
        chosen = evenly_chosen(recordings, max(int(_QUICK_LENGTH / mean), 2))
        return replace(self, recordings=tuple(one.coarse for one in chosen))

    def beginning(self, readings: int) -> Problem:
        """The same with the first known readings of each recording, about so many in all, at least 50 of each."""
        count = max(readings // len(self.recordings), _FEWEST_OF_EACH)
        return replace(self, recordings=tuple(one.beginning(count) for one in self.recordings))

    @cached_property
    def visited(self) -> FloatArray:
        """All position readings, shape (readings,) [m]."""
        return np.concatenate([recording.reading[np.isfinite(recording.reading)] for recording in self.recordings])

    @cached_property
    def angle_floor(self) -> float:
        """Input-noise floor: root density of the acceleration due to the angle error [m/s² per √Hz]."""
        density = float(np.mean([recording.drive.error_densities for recording in self.recordings]))
        return self.rig.gravity * self.rig.rolling_ratio * math.sqrt(density)

    @property
    def least_process_noise(self) -> float:
        """Lower bound of the process noise, at which it changes no innovation [m²/s³]."""
        return (self.settings.noise_floor_share * self.angle_floor) ** 2

    def with_angle(self, process_noise: float) -> float:
        """Process noise that contains the angle error, for a motion that is only planned [m²/s³]."""
        return process_noise + self.angle_floor**2

    def sensor(self, effects: Sequence[Acting]) -> SensorLaw:
        """The position sensor with the known effects and `effects`."""
        return sensor_with((*self.declared, *effects))


def _knowing_rests(recordings: Sequence[PreparedRecording]) -> tuple[PreparedRecording, ...]:
    """The same recordings of one rig, whose drives know what their errors share at rests on one count."""
    drives = with_shared_rounding([one.drive for one in recordings])
    return tuple(replace(one, drive=drive) for one, drive in zip(recordings, drives, strict=True))
