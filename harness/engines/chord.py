"""Driving a hinge to the recorded angle step by step, with the velocity of the chord lent to the contact.

In a step a point p of the beam moves along a chord, and the beam turns under the ball. The hinge lends the contact its
tangential velocity α̇ e_y × p alone, which lacks −½ s α̇² dt along and −(α̇ ṡ + ½ (h + r) α̇²) dt across the beam. Joints
that slide, but stay in place, lend these. That raises the scheme from first to second order in dt: in PyBullet 5.7 µm
became 0.4 µm at 1 ms, and 0.6 µm became 0.004 µm at 0.1 ms.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from analytic.motion import FloatArray
from harness.engines.leapfrog import Track, track_of
from harness.engines.protocol import Parameters, Task
from harness.engines.watch import STANDSTILL, Samples, finite_force

Pose = tuple[float, ...]
"""Position of the ball's centre in the world [m], then its orientation as the engine has it."""


class Scene(Protocol):
    """A loaded engine with the ball where it starts."""

    def pose(self) -> Pose:
        """Of the ball."""
        ...

    def spin_angle(self, orientations: FloatArray) -> FloatArray:
        """Angle turned about +y [rad], shape (k,), from a run's orientations, shape (k, …)."""
        ...

    def push(self, pose: Pose, x: float, z: float) -> None:
        """Let a force act on the centre of the ball, which is at `pose`, in the next step [N]."""
        ...

    def step(self, angle: float, rate: float, x: float, z: float) -> Pose:
        """One step of a beam that stands at α [rad], turns by α̇ [rad/s] and slides with these velocities [m/s]."""
        ...

    def contacts(self, angle: float) -> tuple[int, float]:
        """Contacts that carry a force, and the sum of their forces normal to the edge plane at α [rad], [N]."""
        ...

    def beam_angle(self) -> float:
        """α in the engine [rad]."""
        ...

    def ball_speed(self) -> float:
        """|velocity| of the ball's centre [m/s]."""
        ...


def follow(
    engine: str, scene: Scene, task: Task[Parameters], health_interval: float, sinking: float = 0.0
) -> tuple[Track, Samples]:
    """Steps through the grid; stops early if the run is invalid.

    Args:
        engine: its name.
        scene: at the first instant.
        task: what to simulate.
        health_interval: time between two samples of the contacts [s].
        sinking: velocity of the beam's surface away from the ball [m/s].
    """
    rig, grid, first, force = task.rig, task.grid, task.first, task.force
    dt, height = grid.time_step, rig.eccentricity + rig.rolling_radius
    angles, rates, times = grid.angle.tolist(), grid.rate.tolist(), grid.time.tolist()
    cosines, sines = np.cos(grid.angle).tolist(), np.sin(grid.angle).tolist()
    every = max(1, round(health_interval / dt))
    pose = scene.pose()
    poses, samples = [pose], Samples()
    s, speed = pose[0] * cosines[0] - pose[2] * sines[0], first.velocity_along
    speed_before = speed - dt * first.acceleration_along
    for n in range(grid.steps):
        cos, sin, rate, now = cosines[n], sines[n], rates[n], 1.5 * speed - 0.5 * speed_before  # ṡ extrapolated to t_n
        along = -0.5 * dt * s * rate * rate
        normal = -dt * rate * (now + 0.5 * height * rate) - sinking
        if force is not None:
            push = finite_force(engine, force, s, now, angles[n], times[n])
            scene.push(pose, push * cos, -push * sin)
        before, pose = pose, scene.step(angles[n], rate, along * cos + normal * sin, normal * cos - along * sin)
        poses.append(pose)
        moved = pose[0] * cosines[n + 1] - pose[2] * sines[n + 1]
        speed_before, speed, s = speed, (moved - s) / dt, moved
        if n % every == 0:
            count, load = scene.contacts(angles[n])
            samples.add(n, count, load, abs(scene.beam_angle() - angles[n + 1]))
            if pose == before and (abs(angles[n + 1] - angles[n]) > STANDSTILL or scene.ball_speed() > STANDSTILL):
                samples.frozen = n
            off = pose[2] * cosines[n + 1] + pose[0] * sines[n + 1] - height
            if samples.frozen is not None or task.limits.exceeded(s, pose[1], off):
                break
    path = np.array(poses)
    return track_of(rig, grid, path[:, :3], scene.spin_angle(path[:, 3:])), samples
