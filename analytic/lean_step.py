"""A step with nothing but the model's own terms, and with a plain dry friction, on paths of their own.

`analytic.step.advance` asks at every step which of all effects act, and computes sin(α + α₀) at every stage. Which of
them act does not change during a run, and what the beam does to a ball is the same for all balls at all places: both
are done apart here, with the same operations in the same order. Results are the same bit for bit
(tests/analytic/test_lean.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic import slots
from analytic.compiled import njit
from analytic.law import OF_SENSOR
from analytic.motion import FloatArray

GENERAL, SMOOTH, DRY = 0, 1, 2
_LEAN = (  # slots that either path reads
    slots.GRAVITY,
    slots.CENTRIFUGAL,
    slots.ECCENTRIC,
    slots.LEVEL,
    slots.LINEAR,
    slots.FRICTION_GAIN,  # nothing without READING
    slots.TRANSITION,
    slots.RESPONSE,
    slots.HEIGHT,
    slots.WEIGHT,
    slots.PHASE,  # nothing without IMBALANCE or SHAPE
    slots.ORIGIN,
    slots.ROLL,
    slots.TURN,  # nothing without TRACTION
    slots.DRY_PLUS,
    slots.DRY_MINUS,
)
_ZERO = tuple(slot for slot in range(slots.SHAPE) if slot not in _LEAN)


@njit(cache=True, nogil=True)
def path_of(p: FloatArray) -> int:
    """Which path takes a run with this parameter vector: `GENERAL`, `SMOOTH` or `DRY`."""
    if len(p) > slots.SLOTS or p[slots.SHAPE] not in (0.0, OF_SENSOR):  # an error of the sensor moves no ball
        return GENERAL
    for slot in _ZERO:
        if p[slot] != 0.0:
            return GENERAL
    return SMOOTH if p[slots.DRY_PLUS] == 0.0 and p[slots.DRY_MINUS] == 0.0 else DRY


class Push(NamedTuple):
    """What the beam does to any ball at one time: gravity's share of s̈ [m/s²], α̇ [rad/s], that of α̈ [m/s²]."""

    tilt: float
    rate: float
    angular: float


class Friction(NamedTuple):
    """A dry friction in mid-step: k c against motion in + and − [1], and what the normal force N consists of.

    N/m = `pressed` − 2 ṡ `rate` − s `angular` − `turn` [m/s²].
    """

    plus: float
    minus: float
    pressed: float
    rate: float
    angular: float
    turn: float


@njit(cache=True, inline="always")
def push(tilt: float, rate: float, angular: float, p: FloatArray) -> Push:
    """From what `tilted` gives, α̇ and α̈."""
    return Push(p[slots.GRAVITY] * tilt, rate, p[slots.ECCENTRIC] * angular)


@njit(cache=True, inline="always")
def tilted(angle: float, p: FloatArray) -> float:
    """sin(α + α₀), or α + α₀ in a linear model [1]."""
    slope = angle + p[slots.LEVEL]
    return slope if p[slots.LINEAR] != 0.0 else np.sin(slope)


@njit(cache=True, inline="always")
def push_at(beam: FloatArray, row: int, p: FloatArray) -> Push:
    """From a row of the beam's table."""
    return push(tilted(beam[row, 0], p), beam[row, 1], beam[row, 2], p)


@njit(cache=True, inline="always")
def friction_at(beam: FloatArray, row: int, p: FloatArray) -> Friction:
    """From the row of the beam's table in mid-step."""
    plus, minus = p[slots.RESPONSE] * max(p[slots.DRY_PLUS], 0.0), p[slots.RESPONSE] * max(p[slots.DRY_MINUS], 0.0)
    pressed, turn = p[slots.WEIGHT] * np.cos(beam[row, 0]), p[slots.HEIGHT] * beam[row, 1] * beam[row, 1]
    return Friction(plus, minus, pressed, beam[row, 1], beam[row, 2], turn)


@njit(cache=True, inline="always", error_model="numpy")
def smooth_step(
    s: float, v: float, h: float, begin: Push, middle: Push, end: Push, centrifugal: float
) -> tuple[float, float]:
    """(s, ṡ) after a step of `h` [s] without friction; `centrifugal` is the coefficient of s α̇²."""
    k1 = begin.tilt + centrifugal * s * begin.rate * begin.rate - begin.angular
    v2 = v + 0.5 * h * k1
    k2 = middle.tilt + centrifugal * (s + 0.5 * h * v) * middle.rate * middle.rate - middle.angular
    v3 = v + 0.5 * h * k2
    k3 = middle.tilt + centrifugal * (s + 0.5 * h * v2) * middle.rate * middle.rate - middle.angular
    v4 = v + h * k3
    k4 = end.tilt + centrifugal * (s + h * v3) * end.rate * end.rate - end.angular
    return s + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


@njit(cache=True, inline="always", error_model="numpy")
def resisted(s: float, v: float, h: float, s_end: float, v_end: float, friction: Friction) -> tuple[float, float]:
    """(s, ṡ) after a step with dry friction, given the step without it: as `analytic.step._resist`.

    The normal force at rest differs by −2 ṡ α̇ alone.
    """
    plus, minus, pressed, rate, angular, turn = friction
    drive, rest = (v_end - v) / h, h
    if v != 0.0:
        sign = 1.0 if v > 0.0 else -1.0
        limit = (plus if v > 0.0 else minus) * max(pressed - 2.0 * v * rate - s * angular - turn, 0.0)
        v_end -= sign * limit * h
        if sign * v_end >= 0.0:
            return s_end - 0.5 * sign * limit * h * h, v_end
        stop = v / (sign * limit - drive)
        s, rest = s + 0.5 * v * stop, h - stop
    limit = (plus if drive > 0.0 else minus) * max(pressed - s * angular - turn, 0.0)
    if abs(drive) <= limit:
        return s, 0.0
    sign = 1.0 if drive > 0.0 else -1.0
    if v == 0.0:
        return s_end - 0.5 * sign * limit * h * h, (drive - sign * limit) * h
    v = (drive - sign * limit) * rest
    return s + 0.5 * v * rest, v
