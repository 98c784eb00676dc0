"""Recordings of a controlled ball on a flat beam with end stops, which may be pushed.

A plant of a page that shares no code with the models:
(1 + 2/5) s̈ = g sin α + s α̇² − (h + 2/5 r) α̈ − d ṡ between the stops, by Newton and Euler for a rolling ball of radius
r whose centre is h above the pivot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from analytic.motion import FloatArray

GRAVITY, LEVER = 9.81, 0.028  # m/s², h + 2/5 r of a ball of 40 mm whose beam turns about its rolling plane [m]
STOP = 0.2  # both stops' distance from the pivot [m]
RATE = 50  # Hz
FINE = 1000  # steps a second
PUSHED = 0.05  # how long a push takes [s]


class Stopped(NamedTuple):
    """What was recorded, and 1 where the ball touched a stop since the reading before; shape (n,) each, SI units."""

    time: FloatArray
    angle: FloatArray
    position: FloatArray
    touching: FloatArray

    @property
    def columns(self) -> dict[str, FloatArray]:
        """What a file of it holds, by the names of its columns."""
        return {"time_s": self.time, "beam_angle_rad": self.angle, "ball_position_m": self.position}


@dataclass(frozen=True)
class Run:
    """What is done to the ball.

    Attributes:
        held: how long the beam falls outwards before the controller starts, with the ball at the stop it falls to [s].
        swing: how far from the pivot the controller wants the ball, at either side in turn [m].
        speed_gain: of the controller, α over ṡ [s/m]; a small one lets the ball overshoot to the stops.
        damping: d over the ball's mass [1/s].
        delay: of the position against the angle [s].
        linkage: recorded over real angle [1].
        noise: of a position [m].
        commanded: the controller reads what is recorded, as often, and its command is recorded in place of the angle.
        pushes: changes of the ball's velocity [m/s], by the time from which on each takes 50 ms [s].
    """

    held: float = 0.0
    swing: float = 0.1
    speed_gain: float = 0.55
    damping: float = 0.0
    delay: float = 0.0
    linkage: float = 1.0
    noise: float = 1e-3
    commanded: bool = False
    pushes: Mapping[float, float] = field(default_factory=dict)


def stopped(run: Run, *, seed: int, duration: float = 14.0) -> Stopped:
    """A recording, with rounding to 0.5 mm."""
    random = np.random.default_rng(seed)
    side = float(random.choice((-1.0, 1.0)))
    s, ds = (side * STOP, 0.0) if run.held else (0.0, 0.0)
    alpha = command = side * 0.08 if run.held else 0.0
    turning = seen = speed = touched = dds = 0.0
    late = [(alpha, 0.0, 0.0)] * round(run.delay * FINE)
    rows = []
    rate = RATE if run.commanded else 100
    for k in range(round(duration * FINE)):
        t = k / FINE
        if k % (FINE // rate) == 0:  # the controller
            reading = s + random.normal(0.0, run.noise if run.commanded else 0.3 * run.noise)
            speed = 0.8 * speed + 0.2 * (reading - seen) * rate if k else 0.0
            seen = reading
            if t >= run.held:
                wanted = run.swing * (1.0 if (t - run.held) % 6.0 < 3.0 else -1.0)
                command = float(np.clip(wanted - s - run.speed_gain * speed, -0.14, 0.14))
        jerked = float(np.clip(225.0 * (command - alpha) - 24.0 * turning, -60.0, 60.0))
        alpha += turning / FINE + 0.5 * jerked / FINE**2
        turning += jerked / FINE
        late.append((alpha, turning, jerked))
        a, da, dda = late.pop(0)
        s += ds / FINE + 0.5 * dds / FINE**2
        before = dds
        dds = (GRAVITY * np.sin(a) + s * da**2 - LEVER * dda) / 1.4 - run.damping * ds
        ds += 0.5 * (before + dds) / FINE
        ds += sum(size / (PUSHED * FINE) for when, size in run.pushes.items() if when <= t < when + PUSHED)
        if abs(s) >= STOP:
            s, touched = float(np.clip(s, -STOP, STOP)), 1.0
            ds = -0.3 * ds if s * ds > 0.0 and abs(ds) > 0.02 else min(ds, 0.0) if s > 0.0 else max(ds, 0.0)
        if k % (FINE // RATE) == 0:
            if not run.commanded:
                reading = s + random.normal(0.0, run.noise)
            recorded = command if run.commanded else run.linkage * alpha
            rows.append((t + 1.0 / FINE, recorded, np.round(reading / 5e-4) * 5e-4, touched))
            touched = 0.0
    return Stopped(*np.array(rows).T)
