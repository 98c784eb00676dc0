"""Whether the recorded angle is a command that a controller computes from the reading of the same row.

Angle and position are each predicted from the rows before, of both. What the rows before do not tell of a position is
the noise of its reading, above all. A beam whose angle is measured cannot have answered it yet; a command that is
computed from the reading does: what the rows before do not tell of either is then proportional. On measured rigs this
correlation is 0.0 to 0.27 in size where the angle is measured, 0.8 where it is a command.

A beam that turns far within a row moves the ball at once by the lever of α̈, against the turn by some 0.04 m/rad. Where
it is sampled slowly, what the rows before do not tell of a measured angle and of the position is proportional, too. So
the position must answer by more: the commands of measured rigs have 0.3 and 0.6 m/rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from analytic.motion import FloatArray
from harness.recording.outliers import MAD_TO_SIGMA
from harness.recording.recording import Recording

_ROWS = 8  # before, from which a row is predicted
_FEWEST = 10 * _ROWS  # rows that are predicted
_CORRELATED, _SURE = 0.5, 8.0  # the second: times its standard error without a correlation
_CLIPPED = 3.0  # standard deviations, to which steps of a reference and spikes are cut
_SLOW = 0.04  # rows that are as far apart [s] leave a beam the time to turn far: at shorter ones no lever is felt
_BY_LEVER = 0.15  # [m/rad]: three times the lever of α̈, h + 7/5 r of a ball in a channel


def answers_readings(recordings: Iterable[Recording]) -> bool:
    """Whether the angle of recordings of one rig answers the position in the same row."""
    recordings = list(recordings)
    pairs = [_unpredicted(one.angle, np.where(one.usable, one.position, np.nan)) for one in recordings]
    both = np.concatenate([np.empty((2, 0)), *[pair for pair, _ in pairs]], axis=1)
    sizes = np.sqrt((both**2).sum(axis=1))
    if both.shape[1] < _FEWEST or not np.all(sizes > 0.0):
        return False
    slow = np.median(np.concatenate([np.diff(one.time) for one in recordings])) >= _SLOW
    if slow and np.median([slope for pair, slope in pairs if pair.size]) < _BY_LEVER:
        return False
    correlation = abs(float(both[0] @ both[1])) / float(sizes.prod())
    return correlation > _CORRELATED and correlation * math.sqrt(both.shape[1]) > _SURE


def _unpredicted(angle: FloatArray, position: FloatArray) -> tuple[FloatArray, float]:
    """What the rows before do not tell of angle and position.

    Returns:
        It in standard deviations, shape (2, rows); the standard deviation of the position over that of the angle
        [m/rad].
    """
    rows = np.column_stack((angle, position))
    if len(rows) <= _ROWS:
        return np.empty((2, 0)), math.nan
    each = sliding_window_view(rows, _ROWS + 1, axis=0).reshape(len(rows) - _ROWS, -1)  # angles, then positions
    each = each[np.isfinite(each).all(axis=1)]
    if len(each) < _FEWEST:
        return np.empty((2, 0)), math.nan
    before = np.column_stack((np.ones(len(each)), each[:, :_ROWS], each[:, _ROWS + 1 : -1]))
    before /= np.maximum(np.abs(before).max(axis=0), np.finfo(float).tiny)
    now = each[:, [_ROWS, -1]]
    left = (now - before @ np.linalg.lstsq(before, now, rcond=1e-10)[0]).T
    sigma = MAD_TO_SIGMA * np.median(np.abs(left), axis=1, keepdims=True)
    if not np.all(sigma > 0.0):
        return np.empty((2, 0)), math.nan
    return np.asarray(np.clip(left / sigma, -_CLIPPED, _CLIPPED)), float(sigma[1, 0] / sigma[0, 0])
