"""What engines that keep velocities half a step behind have in common: grid, start, centred velocities, output.

Semi-implicit Euler is the leapfrog scheme if its velocities are read at t − dt/2. Taken so, positions are of second
order; taken at t, the start alone costs 1.5 mm per ms of dt on the paper's rig.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.geometry import to_world
from analytic.law import acceleration
from analytic.models import CAM, coefficients
from analytic.motion import BallForce, BeamMotion, FloatArray, State, Trajectory, beam_states
from analytic.rig import Rig
from harness.errors import InputError

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Grid:
    """Beam angles on the engine's own time grid t_n = t₀ + n dt, n = 0 … steps.

    The last stamp asked for lies before t_{steps−1}, so that a centred velocity exists on both sides of it.

    Attributes:
        time_step: dt [s].
        time: shape (steps + 1,) [s].
        angle: α, shape (steps + 1,) [rad].
        rate: mean rate (α_{n+1} − α_n)/dt, shape (steps,) [rad/s]; a joint that turns with it meets every α_n.
    """

    time_step: float
    time: FloatArray
    angle: FloatArray
    rate: FloatArray

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.rate)


MOST_STEPS = 4_000_000
"""Largest number of steps of a run: they take some 4 GB of memory, and PyBullet seven minutes."""


def check_steps(duration: float, time_step: float, what: str) -> None:
    """Refuse a run that memory does not hold.

    Args:
        duration: of the run [s].
        time_step: dt [s].
        what: sets the time step, for the message.

    Raises:
        InputError: it takes more than `MOST_STEPS`.
    """
    if duration > MOST_STEPS * time_step:
        steps = duration / time_step
        raise InputError(
            f"{what} is {time_step:g} s: a run would take {steps:.2g} steps and some {1e-6 * steps:.2g} GB of memory; "
            f"give at least {duration / MOST_STEPS:.2g} s"
        )


def grid_of(motion: BeamMotion, stamps: FloatArray, time_step: float) -> Grid:
    """The grid that covers `stamps`, shape (n,) [s].

    A motion is known up to the last stamp only; the rest of the last step continues it with its last derivatives.

    Raises:
        InputError: stamps do not increase, the motion is not finite, or there are more than `MOST_STEPS`.
    """
    stamps = np.asarray(stamps, dtype=float)
    if stamps.ndim != 1 or stamps.size == 0 or not np.isfinite(stamps).all() or (np.diff(stamps) <= 0.0).any():
        raise InputError("the time stamps given to an engine must be finite and strictly increasing")
    first, last = float(stamps[0]), float(stamps[-1])
    check_steps(last - first, time_step, "the engine's time_step")
    cells = math.ceil((last - first) / time_step - 1e-6)  # a stamp 1e-6 dt beyond t_n belongs to t_n
    steps = max(cells, 1) + 1
    time = first + time_step * np.arange(steps + 1, dtype=np.float64)
    beyond = np.maximum(time - last, 0.0)
    known = np.minimum(time, last)
    angle: FloatArray = motion.evaluate(known)
    end = np.array([last])
    angle = angle + beyond * motion.derivative(end)[0] + 0.5 * beyond**2 * motion.derivative(end, 2)[0]
    if not np.isfinite(angle).all():
        bad = float(time[np.flatnonzero(~np.isfinite(angle))[0]])
        raise InputError(f"the beam motion is not finite at t = {bad:.3f} s; check the recorded angle there")
    return Grid(time_step, time, angle, np.asarray(np.diff(angle) / time_step, dtype=np.float64))


def beam_on(grid: Grid, motion: BeamMotion, stamps: FloatArray) -> FloatArray:
    """α [rad], α̇ [rad/s], α̈ [rad/s²] of the motion on the grid, shape (steps + 1, 3); constant beyond the stamps."""
    return beam_states(motion, np.minimum(grid.time, stamps[-1]))


@dataclass(frozen=True)
class Start:
    """The ball at t₀, with velocities at t₀ − dt/2.

    Attributes:
        centre: of the ball at t₀, world frame [m].
        velocity: of the centre at t₀ − dt/2, world frame [m/s].
        spin: φ̇ about +y at t₀ − dt/2 [rad/s].
        beam_rate: α̇ at t₀ − dt/2 [rad/s].
        velocity_along: ṡ at t₀ − dt/2 [m/s].
        acceleration_along: s̈ at t₀ [m/s²].
    """

    centre: Vector
    velocity: Vector
    spin: float
    beam_rate: float
    velocity_along: float
    acceleration_along: float


def start_of(rig: Rig, motion: BeamMotion, grid: Grid, start: State, force: BallForce | None) -> Start:
    """The rolling ball half a step before t₀; eq. 14 gives s̈ at t₀, everything later is the engine's."""
    first, dt = grid.time[:1], grid.time_step
    angle, rate, turn = beam_states(motion, first)[0].tolist()
    s, v, r = start.position, start.velocity, rig.rolling_radius
    extra = force(s, v, angle, float(first[0])) / rig.mass if force else 0.0
    along_beam = acceleration(s, v, angle, rate, turn, coefficients(CAM, rig)) + rig.rolling_ratio * extra
    height = rig.eccentricity + r
    now = to_world(s, 0.0, height, angle)
    before = to_world(s - v * dt + 0.5 * along_beam * dt**2, 0.0, height, angle - rate * dt + 0.5 * turn * dt**2)
    along = v - 0.5 * dt * along_beam
    return Start(
        centre=now,
        velocity=((now[0] - before[0]) / dt, 0.0, (now[2] - before[2]) / dt),
        spin=along / r + rate - 0.5 * dt * turn,
        beam_rate=rate - 0.5 * dt * turn,
        velocity_along=along,
        acceleration_along=along_beam,
    )


@dataclass(frozen=True)
class Track:
    """The ball's path in the beam frame on the engine's grid; all of shape (k,), k at most steps + 1.

    Attributes:
        along: s [m].
        across: y [m].
        height: of the centre above the edge plane [m].
        rolled: φ − α since the start, from the engine's spin [rad].
    """

    along: FloatArray
    across: FloatArray
    height: FloatArray
    rolled: FloatArray


def track_of(rig: Rig, grid: Grid, centres: FloatArray, spin_angle: FloatArray) -> Track:
    """Turn world positions, shape (k, 3) [m], and the ball's angle about +y, shape (k,) [rad], into the beam frame."""
    x, y, z = centres.T
    angle = grid.angle[: len(centres)]
    cos, sin = np.cos(angle), np.sin(angle)
    return Track(
        along=x * cos - z * sin,
        across=y,
        height=z * cos + x * sin - rig.eccentricity,
        rolled=spin_angle - spin_angle[0] - (angle - angle[0]),
    )


def spin_angle_of(sine: FloatArray, cosine: FloatArray) -> FloatArray:
    """Angle turned about +y [rad], shape (k,), from the quaternions' y and w parts; a step may turn by less than π."""
    angle = 2.0 * np.arctan2(sine, cosine)
    change = np.diff(angle)
    jumps = np.flatnonzero(np.abs(change) > np.pi)  # few: `np.unwrap` would work on every step
    turns = np.zeros_like(angle)
    turns[jumps + 1] = np.round(change[jumps] / (2.0 * np.pi))
    return angle - 2.0 * np.pi * np.cumsum(turns) if jumps.size else angle


def sample(
    source: str, rig: Rig, grid: Grid, track: Track, start: State, stamps: FloatArray
) -> tuple[Trajectory, FloatArray]:
    """Trajectory and rolled angle [rad] at exactly the stamps, by cubic Hermite interpolation of the grid.

    Node velocities are centred differences, the mean of the velocities half a step before and after; at t₀ the ball
    rolls with the velocity it was given.
    """
    stamps = np.asarray(stamps, dtype=float)
    # Splines of all steps would take longer than all else around an engine's steps: only cells with a stamp are used.
    cells = np.searchsorted(grid.time[1:-2], stamps, side="right")
    at = (stamps - grid.time[cells]) / grid.time_step
    position, velocity = _hermite(track.along, cells, at, grid.time_step, start.velocity)
    rolled, _ = _hermite(track.rolled, cells, at, grid.time_step, start.velocity / rig.rolling_radius)
    return Trajectory(source, stamps.copy(), position, velocity), rolled


def _hermite(
    nodes: FloatArray, cells: NDArray[np.intp], at: FloatArray, dt: float, first: float
) -> tuple[FloatArray, FloatArray]:
    """Cubic Hermite interpolation, and its derivative.

    Args:
        nodes: values at the steps, shape (k,).
        cells: in which a value is wanted, from its step to the next, shape (n,).
        at: where in its cell, 0 … 1, or beyond, shape (n,).
        dt: distance of the steps [s].
        first: derivative at the first step.
    """
    begin, end = nodes[cells], nodes[cells + 1]
    change = end - begin
    slope = np.where(cells == 0, dt * first, 0.5 * (end - nodes[cells - 1]))
    after = 0.5 * (nodes[cells + 2] - begin)
    square, cube = 3.0 * change - 2.0 * slope - after, slope + after - 2.0 * change
    value = begin + at * (slope + at * (square + at * cube))
    return value, (slope + at * (2.0 * square + 3.0 * at * cube)) / dt
