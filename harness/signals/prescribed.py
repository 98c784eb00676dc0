"""Motion under an acceleration that is prescribed in time: two quadratures instead of a differential equation."""

from __future__ import annotations

import numpy as np

from analytic.kernel import Grid
from analytic.motion import FloatArray


def integrate_twice(grid: Grid, acceleration: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Position [m] and velocity [m/s] at the stamps, from rest at 0, shape (n,) each; Simpson's rule, order 4.

    Args:
        grid: n stamps, m steps.
        acceleration: at `grid.edges`, shape (2 m + 1,) [m/s²].
    """
    h, begin, middle, end = grid.steps, acceleration[:-1:2], acceleration[1::2], acceleration[2::2]
    v = np.concatenate(([0.0], np.cumsum(h * (begin + 4.0 * middle + end) / 6.0)))
    s = np.concatenate(([0.0], np.cumsum(h * v[:-1] + h**2 * (begin + 2.0 * middle) / 6.0)))
    return s[grid.marks], v[grid.marks]
