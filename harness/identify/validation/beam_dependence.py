"""Independence of the innovations from the beam motion: for a complete model they are independent of past inputs.

Residual analysis after Ljung, "System Identification", 2nd ed., 1999, section 16.6: under independence the sums of
innovations times past inputs are jointly normal, and their squares, weighted by the inverse of their covariance, are
χ². Later inputs are left out, since in closed loop they depend on earlier innovations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from analytic.motion import BeamMotion, FloatArray
from harness.identify.filter.arguments import SPIKE

LAGS = np.linspace(0.0, 1.0, 11)
"""Lags of the inputs before each innovation [s]: as fine as the beam moves, as long as a motion takes."""
SIGNIFICANT = 0.01  # significance level of p
_CONSTANT = 1e-12  # standard deviation over size of an input below which it is constant up to rounding
_RANK = 1e-8  # relative size of the covariance's eigenvalues below which lags are linearly dependent


@dataclass(frozen=True)
class Dependence:
    """Test of innovations against one input at all lags jointly.

    Attributes:
        statistic: χ² [1].
        freedom: its degrees of freedom; 0 if there was nothing to test.
        correlation: the correlation of largest size, with its sign [1].
        lag: of the input at that correlation [s].
    """

    statistic: float
    freedom: int
    correlation: float
    lag: float

    @property
    def p(self) -> float:
        """p value of the statistic under independence; 1 if nothing was tested."""
        return float(chdtrc(self.freedom, self.statistic)) if self.freedom else 1.0


def beam_dependence(
    time: FloatArray, ratio: FloatArray, judged: NDArray[np.bool_], motion: BeamMotion
) -> dict[str, Dependence]:
    """Test the innovations of one recording against α, α̇ and α̈.

    Args:
        time: stamps, shape (n,) [s].
        ratio: normalised innovations, shape (n,).
        judged: mask of those to test, shape (n,).
        motion: the measured beam motion.
    """
    use = judged & (time - time[0] >= LAGS[-1])
    lagged = time[use, None] - LAGS
    inputs = {
        "angle": motion.evaluate(lagged),
        "rate": motion.derivative(lagged),
        "acceleration": motion.derivative(lagged, 2),
    }
    return {name: dependence(ratio[use], signal) for name, signal in inputs.items()}


def dependence(ratio: FloatArray, inputs: FloatArray) -> Dependence:
    """Test innovations against inputs.

    The covariance is White's (Econometrica 48, 1980), valid for innovations of varying variance.

    Args:
        ratio: normalised innovations, shape (n,), clipped at ± 4.
        inputs: the input at each of the `LAGS`, shape (n, lags).
    """
    if len(ratio) <= 2 * len(LAGS) or np.any(np.std(inputs, axis=0) <= _CONSTANT * np.max(np.abs(inputs), axis=0)):
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


def joined(recordings: Iterable[Mapping[str, Dependence]]) -> dict[str, Dependence]:
    """Tests of several recordings as one: χ² of independent tests add up; the correlation is the largest of all."""
    tests = list(recordings)
    return {name: _sum([test[name] for test in tests]) for name in tests[0]}


def _sum(tests: list[Dependence]) -> Dependence:
    most = max(tests, key=lambda test: abs(test.correlation))
    return Dependence(sum(d.statistic for d in tests), sum(d.freedom for d in tests), most.correlation, most.lag)
