"""The ball's way through a given beam motion, and what can be observed of it at every instant."""

from __future__ import annotations

import numpy as np

from analytic.compiled import njit
from analytic.motion import FloatArray
from harness.simulator.contact import AppliedForce, Ball, Beam, Constants, step
from harness.simulator.laws import Laws

ROLLING = 1e-12  # slip that may be rounding [m/s]
FINEST = 2.0**-10  # part of a step to which the instant of turning round is found
COLUMNS = (
    "position",
    "velocity",
    "rolled_angle",
    "spin",
    "slip",
    "gap",
    "normal_force",
    "energy",
    "work",
    "dissipated",
)


@njit(cache=True)
def velocity_of(ball: Ball, beam: Beam) -> float:
    """ṡ [m/s] on the beam as it now is."""
    sin, cos, rate = np.sin(beam.angle), np.cos(beam.angle), beam.rate
    return float((ball.velocity_x * cos - ball.velocity_z * sin) - (rate * ball.z * cos + rate * ball.x * sin))


@njit(cache=True)
def slip_of(ball: Ball, beam: Beam, k: Constants) -> float:
    """ṡ − r (ω − α̇) [m/s]."""
    return velocity_of(ball, beam) - k.rolling_radius * (ball.spin - beam.rate)


@njit(cache=True)
def careful_step(
    ball: Ball, begin: Beam, end: Beam, time: float, dt: float, k: Constants, law: Laws, force: AppliedForce
) -> tuple[Ball, float]:
    """`step`, cut into pieces around the instant at which the ball stops rolling, or sliding, one way.

    Resistance or friction changes its sign there. A single step would give the new sign to all of it: a velocity error
    of first order at every turning point, where everything else is of second.
    """
    normal, done = 0.0, 0.0
    beam, acceleration = begin, (end.rate - begin.rate) / dt
    while done < dt:
        piece, sliding, reached = dt - done, slip_of(ball, beam, k), end
        moved, impulse = step(ball, beam, reached, time + done, piece, k, law, force)
        while piece > FINEST * dt and (
            ((ball.spin - beam.rate) * (moved.spin - reached.rate) <= 0.0 and ball.spin != beam.rate)
            or (abs(sliding) > ROLLING and sliding * slip_of(moved, reached, k) <= ROLLING * abs(sliding))
        ):
            piece *= 0.5
            rate = begin.rate + (done + piece) * acceleration
            reached = Beam(begin.angle + (done + piece) * 0.5 * (begin.rate + rate), rate)
            moved, impulse = step(ball, beam, reached, time + done, piece, k, law, force)
        ball, beam = moved, reached
        normal += impulse
        done += piece
    return ball, normal


@njit(cache=True)
def describe(ball: Ball, beam: Beam, normal_force: float, k: Constants, row: FloatArray) -> None:
    """Write what is observable at an instant into `row`, shape (COLUMNS,), in the order of COLUMNS."""
    sin, cos = np.sin(beam.angle), np.cos(beam.angle)
    kinetic = k.mass * (ball.velocity_x**2 + ball.velocity_z**2) + k.inertia * ball.spin**2
    row[0] = ball.along
    row[1] = velocity_of(ball, beam)
    row[2] = ball.turned - beam.angle
    row[3] = ball.spin
    row[4] = slip_of(ball, beam, k)
    row[5] = ball.x * sin + ball.z * cos - k.eccentricity - k.rolling_radius
    row[6] = normal_force
    row[7] = 0.5 * kinetic - k.mass * (k.gravity_x * ball.x + k.gravity_z * ball.z)
    row[8] = ball.given
    row[9] = ball.taken


@njit(cache=True)
def advance(
    ball: Ball,
    angle: FloatArray,
    rate: FloatArray,
    start: float,
    dt: float,
    k: Constants,
    law: Laws,
    force: AppliedForce,
    rows: FloatArray,
) -> Ball:
    """Step through a given beam motion.

    Args:
        ball: state at the first instant.
        angle: α at the instants, shape (n + 1,) [rad].
        rate: α̇ there, shape (n + 1,) [rad/s].
        start: time of the first instant [s].
        dt: distance of the instants [s].
        k: constants of the contact.
        law: what acts.
        force: F(s, ṡ, α, φ − α, t) along the beam [N], compiled to FORCE_SIGNATURE.
        rows: filled for the instants 1 … n, shape (n, len(COLUMNS)); the normal force is the mean over a step.

    Returns:
        The ball at the last instant.
    """
    for i in range(rows.shape[0]):
        begin, end = Beam(angle[i], rate[i]), Beam(angle[i + 1], rate[i + 1])
        ball, normal = careful_step(ball, begin, end, start + i * dt, dt, k, law, force)
        describe(ball, end, normal / dt, k, rows[i])
    return ball
