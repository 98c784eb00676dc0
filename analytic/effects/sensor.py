"""What the position sensor does to the position: delay, gain, lag."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.effects.effect import Effect, Parameter
from analytic.effects.force import Values
from analytic.motion import FloatArray


def _delayed(time: FloatArray, position: FloatArray, values: Values) -> FloatArray:
    known = np.isfinite(position)
    curve = CubicSpline(time[known], position[known])
    asked = np.clip(time - values["delay"], time[known][0], time[known][-1])
    return np.where(known, curve(asked), np.nan)


def _scaled(time: FloatArray, position: FloatArray, values: Values) -> FloatArray:
    return values["gain"] * position


def _lagged(time: FloatArray, position: FloatArray, values: Values) -> FloatArray:
    """T ẏ + y = s, exact for a position that is linear between stamps; it begins settled."""
    constant = values["time_constant"]
    out = np.array(position, float)
    for n in range(1, len(time)):
        if not np.isfinite(out[n - 1]):
            continue
        h, slope = time[n] - time[n - 1], (position[n] - position[n - 1]) / (time[n] - time[n - 1])
        follow = position[n - 1] - slope * constant
        out[n] = follow + slope * h + (out[n - 1] - follow) * np.exp(-h / max(constant, 1e-9))
    return out


SENSOR = (
    Effect(
        "channel_delay",
        "the position at t is recorded at t + delay (negative: the angle is late)",
        (Parameter("delay", "s", -1.0, 1.0, 0.02, starts=(0.0,)),),
        "transport delay",
        sense=_delayed,
    ),
    Effect(
        "position_gain",
        "recorded position = gain × position",
        (Parameter("gain", "1", 0.1, 10.0, 0.95),),
        "a scale error of the position sensor",
        sense=_scaled,
    ),
    Effect(
        "position_lag",
        "recorded position is a first-order lag of the position",
        (Parameter("time_constant", "s", 0.0, 2.0, 0.03),),
        "first-order low pass",
        sense=_lagged,
    ),
)
