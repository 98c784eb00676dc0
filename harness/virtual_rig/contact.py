"""Ball and beam as rigid bodies in contact, in inertial Cartesian coordinates.

State of the ball: centre (x, z), velocity (ẋ, ż), turned angle φ and spin ω about +y. The beam is a prescribed body
that turns about the origin. Nothing here knows a reduced equation of motion: the ball feels gravity, an applied force
and the impulses of the contact, and the contact obeys, at the end of every step,

- normal: the centre stays r above the turning edge plane, or the ball flies: 0 <= P_n ⊥ gap velocity >= 0,
- tangential: no slip at the contact line, |P_t| <= μ (R/r) P_n (each of the two contacts carries P_n R/(2 r)),
- rolling: no relative turning, |M| <= c r P_n; on a rolling ball that is the force c N, and it holds a ball at rest.

Time stepping after Moreau ("Unilateral contact and dry friction in finite freedom dynamics", 1988) with two changes
that make the smooth part second order: impulses act along the mean directions of a step, and positions move with the
mean of old and new velocity. The height is then put back onto the plane, which removes a drift of third order a step.
Steps in which the ball stops or turns round are cut at that instant.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit, types

from analytic.motion import FloatArray

AppliedForce = Callable[[float, float, float, float, float], float]
"""Extra force on the ball's centre along the beam, F(s [m], ṡ [m/s], α [rad], φ − α [rad], t [s]) -> [N]."""

FORCE_SIGNATURE = types.float64(types.float64, types.float64, types.float64, types.float64, types.float64)
PASSES = 3  # what a pass leaves of an error: (α̇ dt)² < 1e-6 at the contact, dt |∂F/∂ṡ|/m of an applied force
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


class Constants(NamedTuple):
    """What the contact needs to know, SI units: m, J, r, h, gravity along x and z, μ R/r [1], c r [m]."""

    mass: float
    inertia: float
    rolling_radius: float
    eccentricity: float
    gravity_x: float
    gravity_z: float
    grip: float
    rolling_arm: float


class Ball(NamedTuple):
    """The ball's state, and the energy it was given and that was taken from it so far [J].

    `along` is s [m]; it stands beside (x, z) so that a ball at rest on a moving beam stays where it is to the bit.
    """

    x: float
    z: float
    velocity_x: float
    velocity_z: float
    turned: float
    spin: float
    along: float
    given: float
    taken: float


@njit(cache=True)
def clip(value: float, bound: float) -> float:
    """`value` limited to ±`bound`."""
    return min(max(value, -bound), bound)


@njit(cache=True)
def friction(
    slip: float,
    turning: float,
    inverse_mass: float,
    arm: float,
    inverse_inertia: float,
    grip: float,
    hold: float,
) -> tuple[float, float, bool]:
    """Tangential impulse and rolling impulse moment at a known normal impulse.

    Both set-valued laws together are the stationarity conditions of a convex quadratic programme in (P_t, M) over the
    box |P_t| <= `grip`, |M| <= `hold`. Minimised over one variable it stays convex in the other, so that clipping one
    and then the other gives the exact solution.

    Args:
        slip: velocity of the ball's contact line relative to the beam without the two impulses [m/s].
        turning: ω − α̇ without the two impulses [rad/s].
        inverse_mass: 1/m [1/kg].
        arm: r [m].
        inverse_inertia: 1/J [1/(kg m²)].
        grip: bound of |P_t| [N s].
        hold: bound of |M| [N m s].

    Returns:
        P_t [N s], M [N m s], and whether neither is at its bound: the ball is at rest on the beam.
    """
    both = inverse_mass + arm * arm * inverse_inertia
    free_moment = -(turning + arm * inverse_inertia * slip / both) * both / (inverse_mass * inverse_inertia)
    moment = clip(free_moment, hold)
    free_tangential = (arm * inverse_inertia * moment - slip) / both
    if abs(free_tangential) <= grip:
        return free_tangential, moment, abs(free_moment) <= hold
    tangential = clip(free_tangential, grip)
    return tangential, clip(arm * tangential - turning / inverse_inertia, hold), False


@njit(cache=True)
def step(
    ball: Ball,
    angle: float,
    rate: float,
    next_angle: float,
    next_rate: float,
    time: float,
    dt: float,
    k: Constants,
    force: AppliedForce,
) -> tuple[Ball, float]:
    """One step of the ball while the beam turns from `angle` to `next_angle`; returns the ball and P_n [N s]."""
    m, J, r, height = k.mass, k.inertia, k.rolling_radius, k.eccentricity + k.rolling_radius
    x, z, vx, vz = ball.x, ball.z, ball.velocity_x, ball.velocity_z
    middle, turn = 0.5 * (angle + next_angle), 0.5 * (next_angle - angle)
    sin, cos = np.sin(angle), np.cos(angle)
    sin_m, cos_m = np.sin(middle), np.cos(middle)
    sin_e, cos_e = np.sin(next_angle), np.cos(next_angle)

    # relative velocities at the start of the step: of centre and beam frame, of the contact line, of the gap
    old_velocity = vx * cos - vz * sin - rate * (x * sin + z * cos)
    old_slip = old_velocity - r * (ball.spin - rate)
    old_opening = vx * sin + vz * cos + rate * (x * cos - z * sin)

    new_x, new_z, new_velocity, new_spin = x + dt * vx, z + dt * vz, old_velocity, ball.spin
    new_vx, new_vz, applied = vx, vz, 0.0
    normal, tangential, moment, at_rest = 0.0, 0.0, 0.0, False
    for _ in range(PASSES):
        s_mean = 0.5 * (ball.along + new_x * cos_e - new_z * sin_e)
        rolled = ball.turned + 0.25 * dt * (ball.spin + new_spin) - middle
        applied = dt * force(s_mean, 0.5 * (old_velocity + new_velocity), middle, rolled, time + 0.5 * dt)
        new_vx = vx + dt * k.gravity_x + applied * cos_m / m
        new_vz = vz + dt * k.gravity_z - applied * sin_m / m
        free_gap = (x + 0.5 * dt * (vx + new_vx)) * sin_e + (z + 0.5 * dt * (vz + new_vz)) * cos_e - height
        normal = 0.0
        if free_gap <= 0.0:
            # v · n = −α̇ s at the end of the step; the impulses act along the mean directions, half a turn before
            missing = -next_rate * (new_x * cos_e - new_z * sin_e) - (new_vx * sin_e + new_vz * cos_e)
            normal = max((m * missing - tangential * np.sin(turn)) / np.cos(turn), 0.0)
        tangential, moment, at_rest = 0.0, 0.0, False
        if normal > 0.0:
            new_vx += normal * sin_m / m
            new_vz += normal * cos_m / m
            slip = new_vx * cos_e - new_vz * sin_e - next_rate * k.eccentricity - r * ball.spin
            tangential, moment, at_rest = friction(
                slip, ball.spin - next_rate, np.cos(turn) / m, r, 1.0 / J, k.grip * normal, k.rolling_arm * normal
            )
            new_vx += tangential * cos_m / m
            new_vz -= tangential * sin_m / m
        new_spin = ball.spin + (moment - r * tangential) / J
        new_x = x + 0.5 * dt * (vx + new_vx)
        new_z = z + 0.5 * dt * (vz + new_vz)
        new_velocity = new_vx * cos_e - new_vz * sin_e - next_rate * (new_x * sin_e + new_z * cos_e)

    along = new_x * cos_e - new_z * sin_e
    if normal > 0.0:
        if at_rest:
            along = ball.along
        new_x, new_z = along * cos_e + height * sin_e, height * cos_e - along * sin_e
        if at_rest:  # carried by the beam like a part of it: assigned, so that rounding cannot make it creep
            new_vx, new_vz, new_spin, new_velocity = next_rate * new_z, -next_rate * new_x, next_rate, 0.0

    # energy: what the beam's torque and the applied force gave, what the relative velocities at the contact took
    impulse_x, impulse_z = normal * sin_m + tangential * cos_m, normal * cos_m - tangential * sin_m
    contact_x, contact_z = 0.5 * (x + new_x) - r * sin_m, 0.5 * (z + new_z) - r * cos_m
    given = (contact_z * impulse_x - contact_x * impulse_z + moment) * (next_angle - angle) / dt
    given += 0.5 * applied * ((vx + new_vx) * cos_m - (vz + new_vz) * sin_m)
    new_slip = new_velocity - r * (new_spin - next_rate)
    new_opening = new_vx * sin_e + new_vz * cos_e + next_rate * along
    turning = ball.spin - rate + new_spin - next_rate
    taken = -0.5 * (normal * (old_opening + new_opening) + tangential * (old_slip + new_slip) + moment * turning)
    moved = Ball(
        new_x,
        new_z,
        new_vx,
        new_vz,
        ball.turned + 0.5 * dt * (ball.spin + new_spin),
        new_spin,
        along,
        ball.given + given,
        ball.taken + taken,
    )
    return moved, normal


@njit(cache=True)
def careful_step(
    ball: Ball,
    angle: float,
    rate: float,
    next_angle: float,
    next_rate: float,
    time: float,
    dt: float,
    k: Constants,
    force: AppliedForce,
) -> tuple[Ball, float]:
    """`step`, cut into pieces around the instant at which the ball stops rolling one way.

    Resistance changes its sign there. A single step would give the new sign to all of it: a velocity error of first
    order at every turning point, where everything else is of second.
    """
    normal, done = 0.0, 0.0
    start, start_rate, acceleration = angle, rate, (next_rate - rate) / dt
    while done < dt:
        piece = dt - done
        end_angle, end_rate = next_angle, next_rate
        moved, impulse = step(ball, angle, rate, end_angle, end_rate, time + done, piece, k, force)
        while piece > FINEST * dt and (ball.spin - rate) * (moved.spin - end_rate) <= 0.0 and ball.spin != rate:
            piece *= 0.5
            end_rate = start_rate + (done + piece) * acceleration
            end_angle = start + (done + piece) * 0.5 * (start_rate + end_rate)
            moved, impulse = step(ball, angle, rate, end_angle, end_rate, time + done, piece, k, force)
        ball, angle, rate = moved, end_angle, end_rate
        normal += impulse
        done += piece
    return ball, normal


@njit(cache=True)
def describe(ball: Ball, angle: float, rate: float, normal_force: float, k: Constants, row: FloatArray) -> None:
    """Write what is observable at an instant into `row`, shape (COLUMNS,), in the order of COLUMNS."""
    sin, cos = np.sin(angle), np.cos(angle)
    velocity = (ball.velocity_x * cos - ball.velocity_z * sin) - (rate * ball.z * cos + rate * ball.x * sin)
    kinetic = k.mass * (ball.velocity_x**2 + ball.velocity_z**2) + k.inertia * ball.spin**2
    row[0] = ball.along
    row[1] = velocity
    row[2] = ball.turned - angle
    row[3] = ball.spin
    row[4] = velocity - k.rolling_radius * (ball.spin - rate)
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
        force: F(s, ṡ, α, φ − α, t) along the beam [N], compiled to FORCE_SIGNATURE.
        rows: filled for the instants 1 … n, shape (n, len(COLUMNS)); the normal force is the mean over a step.

    Returns:
        The ball at the last instant.
    """
    for i in range(rows.shape[0]):
        ball, normal = careful_step(ball, angle[i], rate[i], angle[i + 1], rate[i + 1], start + i * dt, dt, k, force)
        describe(ball, angle[i + 1], rate[i + 1], normal / dt, k, rows[i])
    return ball
