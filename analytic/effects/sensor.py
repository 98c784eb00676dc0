"""What the position sensor does to the position: delay, gain, curve, lag."""

from __future__ import annotations

import numpy as np

from analytic.effects.effect import Effect, EngineEntry, Relations
from analytic.effects.parameter import Bounds, Parameter
from analytic.effects.sensor_law import SensorLaw
from analytic.motion import FloatArray
from analytic.rig import Rig

_OF_READING = (("reading", False),)  # an error of the sensor

CHANNEL_DELAY = Effect(
    "channel_delay",
    "the position at t is recorded at t + delay (negative: the angle is late)",
    (
        # who sees the ball half a second late, or its beam, does not balance it
        Parameter("delay", "s", -1.0, 1.0, 0.02, starts=(0.0,), strength=True, shown=("ms", 1e3), usual=(-0.5, 0.5)),
    ),
    "transport delay",
    sensor=lambda values: SensorLaw(delay=values["delay"]),
    phrase="a delay of {delay} of the position against the angle",
    relations=Relations(late=True, common=True),
    engine=EngineEntry("sensor side: the stamps at which the ball is read"),
)
POSITION_GAIN = Effect(
    "position_gain",
    "recorded position = gain × position",
    # half or twice the position is another unit, not an error of scale
    (Parameter("gain", "1", 0.1, 10.0, 0.95, neutral=1.0, usual=(0.5, 2.0)),),
    "a scale error of the position sensor",
    sensor=lambda values: SensorLaw(gain=values["gain"]),
    phrase="a gain of {gain} between real and recorded position",
    relations=Relations(once=True, hidden_by=("ratio",), nested_in=_OF_READING),
)
POSITION_LAG = Effect(
    "position_lag",
    "recorded position is a first-order lag of the position",
    # behind a lag that is longer than a move along the beam takes, some 2 s, the sensor shows no ball
    (
        Parameter(
            "time_constant", "s", 0.0, 2.0, 0.03, starts=(0.01,), strength=True, shown=("ms", 1e3), usual=(0.0, 1.0)
        ),
    ),
    "first-order low pass",
    sensor=lambda values: SensorLaw(lag=values["time_constant"]),
    phrase="a lag of {time_constant} of the position sensor",
    relations=Relations(once=True, late=True),
)
_MOST = 0.4  # of the slope of a sensor's curve that each of its terms may take or add


def _bent(power: int) -> Bounds:
    """Bounds of the curve's term of this power: with both at their bounds it still rises everywhere along the track."""

    def bounds(visited: FloatArray, rig: Rig) -> tuple[float, float]:
        farthest = max(float(np.percentile(np.abs(visited), 99.5)), 1e-3)  # a ball may rest at the origin [m]
        most = _MOST / (power * farthest ** (power - 1))
        return -most, most

    return bounds


POSITION_NONLINEARITY = Effect(
    "position_nonlinearity",
    "recorded position = s + square s² + cube s³",
    (
        Parameter("square", "1/m", -10.0, 10.0, 0.1, starts=(0.0,), strength=True, fitted=_bent(2)),
        Parameter("cube", "1/m²", -10.0, 10.0, 0.1, starts=(0.0,), strength=True, fitted=_bent(3)),
    ),
    "a curve of the position sensor, to third order",
    sensor=lambda values: SensorLaw(square=values["square"], cube=values["cube"]),
    phrase="a curve of the position sensor of {square} s² and {cube} s³",
    relations=Relations(once=True, nested_in=_OF_READING),
)

SENSOR = (CHANNEL_DELAY, POSITION_GAIN, POSITION_NONLINEARITY, POSITION_LAG)
