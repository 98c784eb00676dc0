"""Driving a hinge to the recorded angle step by step, with the velocity of the chord lent to the contact.

In a step a point p of the beam moves along a chord, and the beam turns under the ball. The hinge lends the contact its
tangential velocity α̇ e_y × p alone, which lacks −½ s α̇² dt along and −(α̇ ṡ + ½ (h + r) α̇²) dt across the beam. Joints
that slide, but stay in place, lend these. That raises the scheme from first to second order in dt: in PyBullet 5.7 µm
became 0.4 µm at 1 ms, and 0.6 µm became 0.004 µm at 0.1 ms.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from typing import Protocol

import numpy as np

from analytic.motion import FloatArray
from harness.engines.leapfrog import Track, track_of
from harness.engines.protocol import Parameters, Task
from harness.engines.watch import STANDSTILL, Samples, finite_force

Pose = tuple[float, ...]
"""Position of the ball's centre in the world [m], then its orientation as the engine has it."""

Stepper = Callable[[float, float, float, float], Pose]
"""One step of a beam that stands at α [rad], turns by α̇ [rad/s] and slides along x and z [m/s]."""


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

    def stepper(self) -> Stepper:
        """What steps it: a function, so that a run looks up once what all its steps need."""
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
    angles, rates = grid.angle.tolist(), grid.rate.tolist()
    cosines, sines = np.cos(grid.angle).tolist(), np.sin(grid.angle).tolist()
    # What a step takes from the beam: α, α̇, cos and sin at its begin and end, and the chord's factors of s, ṡ and 1.
    factors = zip(
        angles,
        rates,
        cosines,
        sines,
        cosines[1:],
        sines[1:],
        (-0.5 * dt * grid.rate**2).tolist(),
        (-dt * grid.rate).tolist(),
        (-0.5 * dt * height * grid.rate**2 - sinking).tolist(),
        strict=False,  # angles are one more than steps
    )
    every, backwards = max(1, round(health_interval / dt)), 1.0 / dt
    step, pose = scene.stepper(), scene.pose()
    poses, samples = array("d", pose), Samples()  # flat: a list of tuples takes five times the memory
    append = poses.extend
    s, speed = pose[0] * cosines[0] - pose[2] * sines[0], first.velocity_along
    speed_before = speed - dt * first.acceleration_along
    look = 0  # the step after which the contacts are sampled next
    for n, (angle, rate, cos, sin, cos_end, sin_end, per_s, per_speed, own) in enumerate(factors):
        now = 1.5 * speed - 0.5 * speed_before  # ṡ extrapolated to t_n
        if force is not None:
            push = finite_force(engine, force, s, now, angle, float(grid.time[n]))
            scene.push(pose, push * cos, -push * sin)
        along, normal = per_s * s, per_speed * now + own
        before, pose = pose, step(angle, rate, along * cos + normal * sin, normal * cos - along * sin)
        append(pose)
        moved = pose[0] * cos_end - pose[2] * sin_end
        speed_before, speed, s = speed, (moved - s) * backwards, moved
        if n == look:
            look += every
            turned = angles[n + 1]
            count, load = scene.contacts(angle)
            samples.add(n, count, load, abs(scene.beam_angle() - turned))
            if pose == before and (abs(turned - angle) > STANDSTILL or scene.ball_speed() > STANDSTILL):
                samples.frozen = n
            off = pose[2] * cos_end + pose[0] * sin_end - height
            if samples.frozen is not None or task.limits.exceeded(s, pose[1], off):
                break
    path = np.asarray(poses).reshape(-1, len(pose))
    return track_of(rig, grid, path[:, :3], scene.spin_angle(path[:, 3:])), samples
