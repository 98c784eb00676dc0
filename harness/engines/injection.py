"""Effects in an engine: the force along the beam that a model with effects has beyond the one without.

The smooth part is m/k times the difference of the two models' accelerations, k = 1/(1 + J/(m r²)). A set-valued
friction is averaged over the engine's step as `analytic.step.advance` does it: it opposes the motion, and where the
ball stops within the step it holds it as far as its limit reaches; so a ball at rest stays at rest in the engine too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from analytic.effects import Acting, motion_with, parameters_with
from analytic.law import acceleration, dry_limit
from analytic.models import CAM, DAHL, DAHL_STIFFNESS, RESPONSE, coefficients
from analytic.motion import BallForce, BeamMotion, FloatArray
from analytic.rig import Rig
from analytic.step import dahl, dahl_limit

_CORNER_STEP, _CORNER_SPAN = 1e-3, 41  # [s], steps


def force_of(
    effects: Sequence[Acting], rig: Rig, motion: BeamMotion, stamps: FloatArray, time_step: float
) -> BallForce | None:
    """The force that stands for `effects` in an engine that steps by `time_step` [s]; `None` where none is a force.

    What effects do to the rig, to the angle and to the sensor is not in it: the engine is to be given the rig and the
    motion as they then are (`analytic.effects`), and slipping by its own friction coefficient.

    Args:
        motion: of the beam.
        stamps: the run's stamps, shape (n,) [s]; the motion is tabulated over them once.
    """
    effects = [one for one in effects if one.effect.write is not None and one.effect.name != "contact_slip"]
    if not effects:
        return None
    bare, full = coefficients(CAM, rig), parameters_with(CAM, rig, effects)
    dry = any(one.effect.dry for one in effects)
    begin = float(stamps[0])
    grid = begin + time_step * np.arange(int(np.ceil((stamps[-1] - begin) / time_step)) + 3)
    known = np.minimum(grid, stamps[-1])
    rate, angular = motion.rate(known), motion.acceleration(known)
    inertia = rig.mass / bare[RESPONSE]
    pull, reached = 0.0, 0  # of a Dahl friction [m/s²], and the step up to which it was followed

    def force(s: float, v: float, angle: float, time: float) -> float:
        nonlocal pull, reached
        n = round((time - begin) / time_step)
        with_effects = acceleration(s, v, angle, rate[n], angular[n], full)
        push = with_effects - acceleration(s, v, angle, rate[n], angular[n], bare)
        if dry:
            plus = dry_limit(s, v, 1.0, angle, rate[n], angular[n], full)
            minus = dry_limit(s, v, -1.0, angle, rate[n], angular[n], full)
            push += mean_friction(v, with_effects, plus, minus, time_step)
        if full[DAHL] != 0.0:
            limit = dahl_limit(s, v, np.array([angle, rate[n], angular[n]]), full)
            pull, reached = dahl(pull, v, (n - reached) * time_step, limit, full[DAHL_STIFFNESS]), n
            push += pull
        return float(inertia * push)

    return force


@dataclass(frozen=True)
class Rounded:
    """A beam motion through given angles: a cubic spline with its derivatives."""

    spline: CubicSpline

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return np.asarray(self.spline(time))

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return np.asarray(self.spline(time, 1))

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return np.asarray(self.spline(time, 2))


def motion_for_engine(effects: Sequence[Acting], motion: BeamMotion, stamps: FloatArray) -> BeamMotion:
    """The beam's motion with `effects`, its corners rounded where a gap closes.

    A rate that jumps by Δα̇ throws a ball at s off the rails unless it takes longer than s Δα̇/g, some 10 ms; real
    linkages give way by as much. The angle is averaged over 40 ms, which leaves the ball's run along the beam as it is.
    """
    turned = motion_with(motion, stamps, effects)
    if not any(one.effect.name == "linkage_backlash" for one in effects):
        return turned
    time = np.arange(stamps[0], stamps[-1] + _CORNER_STEP, _CORNER_STEP)
    angle = turned.angle(np.minimum(time, stamps[-1]))
    window = np.hanning(_CORNER_SPAN + 2)[1:-1]
    padded = np.pad(angle, _CORNER_SPAN // 2, mode="edge")
    return Rounded(CubicSpline(time, np.convolve(padded, window / window.sum(), mode="valid")))


@njit(cache=True)
def mean_friction(v: float, drive: float, plus: float, minus: float, time_step: float) -> float:
    """Mean acceleration [m/s²] that dry friction gives over a step centred on now.

    The engines' velocities live half a step before and after the force; so the step begins at the velocity that the
    ball had half a step ago, moving as it does.

    Args:
        v: velocity now [m/s].
        drive: acceleration without the friction [m/s²].
        plus, minus: what friction can hold up against motion towards + and − [m/s²].
        time_step: of the engine [s].
    """
    hold = plus if drive > 0.0 else minus
    if abs(v) < 1e-6 * time_step * hold:  # at rest to rounding: held, or about to start
        return -min(max(drive, -hold), hold)
    if abs(drive) <= hold and abs(v) <= time_step * hold:  # friction stops it within a step, and then holds it
        return -min(max(drive + v / time_step, -hold), hold)
    sign, limit = (1.0, plus) if v > 0.0 else (-1.0, minus)
    begin = v - 0.5 * time_step * (drive - sign * limit)
    if sign * begin < 0.0:  # half a step ago it moved the other way, or it was at rest
        sign, limit = (-1.0, minus) if sign > 0.0 else (1.0, plus)
        begin = v - 0.5 * time_step * (drive - sign * limit)
        if sign * begin < 0.0:
            begin = 0.0
    rest = time_step
    if begin != 0.0:
        end = begin + time_step * (drive - sign * limit)
        if sign * end >= 0.0:
            return -sign * limit
        rest -= begin / (sign * limit - drive)
    onward = max(abs(drive) - hold, 0.0) * rest
    end = onward if drive > 0.0 else -onward
    return (end - begin) / time_step - drive
