"""Whether a ball that rests at first may be held there, as by a finger, where a friction was found that does so.

A hand, a pin or a stop that holds the ball until the beam turns leaves it at rest on a beam that is not level. No model
has that force. What explains it is a friction that holds a ball at rest and is nothing at any speed, beside a level
error: static friction without rolling resistance, which no steel ball on a track has.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from analytic.effects import STRIBECK_FRICTION
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.verdict import Estimate

RESTS, FEWEST = 0.15, 5  # at first: time [s] and readings
SPREAD = 6.0  # of the readings of a resting ball, over their standard deviation: of ten, in one of 5000
SHARE = 0.5  # of the recordings


def may_be_held(problem: Problem, name: str, parameters: Mapping[str, Estimate]) -> bool:
    """Whether an effect is a friction at rest alone, in recordings of which half begin with the ball at rest.

    Args:
        name: of the effect.
        parameters: of the effect by name, with their intervals, in the units of the catalogue: coefficients [1].
    """
    if name != STRIBECK_FRICTION.name or parameters["kinetic_coefficient"].low > 0.0:
        return False
    noise = float(np.sqrt(problem.reading_variance))
    resting = [_rests_at_first(one, SPREAD * noise) for one in problem.recordings]
    return sum(resting) >= SHARE * len(resting)


def _rests_at_first(recording: PreparedRecording, spread: float) -> bool:
    """Whether the first readings differ by no more than `spread` [m]."""
    known = np.isfinite(recording.reading)
    time, reading = recording.time[known], recording.reading[known]
    count = max(FEWEST, int(np.searchsorted(time, time[0] + RESTS)))
    return bool(np.ptp(reading[:count]) <= spread)
