"""Effects in an engine: the force along the beam that a model with effects has beyond the one without.

The smooth part is m/k times the difference of the two models' accelerations, k = 1/(1 + J/(m r²)). A set-valued
friction is averaged over the engine's step as `analytic.step.advance` does it: it opposes the motion, and where the
ball stops within the step it holds it as far as its limit reaches; so a ball at rest stays at rest in the engine too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.compiled import njit
from analytic.effects import Acting, motion_with, parameters_with, transmission_with
from analytic.law import acceleration, dry_limit
from analytic.models import CAM, coefficients
from analytic.motion import BallForce, BeamMotion, FloatArray, SplineMotion
from analytic.rig import Rig
from analytic.slots import DAHL, DAHL_STIFFNESS, ORIGIN, RESPONSE
from analytic.step import dahl, dahl_limit

_CORNER_STEP, _CORNER_SPAN = 1e-3, 41  # [s], steps


def force_of(
    effects: Sequence[Acting],
    rig: Rig,
    motion: BeamMotion,
    stamps: FloatArray,
    time_step: float,
    *,
    origin: float = 0.0,
    phase: float = 0.0,
    law: Callable[[FloatArray, float], None] | None = None,
) -> BallForce | None:
    """The force that stands for `effects` in an engine that steps by `time_step` [s]; `None` where none is a force.

    What effects do to the rig, to the angle and to the sensor is not in it: the engine is to be given the rig and the
    motion as they then are (`analytic.effects`), and slipping by its own parameters (`engine_settings`).

    Args:
        motion: of the beam.
        stamps: the run's stamps, shape (n,) [s]; the motion is tabulated over them once.
        origin: position from which the rolled angle counts [m].
        phase: φ₀, how the ball lies there, where that matters [rad].
        law: one that no catalogue lists: called with the kernel's vector, shape (SLOTS,), and the time [s] before every
            step, it writes itself into the vector.
    """
    effects = [one for one in effects if one.effect.pushes]
    if not effects and law is None:
        return None
    bare, full = coefficients(CAM, rig), parameters_with(CAM, rig, effects, phase=phase)
    full[ORIGIN] = origin
    dry = law is not None or any(one.effect.dry for one in effects)
    begin = float(stamps[0])
    grid = begin + time_step * np.arange(int(np.ceil((stamps[-1] - begin) / time_step)) + 3)
    known = np.minimum(grid, stamps[-1])
    rate, angular = motion.derivative(known).tolist(), motion.derivative(known, 2).tolist()
    inertia = float(rig.mass / bare[RESPONSE])
    pull, before = 0.0, (0, math.nan)  # of a Dahl friction [m/s²]; the step met last, and the ball's position then [m]

    def force(s: float, v: float, angle: float, time: float) -> float:
        nonlocal pull, before
        n = round((time - begin) / time_step)
        if law is not None:
            law(full, time)
        # An engine's velocities live between the steps: that of half a step ago is what the ball has moved by.
        earlier = (s - before[1]) / time_step if n == before[0] + 1 else math.nan
        now = _Instant(s, v, earlier, angle, rate[n], angular[n])
        push, pull = _excess(now, bare, full, dry, time_step, pull, n - before[0])
        before = n, s
        return inertia * push

    return force


def engine_settings(effects: Sequence[Acting], engine: str) -> dict[str, Any]:
    """Parameters of this engine that stand for `effects`."""
    settings: dict[str, Any] = {}
    for one in effects:
        if one.effect.engine.settings:
            settings |= one.effect.engine.settings[engine](one.values)
    return settings


def motion_for_engine(effects: Sequence[Acting], motion: BeamMotion, stamps: FloatArray) -> BeamMotion:
    """The beam's motion with `effects`, its corners rounded where a gap closes.

    A rate that jumps by Δα̇ throws a ball at s off the rails unless it takes longer than s Δα̇/g, some 10 ms; real
    linkages give way by as much. The angle is averaged over 40 ms, which leaves the ball's run along the beam as it is.
    """
    turned = motion_with(motion, stamps, effects)
    if transmission_with(effects).play == 0.0:
        return turned
    time = np.arange(stamps[0], stamps[-1] + _CORNER_STEP, _CORNER_STEP)
    angle = turned.evaluate(np.minimum(time, stamps[-1]))
    window = np.hanning(_CORNER_SPAN + 2)[1:-1]
    padded = np.pad(angle, _CORNER_SPAN // 2, mode="edge")
    return SplineMotion(CubicSpline(time, np.convolve(padded, window / window.sum(), mode="valid")))


class _Instant(NamedTuple):
    """Ball and beam at an engine's step: s [m], ṡ [m/s], ṡ half a step ago (NaN if unknown); α, α̇, α̈ [rad, s]."""

    s: float
    v: float
    begin: float
    angle: float
    rate: float
    angular: float


@njit(cache=True)
def _excess(
    now: _Instant, bare: FloatArray, full: FloatArray, dry: bool, time_step: float, pull: float, steps: int
) -> tuple[float, float]:
    """Acceleration with effects beyond the one without, and the pull of a Dahl friction in it, both [m/s²].

    Args:
        now: ball and beam.
        bare, full: the kernel's vectors without and with effects, shape (SLOTS,) or longer.
        dry: whether any of them is set-valued.
        time_step: of the engine [s].
        pull: of the Dahl friction `steps` steps ago [m/s²].
    """
    s, v, begin, angle, rate, angular = now
    with_effects = acceleration(s, v, angle, rate, angular, full)
    push = with_effects - acceleration(s, v, angle, rate, angular, bare)
    if dry:
        plus = dry_limit(s, v, 1.0, angle, rate, angular, full)
        minus = dry_limit(s, v, -1.0, angle, rate, angular, full)
        if math.isnan(begin):
            begin = _half_a_step_ago(v, with_effects, plus, minus, time_step)
        push += mean_friction(begin, with_effects, plus, minus, time_step)
    if full[DAHL] != 0.0:
        limit = dahl_limit(s, v, angle, rate, angular, full)
        passed = v if math.isnan(begin) else begin  # since the step before
        pull = dahl(pull, passed, steps * time_step, limit, full[DAHL_STIFFNESS])
        push += pull
    return push, pull


@njit(cache=True)
def mean_friction(begin: float, drive: float, plus: float, minus: float, time_step: float) -> float:
    """Mean acceleration [m/s²] that dry friction gives over a step.

    Args:
        begin: velocity at the step's begin [m/s].
        drive: acceleration without the friction [m/s²].
        plus, minus: what friction can hold up against motion towards + and − [m/s²].
        time_step: of the engine [s].
    """
    sign, limit = (1.0, plus) if begin > 0.0 else (-1.0, minus)
    end = begin + time_step * (drive - sign * limit)
    if sign * end >= 0.0:  # it moves on
        return -sign * limit
    rest = time_step - begin / (sign * limit - drive)  # of the step, from where the ball stands
    onward = max(abs(drive) - (plus if drive > 0.0 else minus), 0.0) * rest
    end = onward if drive > 0.0 else -onward
    return (end - begin) / time_step - drive


@njit(cache=True)
def _half_a_step_ago(v: float, drive: float, plus: float, minus: float, time_step: float) -> float:
    """Velocity [m/s] half a step before it is v; other arguments as of `mean_friction`."""
    if abs(v) < 1e-6 * time_step * (plus if drive > 0.0 else minus):  # at rest to rounding
        return 0.0
    for sign in (1.0, -1.0) if v > 0.0 else (-1.0, 1.0):
        begin = v - 0.5 * time_step * (drive - sign * (plus if sign > 0.0 else minus))
        if sign * begin >= 0.0:
            return begin
    return 0.0
