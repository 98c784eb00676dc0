"""Beam angles known in closed form, the way a servo moves them, and what an encoder makes of them.

`python -m tests.signals.known_angles` measures the drive on 24 of them; the table is in docs/drive.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import BPoly

from analytic.motion import FloatArray
from harness.signals import smooth, smooth_rounded
from harness.signals.drive import make_drive

K_G = 9.81 * 0.666  # what a tilt accelerates the ball of the paper's rig by [m/s²]
SECONDS = 16.0


@dataclass(frozen=True)
class KnownAngle:
    """A piecewise quintic angle with continuous α̈; `path` is α [rad] over time [s]."""

    path: BPoly

    def states(self, time: FloatArray) -> FloatArray:
        """α, α̇, α̈ at `time`, shape (n, 3)."""
        return np.column_stack([self.path(time, order) for order in range(3)])


def servo_angle(seed: int, *, holds: bool = True) -> KnownAngle:
    """Quick moves of 0.15–0.6 s to levels within 3°, slow ramps, and between them holds of up to 1.5 s, or none."""
    generator = np.random.default_rng(seed)
    time, states = [0.0], [[0.0, 0.0, 0.0]]
    while time[-1] < SECONDS:
        if holds and generator.random() < 0.6:
            time.append(time[-1] + generator.uniform(0.2, 1.5))
            states.append(states[-1])
        kind, level = generator.random(), math.radians(generator.uniform(-3.0, 3.0))
        # A third are small or slow: the moves whose counts say least.
        duration = generator.uniform(1.0, 3.0) if kind < 0.2 else generator.uniform(0.15, 0.6)
        level = states[-1][0] + 0.1 * level if 0.2 < kind < 0.35 else level
        time.append(time[-1] + duration)
        states.append([level, 0.0 if holds else generator.normal(0.0, 0.05), 0.0])
    return KnownAngle(BPoly.from_derivatives(np.array(time), states))


def encoder(angle: FloatArray, counts: int, noise: float = 0.0, seed: int = 0) -> tuple[FloatArray, float]:
    """Readings [rad] and resolution [rad] of an encoder with `counts` a turn and noise in counts."""
    step = 2.0 * math.pi / counts
    shaken = angle + noise * step * np.random.default_rng(1000 + seed).standard_normal(len(angle))
    return np.rint(shaken / step) * step, step


def travel(time: FloatArray, angle: FloatArray) -> FloatArray:
    """What an angle moves the ball by: K g ∬ α dt² [m], shape like `angle`."""
    rate = cumulative_trapezoid(K_G * angle, time, initial=0.0)
    return np.asarray(cumulative_trapezoid(rate, time, initial=0.0))


def rms(value: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(value))))


def _measure(counts: int, noise: float) -> list[str]:
    """Rows of the table: errors by method, means over the known angles."""
    time = np.arange(0.0, SECONDS, 0.01)
    rows: dict[str, list[list[float]]] = {}
    for seed in range(24):
        truth = servo_angle(seed, holds=seed % 3 > 0).states(time)
        reading, step = encoder(truth[:, 0], counts, noise, seed)
        drive = make_drive(time, reading, resolution=step)
        white = math.hypot(step / math.sqrt(12.0), noise * step)
        rate = np.gradient(reading, time)
        states = {
            "differences of counts": np.column_stack((reading, rate, np.gradient(rate, time))),
            "white noise, one density": smooth(time, reading, white**2).mean,
            "white noise, local density": smooth_rounded(time, reading, 0.0, white)[0].mean,
            "drive": drive.states,
        }
        spread = [travel(time, path.states[:, 0] - drive.states[:, 0])[-1] for path in drive.draw(20, seed)]
        for name, found in states.items():
            error = found - truth
            scale = [step, rms(truth[:, 1]), rms(truth[:, 2])]
            row = [rms(error[:, i]) / scale[i] for i in range(3)]
            row.append(1e3 * float(travel(time, error[:, 0])[-1]))
            row += [rms(error[:, 0] / drive.std[:, 0]), 1e3 * rms(np.array(spread))] if name == "drive" else [0.0, 0.0]
            rows.setdefault(name, []).append(row)
    lines = []
    for name, table in rows.items():
        mean, square = np.mean(table, axis=0), np.sqrt(np.mean(np.square(table), axis=0))
        said = f"{square[4]:.2f} | {square[5]:.1f}" if name == "drive" else " | "
        shown = f"{mean[0]:.3f} | {100 * mean[1]:.1f} % | {100 * mean[2]:.0f} % | {square[3]:.1f}"
        lines.append(f"| {counts} | {noise} | {name} | {shown} | {said} |")
    return lines


def main() -> None:
    """Print the table of docs/drive.md."""
    print("| counts | noise | method | α (counts) | α̇ | α̈ | travel (mm) | z of α | travel predicted (mm) |")
    print("|---|---|---|---|---|---|---|---|---|")
    for counts, noise in ((4096, 0.0), (4096, 0.2), (12800, 0.0), (40000, 0.0), (40000, 1.0)):
        print("\n".join(_measure(counts, noise)), flush=True)


if __name__ == "__main__":
    main()
