"""A step with the model's own terms, a dry friction and smooth ones of the velocity, on paths of their own.

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
from analytic.law import OF_SENSOR, has_dry_friction
from analytic.motion import FloatArray

GENERAL, SMOOTH, DRY, DAMPED, DAMPED_DRY = range(5)
_LEAN = (  # slots that one of the lean paths reads
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
    slots.DRY_STATIC,
    slots.STRIBECK_VELOCITY,  # nothing without DRY_STATIC
    slots.VISCOUS,
    slots.QUADRATIC,
)
_ZERO = tuple(slot for slot in range(slots.SHAPE) if slot not in _LEAN)


@njit(cache=True)
def path_of(p: FloatArray) -> int:
    """Which path takes a run with this parameter vector: `GENERAL`, `SMOOTH`, `DRY`, `DAMPED` or `DAMPED_DRY`."""
    if len(p) > slots.SLOTS or p[slots.SHAPE] not in (0.0, OF_SENSOR):  # an error of the sensor moves no ball
        return GENERAL
    for slot in _ZERO:
        if p[slot] != 0.0:
            return GENERAL
    dry = has_dry_friction(p)
    if p[slots.VISCOUS] != 0.0 or p[slots.QUADRATIC] != 0.0:
        return DAMPED_DRY if dry else DAMPED
    return DRY if dry else SMOOTH


class Push(NamedTuple):
    """What the beam does to any ball at one time: gravity's share of s̈ [m/s²], α̇ [rad/s], that of α̈ [m/s²]."""

    tilt: float
    rate: float
    angular: float


class Friction(NamedTuple):
    """A dry friction in mid-step: k c against motion in + and − [1], and what the normal force N consists of.

    Where c depends on the velocity after Stribeck, k c is what it falls to.
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
    k1 = _acceleration(s, begin, centrifugal)
    v2 = v + 0.5 * h * k1
    k2 = _acceleration(s + 0.5 * h * v, middle, centrifugal)
    v3 = v + 0.5 * h * k2
    k3 = _acceleration(s + 0.5 * h * v2, middle, centrifugal)
    v4 = v + h * k3
    k4 = _acceleration(s + h * v3, end, centrifugal)
    return s + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


@njit(cache=True, inline="always", error_model="numpy")
def damped_step(
    s: float, v: float, h: float, begin: Push, middle: Push, end: Push, lost: float, p: FloatArray
) -> tuple[float, float]:
    """(s, ṡ) after a step of `h` [s] with friction that grows with the velocity, which is by `lost` less [m/s]."""
    u = v - lost
    k1 = _damped(s, u, begin, p)
    v2 = u + 0.5 * h * k1
    k2 = _damped(s + 0.5 * h * u, v2, middle, p)
    v3 = u + 0.5 * h * k2
    k3 = _damped(s + 0.5 * h * v2, v3, middle, p)
    v4 = u + h * k3
    k4 = _damped(s + h * v3, v4, end, p)
    s_end = s + h * (u + 2.0 * v2 + 2.0 * v3 + v4) / 6.0 + h * lost
    return s_end, u + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0 + lost


@njit(cache=True, inline="always")
def _acceleration(s: float, on: Push, centrifugal: float) -> float:
    return on.tilt + centrifugal * s * on.rate * on.rate - on.angular


@njit(cache=True, inline="always")
def _damped(s: float, v: float, on: Push, p: FloatArray) -> float:
    result = _acceleration(s, on, p[slots.CENTRIFUGAL])
    if p[slots.VISCOUS] != 0.0:
        result -= p[slots.VISCOUS] * v
    if p[slots.QUADRATIC] != 0.0:
        result -= p[slots.QUADRATIC] * abs(v) * v
    return result


@njit(cache=True, inline="always")
def lost_to(friction: Friction, s: float, v: float, h: float, p: FloatArray) -> float:
    """What dry friction takes of ṡ in half a step of `h` [s], as `analytic.step._lost` [m/s]."""
    if v == 0.0:
        return 0.0
    sign = 1.0 if v > 0.0 else -1.0
    return sign * min(0.5 * h * _limit(friction, s, v, sign, p), abs(v))


@njit(cache=True, inline="always")
def _limit(friction: Friction, s: float, v: float, towards: float, p: FloatArray) -> float:
    """Largest deceleration against motion `towards` + or − [m/s²]."""
    plus, minus, pressed, rate, angular, turn = friction
    share = plus if towards > 0.0 else minus
    if p[slots.DRY_STATIC] != 0.0:
        ratio = v / p[slots.STRIBECK_VELOCITY]
        coefficient = p[slots.DRY_PLUS] if towards > 0.0 else p[slots.DRY_MINUS]
        coefficient += p[slots.DRY_STATIC] * np.exp(-ratio * ratio)
        share = p[slots.RESPONSE] * max(coefficient, 0.0)
    return share * max(pressed - 2.0 * v * rate - s * angular - turn, 0.0)


@njit(cache=True, inline="always", error_model="numpy")
def resisted(
    s: float, v: float, h: float, s_end: float, v_end: float, friction: Friction, p: FloatArray
) -> tuple[float, float]:
    """(s, ṡ) after a step with dry friction, given the step without it: as `analytic.step._resist`."""
    drive, rest = (v_end - v) / h, h
    if v != 0.0:
        sign = 1.0 if v > 0.0 else -1.0
        limit = _limit(friction, s, v, sign, p)
        if p[slots.DRY_STATIC] != 0.0:
            limit = _limit(friction, s, v + 0.5 * h * (drive - sign * limit), sign, p)
        v_end -= sign * limit * h
        if sign * v_end >= 0.0:
            return s_end - 0.5 * sign * limit * h * h, v_end
        stop = v / (sign * limit - drive)
        s, rest = s + 0.5 * v * stop, h - stop
    sign = 1.0 if drive > 0.0 else -1.0
    limit = _limit(friction, s, 0.0, sign, p)
    if abs(drive) <= limit:
        return s, 0.0
    if v == 0.0:
        return s_end - 0.5 * sign * limit * h * h, (drive - sign * limit) * h
    v = (drive - sign * limit) * rest
    return s + 0.5 * v * rest, v
