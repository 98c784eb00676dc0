"""Do innovations know the beam angle? A model that lacks nothing leaves none of its input in its residuals.

Residual analysis after Ljung, "System Identification", 2nd ed., 1999, section 16.6: the sums of innovations times past
inputs are jointly normal where there is nothing to find, and their squares, weighted by the inverse of their
covariance, are χ². Only past inputs count: in a closed loop, where the angle answers the ball, later ones may follow
from what the innovations were before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from analytic.motion import BeamMotion, FloatArray
from harness.identify.filter.ekf import SPIKE

LAGS = np.linspace(0.0, 1.0, 11)
"""By how much the beam is looked at before each innovation [s]: as finely as it turns, as long as a move takes."""
SIGNIFICANT = 0.01  # of p: one test in a hundred then calls innovations dependent that are not
_STANDS = 1e-12  # of its size, below which an input's changes are rounding
_RANK = 1e-8  # of the covariance's eigenvalues, below which lags say the same


@dataclass(frozen=True)
class Dependence:
    """How innovations go with one input at all lags together.

    Attributes:
        statistic: χ² [1].
        freedom: its degrees of freedom; 0 where there was nothing to test.
        correlation: the largest correlation by size, with its sign [1].
        lag: by which the input is ahead there [s].
    """

    statistic: float
    freedom: int
    correlation: float
    lag: float

    @property
    def p(self) -> float:
        """Chance of a statistic as large where innovations and input are independent; 1 where nothing was tested."""
        return float(chdtrc(self.freedom, self.statistic)) if self.freedom else 1.0


def beam_dependence(
    time: FloatArray, ratio: FloatArray, judged: NDArray[np.bool_], motion: BeamMotion
) -> dict[str, Dependence]:
    """Test the innovations of one recording against α, α̇ and α̈.

    Args:
        time: stamps, shape (n,) [s].
        ratio: innovations over their standard deviations, shape (n,).
        judged: which of them count, shape (n,).
        motion: of the beam, as measured.
    """
    use = judged & (time - time[0] >= LAGS[-1])
    then = time[use, None] - LAGS
    inputs = {
        "angle": motion.evaluate(then),
        "rate": motion.derivative(then),
        "acceleration": motion.derivative(then, 2),
    }
    return {name: dependence(ratio[use], signal) for name, signal in inputs.items()}


def dependence(ratio: FloatArray, inputs: FloatArray) -> Dependence:
    """Test innovations against inputs.

    The covariance is White's (Econometrica 48, 1980), which holds where innovations are not equally large everywhere.

    Args:
        ratio: innovations over their standard deviations, shape (n,); beyond four they count as four.
        inputs: at each of `LAGS` before, shape (n, lags).
    """
    if len(ratio) <= 2 * len(LAGS) or np.any(np.std(inputs, axis=0) <= _STANDS * np.max(np.abs(inputs), axis=0)):
        return Dependence(0.0, 0, 0.0, 0.0)
    z = np.clip(ratio, -SPIKE, SPIKE)
    z = z - z.mean()
    x = inputs - inputs.mean(axis=0)
    moments = x / x.std(axis=0) * z[:, None]
    values, vectors = np.linalg.eigh(moments.T @ moments)
    kept = values > _RANK * values[-1]
    total = moments.sum(axis=0)
    correlation = total / max(len(z) * float(z.std()), 1e-300)
    most = int(np.argmax(np.abs(correlation)))
    statistic = float(np.sum((vectors[:, kept].T @ total) ** 2 / values[kept]))
    return Dependence(statistic, int(kept.sum()), float(correlation[most]), float(LAGS[most]))


def joined(each: Iterable[Mapping[str, Dependence]]) -> dict[str, Dependence]:
    """Tests of several recordings as one: χ² of independent tests add up; the correlation is the largest of all."""
    each = list(each)
    return {name: _sum([one[name] for one in each]) for name in each[0]}


def _sum(each: list[Dependence]) -> Dependence:
    most = max(each, key=lambda one: abs(one.correlation))
    return Dependence(sum(d.statistic for d in each), sum(d.freedom for d in each), most.correlation, most.lag)
