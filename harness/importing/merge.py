"""Angle and position of different groups, each with stamps of its own, on the rows of one recording."""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.recording.sampling import GAP, MAX_DROPOUT

FASTER = 1.5  # ratio of rates beyond which the faster signal's rows are all kept


def on_common_rows(
    angle_time: FloatArray, angle: FloatArray, position_time: FloatArray, position: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, str]:
    """One time axis for both, within the time in which the angle is known.

    Positions are never interpolated: they stand at their own stamps, and are blank elsewhere. The angle is interpolated
    linearly to the stamps of the positions, but not over gaps between its own, where it is NaN. Where the angle is
    recorded faster, its own rows are kept as well.

    Args:
        angle_time, position_time: rising stamps, shapes (n,) and (m,) [s].
        angle: α, shape (n,) [rad]; NaN where unknown.
        position: s, shape (m,) [m].

    Returns:
        Time, angle, position of shape (k,) each, and what was done in words, which is empty if they share their stamps.

    Raises:
        ValueError: fewer than two angles are known.
    """
    if np.array_equal(angle_time, position_time):
        return angle_time, angle, position, ""
    known = np.isfinite(angle)
    angle_time, angle = angle_time[known], angle[known]
    if len(angle) < 2:
        raise ValueError("fewer than two angles")
    inside = (position_time >= angle_time[0]) & (position_time <= angle_time[-1])
    position_time, position = position_time[inside], position[inside]
    at_positions = np.interp(position_time, angle_time, angle)
    after = np.clip(np.searchsorted(angle_time, position_time), 1, len(angle_time) - 1)
    gap = angle_time[after] - angle_time[after - 1]
    at_positions[gap > max(GAP * float(np.median(np.diff(angle_time))), MAX_DROPOUT)] = np.nan
    steps = [float(np.median(np.diff(one))) if len(one) > 1 else np.inf for one in (angle_time, position_time)]
    if steps[1] < FASTER * steps[0]:
        text = "rows at the stamps of the position; the angle was interpolated linearly between its own"
        return position_time, at_positions, position, text
    own = ~np.isin(angle_time, position_time)
    time = np.concatenate((position_time, angle_time[own]))
    both = np.concatenate((at_positions, angle[own]))
    blank = np.concatenate((position, np.full(int(own.sum()), np.nan)))
    order = np.argsort(time, kind="stable")
    text = "rows at the stamps of both; the angle at those of the position was interpolated linearly"
    return time[order], both[order], blank[order], text
