"""The band of predictions: how large errors are beside what the filter and the parameters' covariance foresee.

Where a model lacks physics its errors over seconds are not those that the filter foresees. They may be larger
throughout, by a factor. They may also be there where the filter foresees none, as where dry friction stops its ball and
the true one rolls on: these are taken for a random walk, whose variance grows with the time since the last reading.
Both are fitted to the errors of held-out blocks.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, minimize

from analytic.motion import FloatArray
from harness.numerics import TWO_SIDED

_SHARE = 0.95  # of the readings that the band shall hold
_FREEDOM = 4.0  # degrees of freedom of Student's t: blocks are few, and in some the ball meets what others do not tell
# Starting points, and bounds, of the logarithms of the squared factor [1] and of the growth [m²/s].
_FACTORS, _GROWTHS = np.log([0.5, 1.0, 10.0, 100.0]), np.log([1e-8, 1e-6, 1e-4, 1e-2])
_BOUNDS = ((np.log(0.25), np.log(1e8)), (np.log(1e-12), np.log(1e4)))
_SCALES = np.log([0.5, 1e3])  # least and largest of what factor and root of growth are scaled by in the end
_CLOSE = 1e-3  # to which the logarithm of this is found


@dataclass(frozen=True)
class Foreseen:
    """Errors of predictions and what was foreseen of them.

    Attributes:
        error: prediction − reading, shape (readings,) [m].
        variance: that the filter and the parameters foresee, without that of a reading, shape (readings,) [m²].
        ahead: time since the last known reading, shape (readings,) [s].
    """

    error: FloatArray
    variance: FloatArray
    ahead: FloatArray


@dataclass(frozen=True)
class Band:
    """Variance of predictions by the variance that is foreseen: factor² × this + growth × time since the last reading.

    Attributes:
        factor: [1].
        growth: [m²/s].
    """

    factor: float = 1.0
    growth: float = 0.0

    def variance(self, foreseen: FloatArray, ahead: FloatArray) -> FloatArray:
        """Variance [m²] by the one foreseen [m²] and the time since the last reading [s], same shapes."""
        return self.factor**2 * foreseen + self.growth * ahead


AS_FORESEEN = Band()


def fitted_band(blocks: Sequence[Foreseen], reading_variance: float) -> Band:
    """The band that holds 95 % of the readings of a further block.

    Factor and growth are those of greatest likelihood, of Student's t and with the same weight for every block, whose
    readings have errors that are alike. Factor and root of the growth are then scaled alike, so that 95 % of the
    readings, which have noise beside, lie within. Where their noise alone leaves them within, they tell of no band that
    it would be too wide, and it is not narrower than what is foreseen.

    Args:
        blocks: of each held-out block, by a fit without it.
        reading_variance: of a reading's noise [m²].
    """

    def loss(logarithms: FloatArray) -> float:
        band, total = _band(logarithms), 0.0
        for block in blocks:
            variance = band.variance(block.variance, block.ahead) + reading_variance
            spread = (_FREEDOM + 1.0) * np.log1p(block.error**2 / (_FREEDOM * variance))
            total += float(np.mean(spread + np.log(variance)))
        return total

    begin = min((np.array(pair) for pair in itertools.product(_FACTORS, _GROWTHS)), key=loss)
    band = _band(minimize(loss, begin, method="L-BFGS-B", bounds=_BOUNDS).x)

    def scaled(logarithm: float) -> Band:
        scale = float(np.exp(logarithm))
        return Band(scale * band.factor, scale**2 * band.growth)

    def exceeds(logarithm: float) -> float:
        wide = scaled(logarithm)
        ratios = [
            np.abs(block.error) / np.sqrt(wide.variance(block.variance, block.ahead) + reading_variance)
            for block in blocks
        ]
        return float(np.log(widened(ratios) / TWO_SIDED))

    low, high = _SCALES
    if exceeds(low) <= 0.0:
        return replace(band, factor=max(band.factor, 1.0))
    return scaled(high if exceeds(high) > 0.0 else brentq(exceeds, low, high, xtol=_CLOSE))


def _band(logarithms: FloatArray) -> Band:
    """The band with these logarithms of the squared factor and of the growth, shape (2,)."""
    squared, growth = np.exp(logarithms)
    return Band(float(np.sqrt(squared)), float(growth))


def widened(ratios: Sequence[FloatArray]) -> float:
    """How many of its deviations a band must be wide to hold 95 % of the readings of a further block [1].

    The quantile of the blocks that there are holds less of a further one, as errors are alike within a block and the
    blocks are few. So each block in turn is held against the quantile of the others, and that of all is widened by the
    factor with which these hold 95 % on average.

    Args:
        ratios: size of the errors of each block over their deviations, shape (readings of the block,) each [1].
    """
    pooled = float(np.quantile(np.concatenate(ratios), _SHARE))
    if len(ratios) < 2:
        return pooled
    apart = [
        one / float(np.quantile(np.concatenate([*ratios[:number], *ratios[number + 1 :]]), _SHARE))
        for number, one in enumerate(ratios)
    ]
    weights = np.concatenate([np.full(len(one), 1.0 / len(one)) for one in apart])
    factor = float(np.quantile(np.concatenate(apart), _SHARE, weights=weights, method="inverted_cdf"))
    return max(factor, 1.0) * pooled
