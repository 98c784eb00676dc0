"""Detection of spikes in a position signal: samples or short bursts that a rolling ball cannot produce."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray

WINDOW = 11  # samples per line fit, of which up to four may be spikes
HALF_SPAN = 0.03  # target half duration of a window, short enough for the path to be straight [s]
THRESHOLD = 6.0  # in robust standard deviations: one false alarm in 5e8 normal samples
SCALE_WINDOW = 101  # samples over which the noise is assumed constant (a laser's grows with distance)
MAD_TO_SIGMA = 1.4826
CHUNK = 50_000


def spikes(time: FloatArray, position: FloatArray, *, resolution: float, acceleration: float) -> NDArray[np.bool_]:
    """Marks positions far from robust lines fitted to the samples before, around and after them.

    A spike has to be far from all three lines: a kink (the ball at an end stop) and a lasting step lie on one of them.
    This is a Hampel identifier with Theil-Sen lines instead of medians, which also works for a moving ball and at the
    ends of the recording.

    Args:
        time: strictly increasing, shape (n,) [s].
        position: shape (n,) [m]; NaN if unknown.
        resolution: of the sensor [m], 0 if unknown.
        acceleration: largest possible acceleration of the ball [m/s²].

    Returns:
        Mask of shape (n,), false where the position is unknown.
    """
    mask = np.zeros(len(time), dtype=np.bool_)
    known = np.flatnonzero(np.isfinite(position))
    if len(known) < WINDOW:
        return mask
    step = float(np.median(np.diff(time)))
    breaks = np.flatnonzero(np.diff(time[known]) > 5 * step) + 1
    for start, stop in pairwise((0, *breaks.tolist(), len(known))):
        part = known[start:stop]
        if len(part) >= WINDOW:
            mask[part] = _spikes_of_part(time[part], position[part], step, resolution, acceleration)
    return mask


def _spikes_of_part(
    time: FloatArray, position: FloatArray, step: float, resolution: float, acceleration: float
) -> NDArray[np.bool_]:
    stride = max(1, min(round(2 * HALF_SPAN / step / (WINDOW - 1)), len(time) // WINDOW))
    half = WINDOW // 2
    around = np.abs(_residual(time, position, -half, stride))
    before = np.abs(_residual(time, position, 1 - WINDOW, stride))
    after = np.abs(_residual(time, position, 0, stride))
    local = _running_median(around, min(SCALE_WINDOW, len(around)))
    scale = MAD_TO_SIGMA * np.maximum(local, np.median(around))
    # The path deviates from a line by at most a T²/2 within half a window.
    bend = 0.5 * acceleration * (half * stride * step) ** 2
    threshold = THRESHOLD * scale + 2 * resolution + bend
    # The lines before and after only exclude kinks and steps, for which half the threshold (three sigma) is enough.
    spike: NDArray[np.bool_] = (around > threshold) & (np.minimum(before, after) > 0.5 * threshold)
    return spike


def _running_median(values: FloatArray, size: int) -> FloatArray:
    """The median of `size` samples around each, mirrored at the ends (as scipy.ndimage, slow to import, has it)."""
    middle = size // 2
    padded = np.pad(values, (middle, size - 1 - middle), mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, size)
    parts = [windows[begin : begin + CHUNK] for begin in range(0, len(values), CHUNK)]
    return np.concatenate([np.partition(part, middle, axis=1)[:, middle] for part in parts])


def _residual(time: FloatArray, position: FloatArray, first: int, stride: int) -> FloatArray:
    """Distance of each sample from the line through `WINDOW` samples starting `first * stride` samples from it."""
    count = len(time)
    residual = np.empty(count)
    left, right = np.triu_indices(WINDOW, 1)
    for begin in range(0, count, CHUNK):
        index = np.arange(begin, min(begin + CHUNK, count))
        start = np.clip(index + first * stride, 0, count - 1 - (WINDOW - 1) * stride)
        window = start[:, None] + stride * np.arange(WINDOW)
        t, s = time[window] - time[index, None], position[window]
        slope = np.median((s[:, right] - s[:, left]) / (t[:, right] - t[:, left]), axis=1)
        residual[index] = position[index] - np.median(s - slope[:, None] * t, axis=1)
    return residual
