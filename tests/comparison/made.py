"""Recordings made to order on the virtual rig, with the truth beside them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray, State
from analytic.rig import Rig
from harness.comparison import Choices, Setting, prepare
from harness.recording import load_case
from harness.simulator import (
    Controller,
    Encoder,
    Laser,
    Plant,
    Protocol,
    Record,
    Run,
    Sensors,
    Servo,
    perform,
    record,
    recording_text,
    simulate,
)
from tests.motions import Sines

FINE, COARSE = 40_000, 4_096  # counts a turn
NOISE, RESOLUTION = 0.3e-3, 0.1e-3  # of the laser [m]
RIG = Rig()


@dataclass(frozen=True)
class Made:
    """A case folder with the true trajectory of each recording."""

    folder: Path
    truth: tuple[Run, ...]

    def prepare(self, **choices: object) -> Setting:
        """The comparison's setting, first recording."""
        return prepare(load_case(self.folder), Choices(**choices))  # type: ignore[arg-type]

    def ball(self, time: FloatArray, number: int = 0) -> FloatArray:
        """True s [m] and ṡ [m/s] at stamps, shape (n, 2)."""
        run = self.truth[number]
        return np.column_stack([np.interp(time, run.time, x) for x in (run.position, run.velocity)])


def sensors(counts: int, noise: float = NOISE, angle_noise: float = 0.0) -> Sensors:
    """An encoder of `counts` a turn, and a laser of equal noise everywhere that never loses the ball."""
    laser = Laser(near=-50.0, far=50.0, noise_near=noise, noise_far=noise, resolution=RESOLUTION)
    return Sensors(encoder=Encoder(counts=counts, noise=angle_noise), laser=laser)


def swing(seed: int, plant: Plant, used: Sensors, duration: float = 12.0) -> tuple[Run, Record]:
    """A beam that swings by about 4° in three sines, and a ball that starts so that it swings about 0.36 m."""
    draw = np.random.default_rng(seed)
    omega = np.array([1.3, 2.6, 4.4]) * draw.uniform(0.85, 1.15, 3)
    size = np.array([0.03, 0.03, 0.02]) * draw.uniform(0.7, 1.1, 3)
    phase = draw.uniform(-math.pi, math.pi, 3)
    pull = plant.rig.rolling_ratio * plant.rig.gravity
    start = State(
        0.36 - pull * float(np.sum(size / omega**2 * np.sin(phase))),
        -pull * float(np.sum(size / omega * np.cos(phase))),
    )
    run = simulate(plant, Sines(tuple(zip(size, omega, phase, strict=True))), start, duration)
    return run, record(run, used, seed)


def steps(seed: int, plant: Plant, used: Sensors, duration: float = 14.0) -> tuple[Run, Record]:
    """The paper's protocol: a controller that sends a resting ball to and fro, here between random places."""
    draw = np.random.default_rng(seed)
    targets, time, far = [], draw.uniform(0.3, 1.0), bool(draw.integers(2))
    while time < duration - 2.0:
        targets.append((time, draw.uniform(0.44, 0.53) if far else draw.uniform(0.26, 0.34)))
        time, far = time + draw.uniform(1.5, 3.2), not far
    protocol = Protocol(0.36 + 0.02 * draw.standard_normal(), tuple(targets), duration)
    return perform(protocol, plant, Servo(), Controller(), used, seed)


def write_case(
    folder: Path, made: list[tuple[Run, Record]], used: Sensors, *, known: dict[str, float] | None = None
) -> Made:
    """A case folder; `known` are the rig's quantities by their names in rig.toml, by default all but α₀."""
    known = known if known is not None else KNOWN
    tables = {"ball": ("mass_kg", "inertia_kg_m2", "radius_m"), "environment": ("gravity_m_s2",)}
    tables["beam"] = ("rolling_radius_m", "eccentricity_m", "level_angle_rad")
    lines = []
    for table, keys in tables.items():
        lines += [f"[{table}]", *(f"{key} = {known[key]!r}" for key in keys if key in known)]
    lines += ["[sensors]", f"angle_resolution_rad = {used.encoder.resolution!r}"]
    lines += [f"position_noise_m = {used.laser.noise_near!r}", f"position_resolution_m = {used.laser.resolution!r}"]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "rig.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for number, (_, recorded) in enumerate(made, start=1):
        (folder / f"rec_{number:02d}.csv").write_text(recording_text(recorded), encoding="utf-8", newline="\n")
    return Made(folder, tuple(run for run, _ in made))


KNOWN = {
    "mass_kg": RIG.mass,
    "inertia_kg_m2": RIG.inertia,
    "radius_m": RIG.radius,
    "rolling_radius_m": RIG.rolling_radius,
    "eccentricity_m": RIG.eccentricity,
    "gravity_m_s2": RIG.gravity,
}
HIDDEN = {"gravity_m_s2": RIG.gravity}
