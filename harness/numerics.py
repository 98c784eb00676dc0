"""Small numerical helpers that several packages share."""

from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray


@overload
def rms(values: ArrayLike) -> float: ...
@overload
def rms(values: ArrayLike, axis: int) -> FloatArray: ...
def rms(values: ArrayLike, axis: int | None = None) -> float | FloatArray:
    """Root mean square √(mean x²) over `axis`, or over all values; in the unit of `values`, NaN if one of them is."""
    root: FloatArray = np.sqrt(np.mean(np.square(values), axis=axis))
    return float(root) if axis is None else root
