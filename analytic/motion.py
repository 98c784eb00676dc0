"""Beam motions as functions of time, ball states and trajectories."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

BallForce = Callable[[float, float, float, float], float]
"""Extra force on the ball along the beam, F(s [m], ṡ [m/s], α [rad], t [s]) -> [N], positive towards +s."""


class BeamMotion(Protocol):
    """The beam angle α as a function of time, with its first two derivatives."""

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        ...

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] (`order` 1) or α̈ [rad/s²] (`order` 2) at `time` [s], same shape."""
        ...


def beam_states(motion: BeamMotion, time: FloatArray) -> FloatArray:
    """α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3).

    A motion that has a method `states_at` gives them in one go, which is faster.
    """
    at_once: Callable[[FloatArray], FloatArray] | None = getattr(motion, "states_at", None)
    if at_once is not None:
        return at_once(time)
    return np.column_stack((motion.evaluate(time), motion.derivative(time), motion.derivative(time, 2)))


class Spline(Protocol):
    """A piecewise polynomial, as those of `scipy.interpolate`."""

    def __call__(self, x: FloatArray, nu: int = 0, /) -> FloatArray:
        """Its derivative of order `nu` at `x`, same shape."""
        ...


@dataclass(frozen=True)
class SplineMotion:
    """A beam motion given by a spline of α [rad] over time [s]."""

    spline: Spline

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.spline(time)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²] at `time` [s], same shape."""
        return self.spline(time, order)


@dataclass(frozen=True)
class ScaledMotion:
    """`gain` times another beam motion."""

    base: BeamMotion
    gain: float

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.gain * self.base.evaluate(time)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²] at `time` [s], same shape."""
        return self.gain * self.base.derivative(time, order)

    def states_at(self, time: FloatArray) -> FloatArray:
        """α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        return self.gain * beam_states(self.base, time)


@dataclass(frozen=True)
class DelayedMotion:
    """Another beam motion delayed by `delay` [s]; outside `begin` … `end` [s] it keeps its values there."""

    base: BeamMotion
    delay: float
    begin: float
    end: float

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.base.evaluate(np.clip(time - self.delay, self.begin, self.end))

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²] at `time` [s], same shape."""
        return self.base.derivative(np.clip(time - self.delay, self.begin, self.end), order)

    def states_at(self, time: FloatArray) -> FloatArray:
        """α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        return beam_states(self.base, np.clip(time - self.delay, self.begin, self.end))


@dataclass(frozen=True)
class TiltingMotion:
    """Another beam motion on a rig that tilts as a whole, from level at `begin` [s] on by `rate` [rad/s]."""

    base: BeamMotion
    rate: float
    begin: float

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.base.evaluate(time) + self.rate * (time - self.begin)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²] at `time` [s], same shape."""
        return self.base.derivative(time, order) + (self.rate if order == 1 else 0.0)


@dataclass(frozen=True)
class State:
    """State of the ball on the beam: position s [m] and velocity ṡ [m/s]."""

    position: float
    velocity: float


@dataclass(frozen=True)
class Trajectory:
    """The ball's position and velocity along the beam over time.

    Attributes:
        source: what it comes from (`measured`, `cam`, `mujoco` …).
        time: shape (n,), strictly increasing [s].
        position: s, shape (n,) [m].
        velocity: ṡ, shape (n,) [m/s].
    """

    source: str
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
