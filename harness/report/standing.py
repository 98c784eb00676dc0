"""Ranks sources by RMS error and tests whether each is significantly worse than the best."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.comparison.study import Study
from harness.numerics import rms

COVERAGE = 2.0  # standard deviations, as in ASME V&V 20: 95 % of a normal distribution
SAME_MOTION = 0.05  # of u_val: RMS difference below which two runs count as equal


@dataclass(frozen=True)
class Standing:
    """One source compared with the best one, on one horizon.

    Attributes:
        source: its name.
        rms: RMS error [m]; infinite if it diverged or failed.
        std: standard error of `rms`; NaN for a single run [m].
        separated: whether it is significantly worse than the best.
        same: whether its motion equals that of the best.
    """

    source: str
    rms: float
    std: float
    separated: bool
    same: bool


def standings(study: Study, horizon: Horizon) -> list[Standing]:
    """All sources on `horizon` by RMS error; sources of equal motion in the order of the study."""
    use = study.setting.ball.trusted[horizon.stamps]
    measured = study.setting.recording.position[horizon.stamps]

    def used(values: FloatArray) -> list[FloatArray]:
        return [piece[judged] for piece, judged in zip(horizon.pieces(values), horizon.pieces(use), strict=True)]

    errors = {source: used(study.run_of(source, horizon).position - measured) for source in study.sources}
    u = used(study.u_val_of(horizon))
    floor = _rms(u)
    sizes = {source: _rms(error) for source, error in errors.items()}
    # Sources of equal motion rank together, in the order of the study: analytic models before the engines.
    alike = {s: [o for o in study.sources if o == s or _same(errors[s], errors[o], floor)] for s in study.sources}
    ordered = sorted(study.sources, key=lambda source: min(sizes[one] for one in alike[source]))
    first = ordered[0]
    return [
        Standing(
            source=source,
            rms=sizes[source],
            std=1e-3 * study.score_of(source, horizon).rms_error_standard_error_mm,
            separated=separated(errors[first], errors[source], u),
            same=source in alike[first],
        )
        for source in ordered
    ]


def separated(best: Sequence[FloatArray], other: Sequence[FloatArray], u_val: Sequence[FloatArray]) -> bool:
    """Whether the mean square error of `other` is significantly larger than that of `best`.

    Measurement, start and angle are common to both: an error δ of theirs changes the difference of the mean squares by
    2 δ (e_other − e_best). δ is assumed fully correlated and of the worst sign within a run, and independent between
    runs; for several runs the variance of the difference between runs is added.

    Args:
        best, other: e_s of each run, model − measured, shape (n,) each [m].
        u_val: of each run, shape (n,) each [m].
    """
    if not all(np.isfinite(error).all() for error in other):
        return True
    counts = np.array([error.size for error in best], dtype=np.float64)
    gains = np.array([np.sum(o**2 - b**2) for b, o in zip(best, other, strict=True)])
    shifts = np.array([np.sum(2.0 * np.abs(o - b) * u) for b, o, u in zip(best, other, u_val, strict=True)])
    gain, total = float(gains.sum() / counts.sum()), float(counts.sum())
    variance = float(np.sum(shifts**2)) / total**2
    runs = len(counts)
    if runs > 1:
        variance += runs / (runs - 1) * float(np.sum((gains - counts * gain) ** 2)) / total**2
    return gain > COVERAGE * np.sqrt(variance)


def _same(one: Sequence[FloatArray], other: Sequence[FloatArray], floor: float) -> bool:
    return _rms([a - b for a, b in zip(one, other, strict=True)]) < SAME_MOTION * floor


def _rms(pieces: Sequence[FloatArray]) -> float:
    """RMS over all runs; infinite if a source diverged."""
    with np.errstate(over="ignore", invalid="ignore"):
        value = rms(np.concatenate(pieces))
    return value if np.isfinite(value) else np.inf
