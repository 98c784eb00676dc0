"""From a recorded beam angle to a drive: smooth α, α̇, α̈ that belong together, on any time grid, with error bars.

The sensor decides how the record is read. A rounded angle (encoder) is smoothed within its counts, a noisy one within
its noise; in both cases the prior is the same quintic smoothing spline, whose stiffness is learnt along the record
(`harness.signals`). Derivatives are those of the spline, never differences of counts. docs/drive.md has the reasons
and the measured errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import PPoly

from analytic.motion import FloatArray
from harness.signals.quantised import smooth_rounded
from harness.signals.spline_smoother import Smoothed, draw

# Below this share of a count the noise does not dither the rounding, and white noise of q²/12 would be a wrong model.
_DITHERED = 0.5
_LEAST_NOISE = 1e-9  # rad: a continuous reading without noise would make the smoother divide by zero


@dataclass(frozen=True)
class AngleSensor:
    """How the angle was measured.

    Attributes:
        resolution: distance of two counts, 0 for a continuous reading [rad].
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
    def variance(self) -> float:
        """Of noise and rounding together, as white noise [rad²]."""
        return self.noise**2 + self.resolution**2 / 12.0


def quintic(time: FloatArray, states: FloatArray) -> PPoly:
    """The piecewise quintic through values, first and second derivatives, shape (n, 3), at `time`, shape (n,) [s]."""
    h = np.diff(time)
    p, v, a = states[:-1].T
    dp = states[1:, 0] - p - v * h - 0.5 * a * h**2
    dv = states[1:, 1] - v - a * h
    da = states[1:, 2] - a
    c3 = (10 * dp - 4 * dv * h + 0.5 * da * h**2) / h**3
    c4 = (-15 * dp + 7 * dv * h - da * h**2) / h**4
    c5 = (6 * dp - 3 * dv * h + 0.5 * da * h**2) / h**5
    return PPoly(np.array([c5, c4, c3, 0.5 * a, v, p]), time)


@dataclass(frozen=True)
class Drive:
    """A beam motion read from a record; see `analytic.motion.BeamMotion`.

    Attributes:
        time: stamps of the record, shape (n,) [s].
        states: α [rad], α̇ [rad/s], α̈ [rad/s²] at the stamps, shape (n, 3).
        std: their standard deviations, shape (n, 3).
        sensor: how the angle was measured.
        residual_ratio: RMS of (reading − α) over what the sensor explains [1]; some 0.9 for a rounded, 1 for a noisy
            angle, and far from it the sensor is misdeclared.
    """

    time: FloatArray
    states: FloatArray
    std: FloatArray
    sensor: AngleSensor
    residual_ratio: float
    _smoothed: Smoothed
    _variance: FloatArray

    @cached_property
    def _angle(self) -> PPoly:
        return quintic(self.time, self.states)

    @cached_property
    def _rate(self) -> PPoly:
        return self._angle.derivative()

    @cached_property
    def _acceleration(self) -> PPoly:
        return self._rate.derivative()

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return np.asarray(self._angle(time))

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return np.asarray(self._rate(time))

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return np.asarray(self._acceleration(time))

    def angle_std(self, time: FloatArray) -> FloatArray:
        """Standard deviation of α [rad] at `time` [s], same shape."""
        return np.interp(time, self.time, self.std[:, 0])

    def draw(self, count: int, seed: int) -> list[PathDrive]:
        """Beam motions drawn from what the record leaves open; their spread is the drive's correlated error."""
        paths = draw(self._smoothed, self._variance, count, np.random.default_rng(seed))
        return [PathDrive(self.time, path) for path in paths]


@dataclass(frozen=True)
class PathDrive:
    """A beam motion through given states at stamps: α, α̇, α̈, shape (n, 3), at `time`, shape (n,) [s]."""

    time: FloatArray
    states: FloatArray

    @cached_property
    def _angle(self) -> PPoly:
        return quintic(self.time, self.states)

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return np.asarray(self._angle(time))

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return np.asarray(self._angle(time, 1))

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return np.asarray(self._angle(time, 2))


def make_drive(
    time: FloatArray, angle: FloatArray, *, resolution: float | None = None, noise: float | None = None
) -> Drive:
    """Read a recorded beam angle.

    Args:
        time: stamps, shape (n,), strictly increasing [s]; at least three.
        angle: readings, shape (n,), NaN where none was taken [rad].
        resolution: distance of two counts [rad]; `None` for a continuous reading.
        noise: standard deviation of the sensor before rounding [rad]; `None` to estimate it from the record.

    Raises:
        ValueError: fewer than three angles are known.
    """
    known = np.isfinite(angle)
    if known.sum() < 3:
        raise ValueError("fewer than three angles are known")
    resolution = resolution or 0.0
    sensor = AngleSensor(resolution, noise or 0.0, noise is None)
    if noise is None or sensor.rounded:
        smoothed, variance, found = smooth_rounded(time, angle, resolution, noise)
        sensor = replace(sensor, noise=found)
    else:  # noise dithers the rounding, which then is white noise too
        smoothed, variance, _ = smooth_rounded(time, angle, 0.0, max(math.sqrt(sensor.variance), _LEAST_NOISE))
    std = np.sqrt(np.diagonal(smoothed.covariance, axis1=1, axis2=2).clip(min=0.0))
    residual = float(np.sqrt(np.mean((angle - smoothed.mean[:, 0])[known] ** 2)))
    ratio = residual / max(math.sqrt(sensor.variance), _LEAST_NOISE)
    return Drive(smoothed.time, smoothed.mean, std, sensor, ratio, smoothed, variance)
