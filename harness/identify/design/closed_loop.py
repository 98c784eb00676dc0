"""Closed-loop simulation of a motion, which yields a beam angle that keeps the ball on the beam.

The beam is a servo with limits, and the ball follows its target by state feedback. The resulting angle is then run
through the filter with the first reading only, which gives the noiseless recording that the model predicts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analytic.compiled import njit
from analytic.effects import parameters_with, transmission_with
from analytic.motion import FloatArray
from analytic.slots import ORIGIN
from analytic.step import advance
from harness.identify.design.excitation import OperatingEnvelope, Profile
from harness.identify.filter.run import run_filter
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import Regressor
from harness.signals.drive import AngleSensor, SmoothedDrive
from harness.signals.spline_smoother import Smoothed

_STIFFEST = 28.0  # [1/s]: 2 ζ ω₀ of a servo with ω₀ = 14 rad/s and ζ = 1
_SOFTER = 12.0  # limits the stiffness so that a step of a third of the largest angle needs the largest acceleration
_SHARE = 0.9  # share of the limits that the servo uses, since it overshoots slightly
_ATTEMPTS = 5  # simulations with decreasing size of a motion that exceeds the envelope


@dataclass(frozen=True, eq=False)
class SimulatedRun:
    """A simulated motion.

    Attributes:
        recording: stamps, beam motion, and the first reading only.
        reading: noiseless sensor output, shape (n,) [m].
        position: s, shape (n,) [m].
        size: factor by which the motion was scaled down [1].
    """

    recording: PreparedRecording
    reading: FloatArray
    position: FloatArray
    size: float


class Servo(NamedTuple):
    """The servo that turns the beam behind a transmission.

    Attributes:
        stiffness: 2 ζ ω₀ [1/s].
        limits: of α, α̇, α̈, shape (3,) [rad, rad/s, rad/s²].
        gain, half: beam angle per measured angle [1], with backlash ± `half` [rad].
    """

    stiffness: float
    limits: FloatArray
    gain: float
    half: float


class Feedback(NamedTuple):
    """State feedback: natural frequency `hold` [rad/s], acceleration of the ball per angle `pull` [m/s² per rad]."""

    hold: float
    pull: float


@njit(cache=True)
def _servo_and_ball(
    target: FloatArray, push: FloatArray, dt: float, p: FloatArray, servo: Servo, feedback: Feedback
) -> tuple[FloatArray, FloatArray]:
    """Simulate servo and ball while feedback makes the ball follow `target`, shape (n,) [m].

    Gives α, α̇, α̈ of the measured angle, shape (n, 3), and s, shape (n,) [m]. α̈ is linear between stamps.
    """
    stiffness, limits, gain, half = servo
    hold, pull = feedback
    states, ball = np.empty((len(target), 3)), np.empty(len(target))
    s, v, w, turned, rate, bent = target[0], 0.0, 0.0, 0.0, 0.0, 0.0
    beam, speed = 0.0, 0.0
    motion = np.zeros((3, 3))  # of the beam over a step
    last = len(target) - 1
    for k in range(last + 1):
        states[k, 0], states[k, 1], states[k, 2], ball[k] = turned, rate, bent, s
        ahead, behind = min(k + 1, last), max(k - 1, 0)
        slope = (target[ahead] - target[behind]) / (dt * max(ahead - behind, 1))
        bend = (target[ahead] - 2.0 * target[k] + target[behind]) / dt**2 if 0 < k < last else 0.0
        angle_command = (bend + hold**2 * (target[k] - s) + 2.0 * hold * (slope - v)) / pull + push[k]
        angle_command = min(max(angle_command, -limits[0]), limits[0])
        rate_command = min(max(0.25 * stiffness * (angle_command - turned), -limits[1]), limits[1])
        acceleration_command = min(max(stiffness * (rate_command - rate), -limits[2]), limits[2])
        after = bent + (acceleration_command - bent) * min(1.0, 2.0 * stiffness * dt)
        turned += dt * rate + dt * dt * (2.0 * bent + after) / 6.0
        rate += 0.5 * dt * (bent + after)
        bent = after
        next_beam = min(max(beam, gain * turned - half), gain * turned + half)
        next_speed = gain * rate if next_beam != beam else 0.0
        motion[:, 2] = (next_speed - speed) / dt
        motion[0, :2] = beam, speed
        motion[1, :2] = 0.5 * (beam + next_beam) - 0.125 * dt**2 * motion[0, 2], 0.5 * (speed + next_speed)
        motion[2, :2] = next_beam, next_speed
        s, v, w = advance(s, v, w, dt, motion, 0, p)
        beam, speed = next_beam, next_speed
    return states, ball


def simulate_closed_loop(
    problem: Problem, values: Terms, process_noise: float, profile: Profile, envelope: OperatingEnvelope
) -> SimulatedRun | None:
    """A profile as the model with these terms predicts it; `None` if it cannot be kept within the envelope.

    φ₀ is 0. A spline term of time belongs to its own recordings and is left out.
    """
    size = 1.0
    for _ in range(_ATTEMPTS if envelope.usable else 0):
        states, ball = _simulate(problem, values, profile, envelope, size)
        excess = float(np.max(np.abs(ball - envelope.middle))) / envelope.reach
        if excess <= 1.0 and np.all(np.abs(states).max(axis=0) <= envelope.limits):
            run = _predict(problem, values, process_noise, profile, envelope, size, states, ball)
            if envelope.low <= run.position.min() and run.position.max() <= envelope.high:
                return run
        size *= min(0.9, 0.95 / excess)
    return None


def simulate_with_terms(
    problem: Problem,
    values: Terms,
    process_noise: float,
    profile: Profile,
    envelope: OperatingEnvelope,
    run: SimulatedRun,
) -> SimulatedRun:
    """The motion of `run`, in the same size, with other terms, for which the feedback moves the beam differently."""
    loop = _simulate(problem, values, profile, envelope, run.size)
    return _predict(problem, values, process_noise, profile, envelope, run.size, *loop)


def _simulate(
    problem: Problem, values: Terms, profile: Profile, envelope: OperatingEnvelope, size: float
) -> tuple[FloatArray, FloatArray]:
    """α, α̇, α̈ of the measured angle in closed loop, shape (n, 3), and the ball position s, shape (n,) [m]."""
    move, push = profile.move(envelope.time, envelope)
    target, push = envelope.middle + size * move, size * push
    effects = (*problem.declared, *values.effects_in(values.own_of(profile.name)))
    p = parameters_with(problem.model, problem.rig, effects)
    p[ORIGIN] = target[0]
    spline = repeated(values).spline
    if spline is not None:
        spline.write(p)
    transmission = transmission_with(effects)
    # The stiffness is limited by the sampling interval and by the largest acceleration.
    stiffness = min(_STIFFEST, 0.5 / envelope.interval, np.sqrt(_SOFTER * envelope.acceleration / envelope.angle))
    servo = Servo(float(stiffness), _SHARE * envelope.limits, transmission.gain, 0.5 * transmission.play)
    return _servo_and_ball(target, push, envelope.interval, p, servo, Feedback(profile.hold, envelope.pull))


def _predict(
    problem: Problem,
    values: Terms,
    process_noise: float,
    profile: Profile,
    envelope: OperatingEnvelope,
    size: float,
    states: FloatArray,
    ball: FloatArray,
) -> SimulatedRun:
    reading = np.full(len(states), np.nan)
    reading[0] = values.sensor_in(problem).curve(ball[0])
    recording = PreparedRecording(profile.name, envelope.time, reading, drive_through(envelope.time, states))
    expected = run_filter(problem, recording, repeated(values), process_noise, own=values.own_of(profile.name))
    return SimulatedRun(recording, expected.recorded, expected.state[:, 0], size)


def repeated(values: Terms) -> Terms:
    """The terms that act in other recordings too: all but a spline term of time."""
    if values.spline is not None and values.spline.depends is Regressor.TIME:
        return replace(values, spline=None)
    return values


def drive_through(time: FloatArray, states: FloatArray) -> SmoothedDrive:
    """The drive through exactly known α, α̇, α̈, shape (n, 3), at `time`, shape (n,) [s]."""
    covariance = np.zeros((len(time), 3, 3))
    smoothed = Smoothed(time, states, covariance, np.zeros(len(time) - 1), 0.0)
    exact = AngleSensor(0.0, 0.0, False)
    known = np.zeros(len(time))
    return SmoothedDrive(
        time, states, np.zeros_like(states), exact, 1.0, states[:, 0], smoothed=smoothed, variance=known
    )
