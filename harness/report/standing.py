"""Which source is closest, and which others this recording cannot tell from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.comparison.study import Study

COVERAGE = 2.0  # standard deviations, as in ASME V&V 20: 95 % of a normal distribution
SAME = 0.05  # of u_val: two runs closer than this give the same motion for any purpose


@dataclass(frozen=True)
class Standing:
    """One source beside the best one, on one horizon.

    Attributes:
        source: its name.
        rms: of its error [m]; infinite where it ran away or failed.
        std: standard error of that; NaN for a single run [m].
        separated: whether it is worse than the best by more than the recording leaves open.
        same: whether its motion is that of the best.
    """

    source: str
    rms: float
    std: float
    separated: bool
    same: bool


def standings(study: Study, horizon: Horizon) -> list[Standing]:
    """All sources on `horizon`, the closest first; one of equal motion ranks by order of the study."""
    slices, use = horizon.slices(), study.setting.ball.trusted
    measured, u_val = study.setting.recording.position, study.u_val_of(horizon)
    errors = {
        source: [(study.run_of(source, horizon).position[i, w] - measured[w])[use[w]] for i, w in enumerate(slices)]
        for source in study.sources
    }
    u = [u_val[i, w][use[w]] for i, w in enumerate(slices)]
    floor = _rms(u)
    rms = {source: _rms(error) for source, error in errors.items()}
    # Sources of equal motion rank together, in the order of the study: analytic models before the engines.
    alike = {s: [o for o in study.sources if o == s or _same(errors[s], errors[o], floor)] for s in study.sources}
    ordered = sorted(study.sources, key=lambda source: min(rms[one] for one in alike[source]))
    first = ordered[0]
    return [
        Standing(
            source=source,
            rms=rms[source],
            std=1e-3 * study.score_of(source, horizon).rms_error_standard_error_mm,
            separated=separated(errors[first], errors[source], u),
            same=source in alike[first],
        )
        for source in ordered
    ]


def separated(best: Sequence[FloatArray], other: Sequence[FloatArray], u_val: Sequence[FloatArray]) -> bool:
    """Whether `other` errs more than `best` by more than chance and inputs explain.

    Measurement, start and angle are common to both: an error δ of theirs changes the difference of the mean squares by
    2 δ (e_other − e_best). Within a run δ is taken for wholly correlated and of the worst sign, from run to run for
    independent; to this comes the scatter of the difference over the runs, where there are several.

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
    return _rms([a - b for a, b in zip(one, other, strict=True)]) < SAME * floor


def _rms(pieces: Sequence[FloatArray]) -> float:
    values = np.concatenate(pieces)
    with np.errstate(over="ignore", invalid="ignore"):
        square = float(np.mean(np.square(values)))
    return float(np.sqrt(square)) if np.isfinite(square) else np.inf
