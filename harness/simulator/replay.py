"""A recorded run's beam as a motion that can be asked at any time."""

from __future__ import annotations

from scipy.interpolate import CubicHermiteSpline

from analytic.motion import FloatArray
from harness.simulator.plant import Run


class Replay:
    """A motion through angles and rates; one whose acceleration is constant within a step is met exactly.

    See `analytic.motion.BeamMotion`.
    """

    def __init__(self, time: FloatArray, angle: FloatArray, rate: FloatArray) -> None:
        """Take instants, shape (n,) [s], the angles [rad] and rates [rad/s] there."""
        self._angle = CubicHermiteSpline(time, angle, rate)
        self._rate, self._acceleration = self._angle.derivative(1), self._angle.derivative(2)

    @classmethod
    def of_beam(cls, run: Run) -> Replay:
        """The beam's motion in `run`."""
        return cls(run.time, run.angle, run.rate)

    @classmethod
    def of_shaft(cls, run: Run) -> Replay:
        """The motion of the measured shaft in `run`."""
        return cls(run.time, run.shaft, run.shaft_rate)

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self._angle(time)

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return self._rate(time)

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return self._acceleration(time)
