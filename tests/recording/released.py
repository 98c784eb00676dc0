"""Recordings of a ball that is let go on a tilting beam and rolls to its other end, as a first experiment is done.

A plant of a page that shares no code with the models: that of `tests.recording.stopped`, on a beam that turns from one
tilt to another as a damped oscillator does.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from tests.recording.simulated import write
from tests.recording.stopped import GRAVITY, LEVER

FINE = 1000  # steps a second
COUNT = 2 * np.pi / 4096  # of the angle [rad]
RIG = """origin = "simulated by a plant of the tests"
[ball]
mass_kg = 0.1
inertia_kg_m2 = 1.6e-5
radius_m = 0.02
[beam]
rolling_radius_m = 0.02
eccentricity_m = 0.0
[environment]
gravity_m_s2 = 9.81
"""


@dataclass(frozen=True)
class Release:
    """One run; where it begins on the negative side, all of it mirrored (`side`).

    Attributes:
        begin: position of the ball before [m]; `stop` or beyond: it lies against the stop.
        stop: both stops' distance from the pivot [m].
        lean: tilt before, outwards where positive [rad].
        tilt: tilt after, inwards [rad].
        wait: before the beam turns [s].
        finger: whether something holds the ball until the beam turns.
        level: by which the beam is tilted beside its angle [rad].
        damping: d over the ball's mass [1/s].
        delay: of the position against the angle [s].
        duration: of the record; that of a run that ends at the other stop is shorter [s].
        bounces: whether the record goes on behind the other stop.
    """

    begin: float = 0.35
    stop: float = 0.4
    lean: float = 0.0
    tilt: float = 0.08
    wait: float = 0.3
    finger: bool = False
    level: float = 0.0
    damping: float = 0.0
    delay: float = 0.0
    duration: float = 4.0
    bounces: bool = False

    def record(self, side: float, *, rate: int, seed: int, noise: float = 1e-3) -> dict[str, FloatArray]:
        """Columns of a file, with rounding to counts and to 0.2 mm.

        Args:
            side: +1 or −1, at which the ball begins.
            rate: readings a second, a divisor of 1000.
            seed: of the noise.
            noise: of a position [m].
        """
        random = np.random.default_rng(seed)
        s, ds, alpha, turning = side * min(self.begin, self.stop), 0.0, side * self.lean, 0.0
        late = [s] * (1 + round(self.delay * FINE))
        rows = []
        for k in range(round(self.duration * FINE)):
            late = [*late[1:], s]
            if k % (FINE // rate) == 0:
                reading = np.round((late[0] + random.normal(0.0, noise)) / 2e-4) * 2e-4
                rows.append((k / FINE, np.round(alpha / COUNT) * COUNT, reading))
            turned = k > self.wait * FINE
            wanted = -side * self.tilt if turned else side * self.lean
            jerked = 144.0 * (wanted - alpha) - 20.0 * turning
            turning += jerked / FINE
            alpha += turning / FINE
            if self.finger and not turned:
                continue
            ds += ((GRAVITY * np.sin(alpha + self.level) + s * turning**2 - LEVER * jerked) / 1.4) / FINE
            ds -= self.damping * ds / FINE
            s += ds / FINE
            if abs(s) >= self.stop:
                if turned and not self.bounces and s * side < 0.0:
                    break
                s = float(np.clip(s, -self.stop, self.stop))
                ds = -0.4 * ds if s * ds > 0.02 * self.stop else 0.0 if s * ds > 0.0 else ds
        time, angle, position = np.array(rows).T
        return {"time_s": time, "beam_angle_rad": angle, "ball_position_m": position}


def released(folder: Path, runs: list[Release], *, rate: int = 50, seed: int = 0) -> Path:
    """A case of these runs, which begin at one side and the other in turn."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, run in enumerate(runs, start=1):
        side = 1.0 if number % 2 else -1.0
        write(folder / f"rec_{number:02d}.csv", run.record(side, rate=rate, seed=100 * seed + number))
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    return folder
