"""A short recording, so that a command that is run for its options takes seconds."""

from __future__ import annotations

from pathlib import Path

from harness.simulator import Plant
from tests.comparison.made import COARSE, KNOWN, sensors, swing, write_case


def write_short_case(folder: Path, *, known: dict[str, float] | None = None, duration: float = 3.0) -> Path:
    """Two recordings of 3 s; the rig is the paper's unless `known` says less."""
    used = sensors(COARSE)
    recordings = [swing(seed, Plant(), used, duration) for seed in (21, 22)]
    return write_case(folder, recordings, used, known=KNOWN if known is None else known).folder
