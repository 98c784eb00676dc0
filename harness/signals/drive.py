"""From a recorded beam angle to a drive: consistent smooth α, α̇, α̈ at any time, with error bars.

A rounded angle (encoder) is smoothed within its counts, a noisy one within its noise; the prior of both is the same
quintic smoothing spline, whose stiffness is estimated along the record (`harness.signals`). Derivatives are those of
the spline, never differences of counts. docs/drive.md has the reasons and the measured errors.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.motion import BeamMotion, FloatArray
from analytic.quintic import QuinticMotion
from harness.signals.error_process import ErrorProcess, error_process
from harness.signals.quantised import smooth_rounded
from harness.signals.spline_smoother import Smoothed, draw

# Below this share of a count the noise does not dither the rounding, and white noise of q²/12 would be a wrong model.
_DITHERED = 0.5
_LEAST_SHARED = 1e-6  # rad: of noise below that no share is taken, as it moves no ball and leaves no digits
_BUNCHED = 2.0  # mean over median step, beyond which several readings are stamped at once
_DENSITY_SPAN, _DENSITY_DRAWS = 0.5, 16  # [s]: longer than the correlation of the error, shorter than a move
_LEAST_NOISE = 1e-9  # rad: a continuous reading without noise would make the smoother divide by zero


@dataclass(frozen=True)
class AngleSensor:
    """How the angle was measured.

    Attributes:
        resolution: distance between counts, 0 for a continuous reading [rad].
        noise: standard deviation before rounding [rad].
        estimated: whether the noise was estimated from the record rather than declared.
    """

    resolution: float
    noise: float
    estimated: bool

    @property
    def rounded(self) -> bool:
        """Whether rounding, not noise, limits the reading."""
        return self.noise < _DITHERED * self.resolution

    @property
    def by_counts(self) -> bool:
        """Whether readings are smoothed as counts, whose noise is estimated where it is not declared."""
        return self.estimated or self.rounded

    @property
    def variance(self) -> float:
        """Of noise and rounding together, as white noise [rad²]."""
        return self.noise**2 + self.resolution**2 / 12.0


@dataclass(frozen=True)
class Drive(QuinticMotion, ABC):
    """A beam motion estimated from a recording; `time` and `states` are at the recording's stamps.

    Attributes:
        std: standard deviations of `states`, shape (n, 3).
        sensor: how the angle was measured.
        residual_ratio: RMS of (reading − α) over the sensor's standard deviation [1]; about 0.9 for a rounded, 1 for a
            noisy angle, far from that for a wrongly declared sensor.
        reading: the angle as recorded, shape (n,) [rad].
        inflation: factor of the error's variance at each stamp where one estimate is made of all recordings, shape (n,)
            [1]; `None` where it is 1 throughout.
    """

    std: FloatArray
    sensor: AngleSensor
    residual_ratio: float
    reading: FloatArray
    inflation: FloatArray | None = None

    @cached_property
    @abstractmethod
    def error(self) -> ErrorProcess:
        """The error of `states` as a Gauss–Markov process."""

    @cached_property
    def shared_error(self) -> ErrorProcess:
        """`error` where one estimate is made of all rests: m on one count, which share their rounding, have its m-fold
        variance (`harness.signals.rests`)."""
        return self.error if self.inflation is None else self.error.inflated(self.inflation)

    @cached_property
    def error_densities(self) -> FloatArray:
        """Density of the white noise that acts on a ball over half a second as the angle error does [rad²/Hz].

        Of 16 draws of the error, shape (16,); their mean estimates it.
        """
        step, mean = float(np.median(np.diff(self.time))), float((self.time[-1] - self.time[0]) / (len(self.time) - 1))
        step = mean if mean > _BUNCHED * step else step
        span = min(max(int(_DENSITY_SPAN / step), 1), len(self.time) - 1)
        densities = []
        for path in self.draw(_DENSITY_DRAWS, seed=0):
            turned = np.cumsum(path.states[:, 0] - self.states[:, 0]) * step
            densities.append(np.mean((turned[span::span] - turned[:-span:span]) ** 2) / (span * step))
        return np.array(densities)

    @property
    def commanded(self) -> bool:
        """Whether the angle is a command, which has no error, behind nothing that the beam does with it either."""
        return False

    @abstractmethod
    def rougher(self, factor: float) -> Drive:
        """From the same readings, with `factor` times the density of the third derivative [1].

        What moves the beam within a count, or within its noise, is not in the readings: the density that they tell is
        then too small, and the stated errors with it.
        """

    @abstractmethod
    def quieter(self, share: float) -> Drive:
        """From the same readings, of whose noise only `share` [1] is an error; the rest is motion.

        Readings that are known within their counts stay as they are.
        """

    @property
    def gentle(self) -> BeamMotion:
        """The motion for an engine, whose ball a beam that jumps throws off the rails: this one."""
        return self

    @abstractmethod
    def draw(self, count: int, seed: int) -> list[QuinticMotion]:
        """`count` beam motions that scatter by the error."""


@dataclass(frozen=True, kw_only=True)
class SmoothedDrive(Drive):
    """A drive from the readings of a sensor: `smoothed` is their posterior, `variance` theirs, shape (n,) [rad²]."""

    smoothed: Smoothed
    variance: FloatArray

    @cached_property
    def error(self) -> ErrorProcess:
        """The error of `states` as a Gauss–Markov process."""
        return error_process(self.smoothed, self.variance)

    def rougher(self, factor: float) -> SmoothedDrive:
        """See `Drive`."""
        if factor == 1.0:
            return self
        sensor, density = self.sensor, factor * self.smoothed.density
        smoothed, variance, _ = _smooth(self.time, self.reading, sensor, sensor.noise, density)
        return _drive(self.reading, sensor, smoothed, variance)

    def quieter(self, share: float) -> SmoothedDrive:
        """See `Drive`."""
        if share == 1.0 or self.sensor.rounded:
            return self
        resolution = self.sensor.resolution or None
        noise = max(share * self.sensor.noise, min(self.sensor.noise, _LEAST_SHARED))
        return make_drive(self.time, self.reading, resolution=resolution, noise=noise)

    def draw(self, count: int, seed: int) -> list[QuinticMotion]:
        """Drawn from the posterior, with the drive's correlated error."""
        paths = draw(self.smoothed, self.variance, count, np.random.default_rng(seed))
        return [QuinticMotion(self.time, path) for path in paths]


def make_drive(
    time: FloatArray, angle: FloatArray, *, resolution: float | None = None, noise: float | None = None
) -> SmoothedDrive:
    """Estimate the beam's motion from a recorded angle.

    Args:
        time: stamps, shape (n,), strictly increasing [s]; at least three.
        angle: readings, shape (n,), NaN where none was taken [rad].
        resolution: distance between counts [rad]; `None` for a continuous reading.
        noise: standard deviation of the sensor before rounding [rad]; `None` to estimate it from the record.

    Raises:
        ValueError: fewer than three angles are known.
    """
    known = np.isfinite(angle)
    if known.sum() < 3:
        raise ValueError("fewer than three angles are known")
    sensor = AngleSensor(resolution or 0.0, noise or 0.0, noise is None)
    smoothed, variance, found = _smooth(time, angle, sensor, noise)
    return _drive(angle, replace(sensor, noise=found) if sensor.by_counts else sensor, smoothed, variance)


def _smooth(
    time: FloatArray, angle: FloatArray, sensor: AngleSensor, noise: float | None, density: FloatArray | None = None
) -> tuple[Smoothed, FloatArray, float]:
    """As `smooth_rounded`; noise that dithers the rounding makes its error white noise, too."""
    if sensor.by_counts:
        return smooth_rounded(time, angle, sensor.resolution, noise, density)
    return smooth_rounded(time, angle, 0.0, max(math.sqrt(sensor.variance), _LEAST_NOISE), density)


def _drive(angle: FloatArray, sensor: AngleSensor, smoothed: Smoothed, variance: FloatArray) -> SmoothedDrive:
    known = np.isfinite(angle)
    std = np.sqrt(np.diagonal(smoothed.covariance, axis1=1, axis2=2).clip(min=0.0))
    residual = float(np.sqrt(np.mean((angle - smoothed.mean[:, 0])[known] ** 2)))
    ratio = residual / max(math.sqrt(sensor.variance), _LEAST_NOISE)
    return SmoothedDrive(smoothed.time, smoothed.mean, std, sensor, ratio, angle, smoothed=smoothed, variance=variance)
