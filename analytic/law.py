"""The forces on the ball, compiled: acceleration along the beam, normal force, limit of the dry friction.

`p` is always a vector from `models.coefficients`, with effects written into it (`analytic.effects`), shape (SLOTS,).
"""

from __future__ import annotations

import numpy as np

from analytic import slots
from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.models import Reading
from analytic.motion import FloatArray

# What a spline term depends on (slot SHAPE, or the first of a law behind the slots), and whether it is a force on the
# ball, an error of the position sensor, which moves no ball, or a dry friction. A friction that depends on time stands
# in a fourth column of the beam's table.
OF_POSITION, OF_VELOCITY, OF_ANGLE, OF_ROLL, PERIODIC, OF_SENSOR, DRY_OF_POSITION, DRY_OF_ROLL, DRY_OF_TIME = (
    1.0,
    2.0,
    3.0,
    4.0,
    5.0,
    6.0,
    7.0,
    8.0,
    9.0,
)
_SLOPE_OVER = 1e-4  # over which a slope is a difference, in distances of nodes: 1e-8 of the values is lost
_NONE, _PRINTED, _DISSIPATIVE, _COULOMB = (int(Reading(i)) for i in range(4))


@njit(cache=True)
def acceleration(s: float, v: float, angle: float, rate: float, angular: float, p: FloatArray) -> float:
    """s̈ [m/s²] without dry friction.

    Args:
        s, v: ball, position [m] and velocity [m/s].
        angle, rate, angular: beam, α [rad], α̇ [rad/s], α̈ [rad/s²].
        p: from `models.coefficients`, with effects written into it, shape (SLOTS,) or longer where laws follow.
    """
    p = borrowed(p)
    tilt = angle + p[slots.LEVEL]
    if p[slots.CURVATURE] != 0.0:
        tilt += p[slots.CURVATURE] * (p[slots.CURVATURE_CENTRE] - s)
    if p[slots.COMPLIANCE] != 0.0:
        tilt += p[slots.COMPLIANCE] * s
    if p[slots.BUMP_HEIGHT] != 0.0:
        u = (s - p[slots.BUMP_CENTRE]) / p[slots.BUMP_WIDTH]
        tilt += p[slots.BUMP_HEIGHT] / p[slots.BUMP_WIDTH] * u * np.exp(-0.5 * u * u)
    if p[slots.LINEAR] == 0.0:
        tilt = np.sin(tilt)
    result = p[slots.GRAVITY] * tilt + p[slots.CENTRIFUGAL] * s * rate * rate - p[slots.ECCENTRIC] * angular
    if p[slots.VISCOUS] != 0.0:
        result -= p[slots.VISCOUS] * v
    if p[slots.QUADRATIC] != 0.0:
        result -= p[slots.QUADRATIC] * abs(v) * v
    if p[slots.IMBALANCE] != 0.0:
        result += p[slots.IMBALANCE] * np.sin(rolled(s, p))
    if p[slots.SHAPE] == OF_POSITION or p[slots.SHAPE] == PERIODIC:
        result += p[slots.RESPONSE] * spline_term(s, p)
    elif p[slots.SHAPE] == OF_VELOCITY:
        result += p[slots.RESPONSE] * spline_term(v, p)
    elif p[slots.SHAPE] == OF_ANGLE:
        result += p[slots.RESPONSE] * spline_term(angle, p)
    elif p[slots.SHAPE] == OF_ROLL:
        result += p[slots.RESPONSE] * spline_term(rolled(s, p), p)
    if len(p) > slots.SLOTS:
        result += p[slots.RESPONSE] * laws(s, v, angle, p)
    reading = int(p[slots.READING])
    if reading == _NONE:
        return result
    if reading == _PRINTED:
        return result - p[slots.FRICTION_GAIN] * np.cos(angle) * np.tanh(v / p[slots.TRANSITION]) * v
    if reading == _DISSIPATIVE:
        return result - p[slots.FRICTION_GAIN] * np.cos(angle) * abs(np.tanh(v / p[slots.TRANSITION])) * v
    if reading == _COULOMB:
        return result - p[slots.FRICTION_GAIN] * np.cos(angle) * np.tanh(v / p[slots.TRANSITION])
    return result - p[slots.FRICTION_GAIN] * v  # viscous


@njit(cache=True)
def accelerations(s: FloatArray, v: FloatArray, beam: FloatArray, p: FloatArray) -> FloatArray:
    """`acceleration` [m/s²] at positions `s` [m] and velocities `v` [m/s], shape (n,); the same shape.

    `beam` has the columns α [rad], α̇ [rad/s], α̈ [rad/s²], shape (n, 3).
    """
    result = np.empty(len(s))
    for i in range(len(s)):
        result[i] = acceleration(s[i], v[i], beam[i, 0], beam[i, 1], beam[i, 2], p)
    return result


@njit(cache=True)
def spline_term(at: float, p: FloatArray) -> float:
    """A Catmull–Rom spline through the nodes in the vector, constant beyond its ends.

    Over the rolled angle it is periodic, over the position if its kind says so.
    """
    count = int(p[slots.SHAPE_COUNT])
    place = (at - p[slots.SHAPE_LOW]) / p[slots.SHAPE_STEP]
    if p[slots.SHAPE] == OF_ROLL or p[slots.SHAPE] == DRY_OF_ROLL or p[slots.SHAPE] == PERIODIC:
        node = int(np.floor(place))
        t = place - node
        before, here = p[slots.SHAPE_NODES + (node - 1) % count], p[slots.SHAPE_NODES + node % count]
        there, after = p[slots.SHAPE_NODES + (node + 1) % count], p[slots.SHAPE_NODES + (node + 2) % count]
    else:
        place = min(max(place, 0.0), count - 1.0)
        node = min(int(place), count - 2)
        t = place - node
        here, there = p[slots.SHAPE_NODES + node], p[slots.SHAPE_NODES + node + 1]
        before = p[slots.SHAPE_NODES + node - 1] if node > 0 else 2.0 * here - there
        after = p[slots.SHAPE_NODES + node + 2] if node < count - 2 else 2.0 * there - here
    low, high, rise = 0.5 * (there - before), 0.5 * (after - here), there - here
    return here + t * (low + t * (3.0 * rise - 2.0 * low - high + t * (low + high - 2.0 * rise)))


@njit(cache=True)
def spline_slope(at: float, p: FloatArray) -> float:
    """Derivative of `spline_term`; half of that on one side where it ends."""
    off = _SLOPE_OVER * p[slots.SHAPE_STEP]
    return (spline_term(at + off, p) - spline_term(at - off, p)) / (2.0 * off)


@njit(cache=True)
def spline_slope_at(where: FloatArray, p: FloatArray) -> FloatArray:
    """`spline_slope` at each of `where`, shape (n,); the same shape."""
    return np.array([spline_slope(at, p) for at in where])


@njit(cache=True)
def spline_term_at(where: FloatArray, p: FloatArray) -> FloatArray:
    """`spline_term` at each of `where`, shape (n,); the same shape."""
    return np.array([spline_term(at, p) for at in where])


@njit(cache=True)
def rolled(s: float, p: FloatArray) -> float:
    """The angle by which the ball has rolled, counted from a mark on it [rad]."""
    return (s - p[slots.ORIGIN]) * p[slots.ROLL] + p[slots.PHASE]


@njit(cache=True)
def laws(s: float, v: float, angle: float, p: FloatArray) -> float:
    """Sum of the force laws in the blocks behind the slots, F/m [m/s²]."""
    total = 0.0
    for law in range(slots.SLOTS, len(p), slots.LAW_SLOTS):
        depends = p[law]
        if depends == OF_POSITION:
            total += hermite(s, law, p)
        elif depends == OF_VELOCITY:
            total += hermite(v, law, p)
        elif depends == OF_ANGLE:
            total += hermite(angle, law, p)
        else:
            total += hermite(rolled(s, p) % (2.0 * np.pi), law, p)
    return total


@njit(cache=True)
def hermite(at: float, law: int, p: FloatArray) -> float:
    """The force law in block `law`: a cubic Hermite spline, slopes by differences of fourth order, constant beyond."""
    place = min(max((at - p[law + 1]) / p[law + 2], 0.0), slots.LAW_NODES - 1.0)
    node = min(int(place), slots.LAW_NODES - 2)
    t = place - node
    n = law + 3 + slots.LAW_MARGIN + node
    low = (8.0 * (p[n + 1] - p[n - 1]) - p[n + 2] + p[n - 2]) / 12.0
    high = (8.0 * (p[n + 2] - p[n]) - p[n + 3] + p[n - 1]) / 12.0
    rise = p[n + 1] - p[n]
    return p[n] + t * (low + t * (3.0 * rise - 2.0 * low - high + t * (low + high - 2.0 * rise)))


@njit(cache=True)
def normal_force(s: float, v: float, angle: float, rate: float, angular: float, p: FloatArray) -> float:
    """N/m = g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇² [m/s²], never negative.

    A level angle α₀ changes it by α α₀ of itself, a thousandth at 0.05 and 0.02 rad, and is left out here; where the
    ball lifts off (`analytic.lift_off`), N alone decides, and has it.
    """
    normal = p[slots.WEIGHT] * np.cos(angle) - 2.0 * v * rate - s * angular - p[slots.HEIGHT] * rate * rate
    return max(normal, 0.0)


@njit(cache=True, inline="always")
def has_dry_friction(p: FloatArray) -> bool:
    """Whether a friction acts that can stop the ball within a step and hold it."""
    return (
        p[slots.DRY_PLUS] != 0.0
        or p[slots.DRY_MINUS] != 0.0
        or p[slots.DRY_STATIC] != 0.0
        or p[slots.SHAPE] >= DRY_OF_POSITION
    )


@njit(cache=True)
def dry_limit(s: float, v: float, towards: float, angle: float, rate: float, angular: float, p: FloatArray) -> float:
    """Largest deceleration that dry friction can hold up against motion `towards` + or −, k c(ṡ) N/m [m/s²].

    c falls from its static to its kinetic value after Stribeck.
    """
    coefficient = p[slots.DRY_PLUS] if towards > 0.0 else p[slots.DRY_MINUS]
    if p[slots.SHAPE] == DRY_OF_POSITION:
        coefficient += spline_term(s, p)
    elif p[slots.SHAPE] == DRY_OF_ROLL:
        coefficient += spline_term(rolled(s, p), p)
    if p[slots.DRY_STATIC] != 0.0:
        ratio = v / p[slots.STRIBECK_VELOCITY]
        coefficient += p[slots.DRY_STATIC] * np.exp(-ratio * ratio)
    return p[slots.RESPONSE] * max(coefficient, 0.0) * normal_force(s, v, angle, rate, angular, p)
