"""One step of the ball, compiled: the classical Runge–Kutta method for smooth forces, projections for set-valued ones.

RK4: Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", table 1.2. Set-valued forces act on the
step's mean acceleration, after Moreau ("Unilateral contact and dry friction in finite freedom dynamics", 1988).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic import slots
from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.law import DRY_OF_TIME, OF_VELOCITY, acceleration, dry_limit, has_dry_friction, normal_force
from analytic.motion import FloatArray

_PIECES = 8  # of a step of a ball that slips: it stops slipping, or turning, once or twice within it


class _Step(NamedTuple):
    """A step of `h` [s] with the smooth forces only, from s [m], ṡ [m/s] to `s_end`, `v_end`."""

    s: float
    v: float
    h: float
    s_end: float
    v_end: float


@njit(cache=True)
def advance(
    s: float, v: float, w: float, h: float, beam: FloatArray, row: int, p: FloatArray
) -> tuple[float, float, float]:
    """(s, ṡ, w) after a step of `h` [s].

    Args:
        s, v, w: position [m], velocity [m/s], and the internal state of slip or Dahl friction, see below.
        h: the step [s].
        beam: from `kernel.Grid.tabulate`; three rows from `row` on are α [rad], α̇ [rad/s], α̈ [rad/s²] at the step's
            start, middle and end, and a coefficient of dry friction that depends on time [1] where there is one.
        p: from `models.coefficients`, with effects written into it, shape (SLOTS,) or longer.

    Smooth forces are integrated by RK4. Dry friction then acts on the step's mean acceleration as a set-valued force:
    it opposes the motion; if that stops within the step, friction holds the ball where it can, or else opposes the new
    direction for the rest of the step. So a ball at rest stays at rest, without creep. Smooth forces of the velocity
    act on one that has lost to friction what it loses in half the step (Strang, SIAM J. Numer. Anal. 5, 1968).

    w is the internal state of an effect: the slip velocity ṡ − r (φ̇ − α̇) of a ball that can slip [m/s], or the pull of
    a Dahl friction on the ball, k F/m [m/s²]; else 0. A ball does not have both.
    """
    beam, p = borrowed(beam), borrowed(p)
    middle, end = row + 1, row + 2
    if p[slots.DAHL] != 0.0:
        w = dahl(w, v, 0.5 * h, dahl_limit(s, v, beam[row, 0], beam[row, 1], beam[row, 2], p), p[slots.DAHL_STIFFNESS])
    dry = has_dry_friction(p)
    lost = _lost(s, v, h, beam, middle, p) if dry else 0.0
    u = v - lost
    k1 = acceleration(s, u, beam[row, 0], beam[row, 1], beam[row, 2], p)
    v2 = u + 0.5 * h * k1
    k2 = acceleration(s + 0.5 * h * u, v2, beam[middle, 0], beam[middle, 1], beam[middle, 2], p)
    v3 = u + 0.5 * h * k2
    k3 = acceleration(s + 0.5 * h * v2, v3, beam[middle, 0], beam[middle, 1], beam[middle, 2], p)
    v4 = u + h * k3
    k4 = acceleration(s + h * v3, v4, beam[end, 0], beam[end, 1], beam[end, 2], p)
    s_end = s + h * (u + 2.0 * v2 + 2.0 * v3 + v4) / 6.0 + h * lost
    v_end = u + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0 + lost
    if p[slots.DAHL] != 0.0:
        s_end, v_end = s_end + 0.5 * h * h * w, v_end + h * w
        w = dahl(
            w,
            v_end,
            0.5 * h,
            dahl_limit(s_end, v_end, beam[end, 0], beam[end, 1], beam[end, 2], p),
            p[slots.DAHL_STIFFNESS],
        )
    if not dry and p[slots.TRACTION] == 0.0:
        return s_end, v_end, w
    smooth = _Step(s, v, h, s_end, v_end)
    if p[slots.TRACTION] != 0.0:
        return _slip(smooth, w, beam, middle, p, dry)
    s_end, v_end = _resist(smooth, beam, middle, p)
    return s_end, v_end, w


@njit(cache=True)
def _lost(s: float, v: float, h: float, beam: FloatArray, row: int, p: FloatArray) -> float:
    """What dry friction takes of ṡ in half a step, where smooth forces depend on it [m/s]; not more than all of it.

    Else they would act throughout on a ball that is too fast: by h c N/(2 m) on average.
    """
    of_velocity = (
        p[slots.VISCOUS] != 0.0
        or p[slots.QUADRATIC] != 0.0
        or p[slots.READING] != 0.0
        or p[slots.SHAPE] == OF_VELOCITY
        or len(p) > slots.SLOTS
    )
    if not of_velocity or v == 0.0 or p[slots.TRACTION] != 0.0:
        return 0.0
    sign = 1.0 if v > 0.0 else -1.0
    return sign * min(0.5 * h * _limit(s, v, sign, beam, row, p), abs(v))


@njit(cache=True)
def _resist(smooth: _Step, beam: FloatArray, row: int, p: FloatArray) -> tuple[float, float]:
    """(s, ṡ) after a step with dry friction, given the step without it; the beam is that of mid-step."""
    s, v, h, s_end, v_end = smooth
    drive = (v_end - v) / h
    rest = h
    if v != 0.0:
        sign = 1.0 if v > 0.0 else -1.0
        limit = _limit(s, v, sign, beam, row, p)
        if p[slots.DRY_STATIC] != 0.0:  # it depends on the velocity: take that of mid-step
            limit = _limit(s, v + 0.5 * h * (drive - sign * limit), sign, beam, row, p)
        v_end -= sign * limit * h
        if sign * v_end >= 0.0:
            return s_end - 0.5 * sign * limit * h * h, v_end
        stop = v / (sign * limit - drive)  # the ball comes to rest within the step
        s, rest = s + 0.5 * v * stop, h - stop
    sign = 1.0 if drive > 0.0 else -1.0
    limit = _limit(s, 0.0, sign, beam, row, p)
    if abs(drive) <= limit:
        return s, 0.0
    if v == 0.0:
        return s_end - 0.5 * sign * limit * h * h, (drive - sign * limit) * h
    v_end = (drive - sign * limit) * rest
    return s + 0.5 * v_end * rest, v_end


@njit(cache=True)
def _limit(s: float, v: float, towards: float, beam: FloatArray, row: int, p: FloatArray) -> float:
    """Largest deceleration that dry friction can hold up against motion `towards` + or − [m/s²]."""
    angle, rate, angular = beam[row, 0], beam[row, 1], beam[row, 2]
    limit = dry_limit(s, v, towards, angle, rate, angular, p)
    if p[slots.SHAPE] == DRY_OF_TIME:
        limit = max(limit + p[slots.RESPONSE] * beam[row, 3] * normal_force(s, v, angle, rate, angular, p), 0.0)
    return limit


@njit(cache=True)
def _slip(smooth: _Step, w: float, beam: FloatArray, row: int, p: FloatArray, dry: bool) -> tuple[float, float, float]:
    """(s, ṡ, w) after a step of a ball that can slip, given the step of free rolling; w is its slip velocity [m/s].

    The traction τ = F_t/m is set-valued, |τ| ≤ μ N R/(r m): it stops the slip if it can. A resistance against rolling
    is a moment c r N on the turning ball, ± by its sense, set-valued too. With ι = J/(m r²),

        s̈ = G + τ,   ẇ = G + τ (1 + 1/ι) ± c N/(m ι) + r α̈,   G = (1 + ι) s̈_rolling + ι r α̈.

    What drives is the step's mean; within the step the ball goes in pieces that end where the slip or the turning does,
    for at a piece of wrong sense τ is off by twice its size.
    """
    s, v, h, s_end, v_end = smooth
    iota = 1.0 / p[slots.RESPONSE] - 1.0
    turn = p[slots.TURN] * beam[row, 2]
    rolling = (v_end - v) / h
    free = (1.0 + iota) * rolling + iota * turn
    grip = p[slots.TRACTION] * normal_force(s, v, beam[row, 0], beam[row, 1], beam[row, 2], p)
    plus, minus = 0.0, 0.0
    if dry:
        s_end, v_end = _resist(smooth, beam, row, p)
        plus, minus = _limit(s, v, 1.0, beam, row, p), _limit(s, v, -1.0, beam, row, p)
    if w == 0.0 and abs((v_end - v) / h - free) <= grip:
        return s_end, v_end, 0.0
    both, rest = 1.0 + 1.0 / iota, h
    for left in range(_PIECES, 0, -1):
        spin = v - w
        sense = 1.0 if spin > 0.0 or (spin == 0.0 and rolling > 0.0) else -1.0
        held = plus if sense > 0.0 else minus
        resisted = sense * held / (p[slots.RESPONSE] * iota)
        if spin == 0.0 and w == 0.0 and abs(rolling) <= held:
            return s, 0.0, 0.0
        needed = -(free + turn + resisted) / both
        rolls = w == 0.0 and abs(needed) <= grip
        traction = needed if rolls else np.copysign(grip, needed if w == 0.0 else -w)
        if spin == 0.0 and not rolls:  # a resistance holds a ball that does not turn, if it can
            pull = -(turn + traction / iota)
            resisted = np.copysign(min((plus if pull > 0.0 else minus) / (p[slots.RESPONSE] * iota), abs(pull)), pull)
        by_v = free + traction
        by_w = 0.0 if rolls else free + turn + resisted + traction * both
        by_spin, piece, ends, stops = by_v - by_w, rest, False, False
        if left > 1 and w * by_w < 0.0 and -w / by_w < piece:
            piece, ends = -w / by_w, True
        if left > 1 and spin * by_spin < 0.0 and -spin / by_spin < piece:
            piece, ends, stops = -spin / by_spin, False, True
        s += piece * (v + 0.5 * piece * by_v)
        v += piece * by_v
        w = 0.0 if ends or rolls else v if stops else w + piece * by_w
        if stops and rolls:
            v = 0.0
        rest -= piece
        if rest <= 0.0:
            break
    return s, v, w


@njit(cache=True)
def dahl_limit(s: float, v: float, angle: float, rate: float, angular: float, p: FloatArray) -> float:
    """k c N/m [m/s²], the limit of a Dahl friction."""
    return p[slots.RESPONSE] * p[slots.DAHL] * normal_force(s, v, angle, rate, angular, p)


@njit(cache=True)
def dahl(pull: float, v: float, h: float, limit: float, stiffness: float) -> float:
    """A Dahl friction's pull after `h` [s] at velocity v: dF/ds = −σ (1 + F sign(ṡ)/(c N)), solved exactly.

    Args:
        pull: k F/m before [m/s²].
        limit: k c N/m [m/s²].
        stiffness: k σ/m [1/s²].
    """
    if limit <= 0.0 or v == 0.0:
        return pull
    target = -limit if v > 0.0 else limit
    return target + (pull - target) * np.exp(-stiffness * abs(v) * h / limit)
