"""Ball and beam as rigid bodies in contact, in inertial Cartesian coordinates.

State of the ball: centre (x, z), velocity (ẋ, ż), turned angle φ and spin ω about +y. The beam is a prescribed body
that turns about the origin. Nothing here knows a reduced equation of motion: the ball feels gravity, an applied force
and the impulses of the contact, and the contact obeys, at the end of every step,

- normal: the centre stays r above the turning edge plane, or the ball flies: 0 <= P_n ⊥ gap velocity >= 0,
- tangential: no slip at the contact line, |P_t| <= μ (R/r) P_n (each of the two contacts carries P_n R/(2 r)),
- rolling: no relative turning, −c₊ r P_n <= M <= c₋ r P_n; on a rolling ball that is the force c N against it, and it
  holds a ball at rest; besides, Dahl's elastic stretch twists it by −r σ z.

The track's own slope enters as `laws` state it, as tilt: gravity is turned by it where the ball is.

Time stepping after Moreau ("Unilateral contact and dry friction in finite freedom dynamics", 1988) with two changes
that make the smooth part second order: impulses act along the mean directions of a step, and positions move with the
mean of old and new velocity. The height is then put back onto the plane, which removes a drift of third order a step.
Steps in which the ball stops or turns round are cut at that instant (`stepping`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import types

from analytic.compiled import njit
from harness.simulator.laws import Laws, ball_torque, dahl, force_along, resistance_coefficients, track_tilt

AppliedForce = Callable[[float, float, float, float, float], float]
"""Extra force on the ball's centre along the beam, F(s [m], ṡ [m/s], α [rad], φ − α [rad], t [s]) -> [N]."""

FORCE_SIGNATURE = types.float64(types.float64, types.float64, types.float64, types.float64, types.float64)
PASSES = 3  # what a pass leaves of an error: (α̇ dt)² < 1e-6 at the contact, dt |∂F/∂ṡ|/m of an applied force


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


class Beam(NamedTuple):
    """The beam at an instant: α [rad], α̇ [rad/s]."""

    angle: float
    rate: float


class Ball(NamedTuple):
    """The ball's state, and the energy it was given and that was taken from it so far [J].

    `along` is s [m]; it stands beside (x, z) so that a ball at rest on a moving beam stays where it is to the bit.
    `stretch` is Dahl's z [m]; the energy it holds counts as taken.
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
    stretch: float


@njit(cache=True)
def clip(value: float, below: float, above: float) -> float:
    """`value` limited to −`below` … `above`."""
    return min(max(value, -below), above)


@njit(cache=True)
def friction(
    slip: float,
    turning: float,
    inverse_mass: float,
    arm: float,
    inverse_inertia: float,
    grip: float,
    hold_plus: float,
    hold_minus: float,
) -> tuple[float, float, bool]:
    """Tangential impulse and rolling impulse moment at a known normal impulse.

    Both set-valued laws together are the stationarity conditions of a convex quadratic programme in (P_t, M) over the
    box |P_t| <= `grip`, −`hold_plus` <= M <= `hold_minus`. Minimised over one variable it stays convex in the other, so
    that clipping one and then the other gives the exact solution.

    Args:
        slip: velocity of the ball's contact line relative to the beam without the two impulses [m/s].
        turning: ω − α̇ without the two impulses [rad/s].
        inverse_mass: 1/m [1/kg].
        arm: r [m].
        inverse_inertia: 1/J [1/(kg m²)].
        grip: bound of |P_t| [N s].
        hold_plus, hold_minus: bounds of M against rolling towards + and − [N m s].

    Returns:
        P_t [N s], M [N m s], and whether neither is at its bound: the ball is at rest on the beam.
    """
    both = inverse_mass + arm * arm * inverse_inertia
    free_moment = -(turning + arm * inverse_inertia * slip / both) * both / (inverse_mass * inverse_inertia)
    moment = clip(free_moment, hold_plus, hold_minus)
    free_tangential = (arm * inverse_inertia * moment - slip) / both
    if abs(free_tangential) <= grip:
        return free_tangential, moment, -hold_plus <= free_moment <= hold_minus
    tangential = clip(free_tangential, grip, grip)
    return tangential, clip(arm * tangential - turning / inverse_inertia, hold_plus, hold_minus), False


@njit(cache=True)
def step(
    ball: Ball, begin: Beam, end: Beam, time: float, dt: float, k: Constants, law: Laws, force: AppliedForce
) -> tuple[Ball, float]:
    """One step, `time` to `time` + `dt` [s], while the beam turns from `begin` to `end`; the ball, and P_n [N s]."""
    m, J, r, height = k.mass, k.inertia, k.rolling_radius, k.eccentricity + k.rolling_radius
    (angle, rate), (next_angle, next_rate) = begin, end
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
    new_vx, new_vz, applied, weight_x, weight_z = vx, vz, 0.0, k.gravity_x, k.gravity_z
    normal, tangential, moment, at_rest, torque, twist, stretch = 0.0, 0.0, 0.0, False, 0.0, 0.0, ball.stretch
    for _ in range(PASSES):
        s_mean = 0.5 * (ball.along + new_x * cos_e - new_z * sin_e)
        rolled = ball.turned + 0.25 * dt * (ball.spin + new_spin) - middle
        v_mean, now = 0.5 * (old_velocity + new_velocity), time + 0.5 * dt
        applied = dt * (force(s_mean, v_mean, middle, rolled, now) + force_along(s_mean, v_mean, middle, now, law))
        tilt = track_tilt(s_mean, law)
        if tilt != 0.0:
            weight_x = k.gravity_x * np.cos(tilt) - k.gravity_z * np.sin(tilt)
            weight_z = k.gravity_z * np.cos(tilt) + k.gravity_x * np.sin(tilt)
        torque = dt * ball_torque(rolled, law)
        new_vx = vx + dt * weight_x + applied * cos_m / m
        new_vz = vz + dt * weight_z - applied * sin_m / m
        free_gap = (x + 0.5 * dt * (vx + new_vx)) * sin_e + (z + 0.5 * dt * (vz + new_vz)) * cos_e - height
        normal = 0.0
        if free_gap <= 0.0:
            # v · n = −α̇ s at the end of the step; the impulses act along the mean directions, half a turn before
            missing = -next_rate * (new_x * cos_e - new_z * sin_e) - (new_vx * sin_e + new_vz * cos_e)
            normal = max((m * missing - tangential * np.sin(turn)) / np.cos(turn), 0.0)
        # a hop does not undo the stretch: in a piece of a step around a turning point it may be one of rounding
        tangential, moment, at_rest, twist, stretch = 0.0, 0.0, False, 0.0, ball.stretch
        if normal > 0.0:
            new_vx += normal * sin_m / m
            new_vz += normal * cos_m / m
            if law.presliding_hysteresis_coefficient != 0.0:
                stretch, stretched = dahl(ball.stretch, dt * v_mean, normal / dt, law)
                twist = -dt * r * law.presliding_hysteresis_stiffness * stretched
            c_plus, c_minus = resistance_coefficients(s_mean, v_mean, rolled, now, law)
            free_spin = ball.spin + (torque + twist) / J
            slip = new_vx * cos_e - new_vz * sin_e - next_rate * k.eccentricity - r * free_spin
            tangential, moment, at_rest = friction(
                slip,
                free_spin - next_rate,
                np.cos(turn) / m,
                r,
                1.0 / J,
                k.grip * normal,
                (k.rolling_arm + c_plus * r) * normal,
                (k.rolling_arm + c_minus * r) * normal,
            )
            new_vx += tangential * cos_m / m
            new_vz -= tangential * sin_m / m
        new_spin = ball.spin + (torque + twist + moment - r * tangential) / J
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

    # energy: what the beam's torque, the applied force and the turned weight gave, what the contact took
    moment += twist
    impulse_x, impulse_z = normal * sin_m + tangential * cos_m, normal * cos_m - tangential * sin_m
    contact_x, contact_z = 0.5 * (x + new_x) - r * sin_m, 0.5 * (z + new_z) - r * cos_m
    given = (contact_z * impulse_x - contact_x * impulse_z + moment) * (next_angle - angle) / dt
    given += 0.5 * applied * ((vx + new_vx) * cos_m - (vz + new_vz) * sin_m)
    given += torque * 0.5 * (ball.spin + new_spin)
    given += m * ((weight_x - k.gravity_x) * (new_x - x) + (weight_z - k.gravity_z) * (new_z - z))
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
        stretch,
    )
    return moved, normal
