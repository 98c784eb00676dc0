"""A ball in water, of a plant that shares no code with the models: its velocity follows the beam's angle."""

from __future__ import annotations

from pathlib import Path

import numpy as np

GRAVITY, LEVER, STEP, RATE = 9.81, 0.02, 1e-3, 50  # m/s², m, of the plant [s], of the readings [Hz]
EARLIER = 1.0  # of the motion before the first reading, which a late position shows [s]


def water(folder: Path, *, ratio: float, damping: float, delay: float, sign: int = 1) -> Path:
    """A case of one recording of 30 s, of which nothing is known but gravity.

    Args:
        ratio: K [1].
        damping: rate at which a velocity dies away [1/s].
        delay: of the position [s].
        sign: of the recorded angle.
    """
    time = np.arange(-EARLIER, 30.0, STEP)
    angle = 0.1 * np.sin(0.9 * time) + 0.05 * np.sin(2.7 * time + 1.0)
    rate = np.gradient(angle, STEP)
    turning = np.gradient(rate, STEP)
    position, s, v = np.empty(len(time)), 0.0, 0.0
    for k, (a, w, w_dot) in enumerate(zip(angle, rate, turning, strict=True)):
        v += STEP * (ratio * (GRAVITY * np.sin(a) + s * w**2 - LEVER * w_dot) - damping * v)
        s += STEP * v
        position[k] = s
    at = np.arange(round(EARLIER / STEP), len(time), round(1.0 / RATE / STEP))
    noise = 3e-4 * np.random.default_rng(1).standard_normal(len(at))
    read = position[at - round(delay / STEP)] + noise
    folder.mkdir()
    rows = [f"{t:.2f},{sign * a:.4f},{s:.6f}" for t, a, s in zip(time[at], angle[at], read, strict=True)]
    (folder / "rec_01.csv").write_text("\n".join(["time_s,beam_angle_rad,ball_position_m", *rows, ""]))
    (folder / "rig.toml").write_text(
        f'origin = "simulated: a ball in water"\n[environment]\ngravity_m_s2 = {GRAVITY}\n'
        '[recordings]\nidentify = ["rec_01.csv"]\n'
    )
    return folder
