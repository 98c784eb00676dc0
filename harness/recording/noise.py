"""Noise of a sensor's readings, estimated from them alone, and compared with what is declared.

Differences of fourth order leave of a ball's path ω² s̈ Δt⁴, and of white noise √70 σ. Taken over one reading they tell
σ where sampling is fast; over up to 0.1 s also that of coloured noise. Both are compared with the declared value.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.motion import FloatArray
from harness.recording.outliers import MAD_TO_SIGMA

LONGEST = 0.1  # over which differences are taken [s]
ORDER = 4
GAIN = math.sqrt(70.0)  # of white noise in differences of that order: √(1 + 16 + 36 + 16 + 1)
FEWEST = 100  # differences
CONTRADICTION = 4.0  # ratio of declared and estimated noise that is reported
MOTION = 2.0  # growth of the differences with their span, beyond which they are the ball's motion and no noise


def noise_of(values: FloatArray, stride: int = 1) -> float:
    """Robust standard deviation of white noise from differences of fourth order over `stride` readings.

    Args:
        values: readings of a moving quantity at even stamps, shape (n,) [unit].
        stride: readings between those of a difference.

    Returns:
        [unit]; 0 if there are too few readings. Repeated readings are left out.
    """
    of_fourth = np.concatenate([np.diff(values[first::stride], ORDER) for first in range(stride)])
    moving = of_fourth[of_fourth != 0.0]
    return MAD_TO_SIGMA * float(np.median(np.abs(moving))) / GAIN if len(moving) else 0.0


def contradicts(
    time: FloatArray, values: FloatArray, declared: float, resolution: float, *, moves: bool = False
) -> float:
    """Estimated over declared noise where they contradict each other, else 0.

    Args:
        time: stamps, shape (n,) [s].
        values: readings that are no spikes, shape (n,) [unit].
        declared: standard deviation [unit].
        resolution: of the readings [unit], 0 if unknown.
        moves: whether what is read may shake by itself, so that the estimate is only an upper bound.
    """
    if len(values) < FEWEST + ORDER:
        return 0.0
    steps = np.diff(time)
    step = float(np.median(steps))
    longest = max(1, min(round(LONGEST / step), len(values) // (4 * ORDER)))
    found = [noise_of(values, stride) for stride in sorted({1, min(2, longest), max(longest // 2, 1), longest})]
    rounding = resolution / math.sqrt(12.0)
    expected = math.hypot(declared, rounding)
    largest = math.hypot(max(found), rounding)
    if expected > CONTRADICTION * largest > 0.0:
        return largest / expected
    if moves or noise_of(values, 2) > MOTION * found[0]:
        return 0.0
    # Errors of the stamps, or uneven sampling, are noise to differences that take the stamps as even.
    uneven = float(np.std(steps[steps < 2.5 * step])) * float(np.quantile(np.abs(np.diff(values) / steps), 0.9))
    least = min(found)
    return least / expected if least > CONTRADICTION * math.hypot(expected, uneven) else 0.0
