"""Recordings of a ball that obeys eq. 14, as a sound rig would give them, and the files they are written to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from analytic.models import CAM
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from tests.reference import reference

ANGLE_STEP = 2 * np.pi / 40_000  # counts of a fine encoder [rad]
POSITION_STEP = 1e-4  # digits of the position [m]
NOISE = 3e-4  # the paper's laser at short range [m]


@dataclass(frozen=True)
class Cosines:
    """α = Σ aᵢ cos ωᵢ t; the ball released at rest then swings about one place."""

    amplitudes: tuple[float, ...] = (0.03, 0.02)
    frequencies: tuple[float, ...] = (1.3, 2.9)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        terms = zip(self.amplitudes, self.frequencies, strict=True)
        return np.sum([a * w**order * np.cos(w * time + order * np.pi / 2) for a, w in terms], axis=0)

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return self.derivative(time, 0)


SWINGS = Cosines()
PAPER = Rig()


@lru_cache
def simulated(
    motion: Cosines = SWINGS,
    rig: Rig = PAPER,
    *,
    start: float = 0.3,
    duration: float = 12.0,
    step: float = 0.01,
    noise: float = NOISE,
    seed: int = 1,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time [s], quantised angle [rad], noisy and quantised position [m]; shape (n,) each."""
    time = np.round(np.arange(0.0, duration + 0.5 * step, step), 9)
    path = reference(CAM, rig, motion, State(start, 0.0), time, rtol=1e-9).position
    noisy = path + np.random.default_rng(seed).normal(0.0, noise, len(time))
    return (
        time,
        np.round(motion.evaluate(time) / ANGLE_STEP) * ANGLE_STEP,
        np.round(noisy / POSITION_STEP) * POSITION_STEP,
    )


def csv_text(columns: dict[str, FloatArray], *, separator: str = ",", decimal: str = ".", blank: str = "") -> str:
    """Columns as CSV text, numbers in full; NaN becomes `blank`."""
    lines = [separator.join(columns)]
    for row in zip(*columns.values(), strict=True):
        cells = (blank if np.isnan(value) else repr(float(value)).replace(".", decimal) for value in row)
        lines.append(separator.join(cells))
    return "\n".join(lines) + "\n"


def contract_columns() -> dict[str, FloatArray]:
    """The default recording under the names of the contract."""
    time, angle, position = simulated()
    return {"time_s": time, "beam_angle_rad": angle, "ball_position_m": position}


def write(path: Path, columns: dict[str, FloatArray] | None = None) -> Path:
    """Writes a recording; the default one if no columns are given."""
    path.write_text(csv_text(columns or contract_columns()), encoding="utf-8")
    return path
