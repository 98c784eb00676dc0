"""A beam that is turned by hand, of a plant that shares no code with the models, sampled as slowly as one likes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray

MASS, INERTIA, ROLLING, LEVER, GRAVITY = 0.071, 4.948e-6, 0.0118, 0.035, 9.81  # the ball and beam of the paper (SI)
STEP = 1e-3  # of the plant [s]
COUNT, NOISE, RESOLUTION = 1.57e-4, 3e-4, 1e-4  # of the angle [rad], of a position and of its last digit [m]
RIG = f"""[ball]
mass_kg = {MASS}
inertia_kg_m2 = {INERTIA}
radius_m = 0.0132
[beam]
rolling_radius_m = {ROLLING}
eccentricity_m = {LEVER}
[environment]
gravity_m_s2 = {GRAVITY}
[sensors]
angle_resolution_rad = {COUNT}
position_noise_m = {NOISE}
position_resolution_m = {RESOLUTION}
[recordings]
identify = ["rec_01.csv", "rec_02.csv", "rec_03.csv"]
"""


@dataclass(frozen=True, kw_only=True)
class Hand:
    """How a hand turns the beam: towards where the ball would come back, and at random.

    Attributes:
        corner: of the three lags behind each other between what it wants and what the beam does [Hz].
        size: standard deviation of the random turns that it wants, up to a factor [rad].
        rate: of the readings [Hz].
        delay: of the position [s].
        angle_noise: of the readings of the angle [rad].
        duration: of a recording [s].
    """

    corner: float
    size: float
    rate: float
    delay: float = 0.0
    angle_noise: float = 0.0
    duration: float = 20.0


def moved(hand: Hand, generator: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Angle [rad] and position [m] at each step, shape (n,): Newton and Euler for a ball in two-point contact."""
    n = round(hand.duration / STEP)
    angle, position = np.zeros((2, n))
    w = 2.0 * math.pi * hand.corner
    shaking = generator.standard_normal(n) * 0.4 * hand.size / math.sqrt(STEP * hand.corner)
    alpha, rate, second, s, v = 0.0, 0.0, 0.0, float(generator.uniform(-0.1, 0.1)), 0.0
    for i in range(n):
        angle[i], position[i] = alpha, s
        wanted = shaking[i] - 0.35 * s - 0.3 * v
        third = w**3 * (wanted - alpha) - 3.0 * w**2 * rate - 3.0 * w * second
        turning = (MASS * (LEVER + ROLLING) + INERTIA / ROLLING) * second
        v += STEP * (MASS * (s * rate**2 + GRAVITY * math.sin(alpha)) - turning) / (MASS + INERTIA / ROLLING**2)
        alpha, rate, second, s = alpha + STEP * rate, rate + STEP * second, second + STEP * third, s + STEP * v
    return angle, position


def write_hand_turned(folder: Path, hand: Hand, seed: int) -> Path:
    """A case of three recordings."""
    generator = np.random.default_rng(seed)
    folder.mkdir(parents=True)
    (folder / "rig.toml").write_text(RIG)
    for number in (1, 2, 3):
        angle, position = moved(hand, generator)
        steps = STEP * np.arange(len(angle))
        time = np.arange(0.0, hand.duration - STEP, 1.0 / hand.rate)
        alpha = np.interp(time, steps, angle) + hand.angle_noise * generator.standard_normal(len(time))
        s = np.interp(time - hand.delay, steps, position) + NOISE * generator.standard_normal(len(time))
        alpha, s = COUNT * np.round(alpha / COUNT), RESOLUTION * np.round(s / RESOLUTION)
        rows = [f"{t:.4f},{a:.6f},{x:.4f}" for t, a, x in zip(time, alpha, s, strict=True)]
        text = "\n".join(["time_s,beam_angle_rad,ball_position_m", *rows]) + "\n"
        (folder / f"rec_{number:02d}.csv").write_text(text)
    return folder
