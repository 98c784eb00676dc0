"""A rehearsal: the model plays a move in closed loop, so that its ball stays on the beam; the beam's angle is kept.

The beam is a servo with limits; the ball is held to its target by state feedback. The model then plays the angle alone,
through the filter itself, with no reading but the first: that is the noiseless recording which it expects.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analytic.compiled import njit
from analytic.effects import parameters_with, transmission_with
from analytic.models import ORIGIN
from analytic.motion import FloatArray
from analytic.step import advance
from harness.identify.design.excitation import OperatingEnvelope, Profile
from harness.identify.filter.run import run_filter
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import Regressor
from harness.signals.drive import AngleSensor, Drive
from harness.signals.spline_smoother import Smoothed

_STIFFEST = 28.0  # [1/s]: 2 ζ ω₀ of a servo with ω₀ = 14 rad/s and ζ = 1
_SOFTER = 12.0  # a third of the largest angle, asked for at once, then takes all of the acceleration
_SHARE = 0.9  # of the limits that the servo uses; it overshoots a little
_ATTEMPTS = 5  # a move that the rig cannot make is tried smaller


@dataclass(frozen=True, eq=False)
class SimulatedRun:
    """A move as a model expects it.

    Attributes:
        recording: stamps, the beam's motion, and the first reading alone.
        reading: what the sensor would record without noise, shape (n,) [m].
        position: s, shape (n,) [m].
        size: by which the move was made smaller [1].
    """

    recording: PreparedRecording
    reading: FloatArray
    position: FloatArray
    size: float


@njit(cache=True, nogil=True)
def _play(
    target: FloatArray,
    push: FloatArray,
    dt: float,
    p: FloatArray,
    gain: float,
    half: float,
    hold: float,
    pull: float,
    limits: FloatArray,
    servo: float,
    states: FloatArray,
    ball: FloatArray,
) -> None:
    """Let the servo turn while feedback holds the ball to `target`, shape (n,) [m].

    Fills `states`, α, α̇, α̈ of the measured angle, shape (n, 3), and `ball`, s, shape (n,) [m]. α̈ runs linearly between
    stamps. The beam is `gain` times the angle, behind play of ± `half` [rad]; `limits` are those of α, α̇, α̈.
    """
    s, v, w, turned, rate, bent = target[0], 0.0, 0.0, 0.0, 0.0, 0.0
    beam, speed = 0.0, 0.0
    motion = np.zeros((3, 3))  # of the beam over a step
    last = len(target) - 1
    for k in range(last + 1):
        states[k, 0], states[k, 1], states[k, 2], ball[k] = turned, rate, bent, s
        ahead, behind = min(k + 1, last), max(k - 1, 0)
        slope = (target[ahead] - target[behind]) / (dt * max(ahead - behind, 1))
        curve = (target[ahead] - 2.0 * target[k] + target[behind]) / dt**2 if 0 < k < last else 0.0
        wanted = (curve + hold**2 * (target[k] - s) + 2.0 * hold * (slope - v)) / pull + push[k]
        wanted = min(max(wanted, -limits[0]), limits[0])
        quick = min(max(0.25 * servo * (wanted - turned), -limits[1]), limits[1])
        asked = min(max(servo * (quick - rate), -limits[2]), limits[2])
        after = bent + (asked - bent) * min(1.0, 2.0 * servo * dt)
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


def simulate_closed_loop(
    problem: Problem, values: Terms, process_noise: float, profile: Profile, envelope: OperatingEnvelope
) -> SimulatedRun | None:
    """What the model with these `values` expects of a profile; `None` where the ball cannot be kept in the room.

    A ball out of balance begins with φ₀ = 0; a curve of time is bound to its own recordings and is not expected again.
    """
    size = 1.0
    for _ in range(_ATTEMPTS if envelope.usable else 0):
        states, ball = _perform(problem, values, profile, envelope, size)
        beyond = float(np.max(np.abs(ball - envelope.middle))) / envelope.reach
        if beyond <= 1.0 and np.all(np.abs(states).max(axis=0) <= envelope.limits):
            made = _expect(problem, values, process_noise, profile, envelope, size, states, ball)
            if envelope.low <= made.position.min() and made.position.max() <= envelope.high:
                return made
        size *= min(0.9, 0.95 / beyond)
    return None


def simulate_with_terms(
    problem: Problem,
    values: Terms,
    process_noise: float,
    profile: Profile,
    envelope: OperatingEnvelope,
    made: SimulatedRun,
) -> SimulatedRun:
    """The same move, of the same size, where other `values` act: the feedback then turns the beam otherwise."""
    return _expect(
        problem,
        values,
        process_noise,
        profile,
        envelope,
        made.size,
        *_perform(problem, values, profile, envelope, made.size),
    )


def _perform(
    problem: Problem, values: Terms, profile: Profile, envelope: OperatingEnvelope, size: float
) -> tuple[FloatArray, FloatArray]:
    """States of the measured angle, shape (n, 3), and where the ball is, shape (n,) [m]."""
    move, push = profile.move(envelope.time, envelope)
    target, push = envelope.middle + size * move, size * push
    effects = (*problem.declared, *values.effects)
    p = parameters_with(problem.model, problem.rig, effects)
    p[ORIGIN] = target[0]
    spline = repeated(values).spline
    if spline is not None:
        spline.write(p)
    transmission = transmission_with(effects)
    states, ball = np.empty((len(target), 3)), np.empty(len(target))
    # As stiff as readings this far apart allow, and no stiffer than its acceleration is good for.
    servo = min(_STIFFEST, 0.5 / envelope.interval, np.sqrt(_SOFTER * envelope.acceleration / envelope.angle))
    _play(
        target,
        push,
        envelope.interval,
        p,
        transmission.gain,
        0.5 * transmission.play,
        profile.hold,
        envelope.pull,
        _SHARE * envelope.limits,
        servo,
        states,
        ball,
    )
    return states, ball


def _expect(
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
    reading[0] = problem.sensor(values.effects)[0] * ball[0]
    recording = PreparedRecording(profile.name, envelope.time, reading, drive_through(envelope.time, states))
    expected = run_filter(problem, recording, repeated(values), process_noise, phase=0.0)
    return SimulatedRun(recording, expected.recorded, expected.state[:, 0], size)


def repeated(values: Terms) -> Terms:
    """What acts in another recording as well: all but a curve of time."""
    if values.spline is not None and values.spline.depends is Regressor.TIME:
        return replace(values, spline=None)
    return values


def drive_through(time: FloatArray, states: FloatArray) -> Drive:
    """The beam's motion through α, α̇, α̈ that are known exactly, shape (n, 3), at `time`, shape (n,) [s]."""
    nothing = np.zeros((len(time), 3, 3))
    smoothed = Smoothed(time, states, nothing, np.zeros(len(time) - 1), 0.0)
    return Drive(time, states, np.zeros_like(states), AngleSensor(0.0, 0.0, False), 1.0, smoothed, np.zeros(len(time)))
