"""What of the scatter of the recorded angle acts as an error: told by the ball.

The record of an angle alone tells how it scatters, not why. A sensor's noise moves no ball. A command that a controller
computes from noisy positions scatters as well, and the beam follows it: smoothed away as noise, it is missing in the
drive, whose error is then stated several times too large. And where it is noise indeed, the filter may do with less of
it: beside an angle of large error it takes a ball that dry friction holds for one that creeps. On both, friction came
out at 0.6 of its size, and a second law that no ball obeys lowered the deviance by 70 (docs/diagnosis_experiments.md).

Where the beam lags behind the angle, the ball tells it by a model that lags, too, and by no other: hence the few
hypotheses below, which stand for what acts on many rigs.
"""

from __future__ import annotations

import math

from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

_FIRST, _FURTHER = 0.5, (0.3, 0.1, 0.03)  # a scatter of less is none: the readings are then followed as they are
_BESIDE = (("channel_delay",), ("viscous_damping", "angle_servo"), ("rolling_resistance", "angle_servo"))
_SAME = 2.0  # differences of the deviance that tell nothing of a share


def told_noise_share(problem: Problem) -> float:
    """Share of the angle's scatter that is an error [1]; 1 unless the ball's readings tell that it is less.

    It has to lower the BIC as much as an effect has. Of shares that fit as well as each other it is the largest, with
    which the readings of the angle say the least.
    """
    if not any(one.drive.sensor.scatters for one in problem.recordings):
        return 1.0
    coarse = problem.coarse
    deviances = {share: _lowest_deviance(coarse.quieter(share)) for share in (1.0, _FIRST)}
    if deviances[_FIRST] >= deviances[1.0]:
        return 1.0
    deviances |= {share: _lowest_deviance(coarse.quieter(share)) for share in _FURTHER}
    lowest = min(deviances.values())
    price = problem.settings.keep + math.log(coarse.readings)
    if lowest >= deviances[1.0] - price:
        return 1.0
    return max(share for share, one in deviances.items() if one < lowest + _SAME)


def _lowest_deviance(problem: Problem) -> float:
    known = {term.effect.name for term in problem.declared}
    tried = [Hypothesis((*problem.unknown, *(name for name in names if name not in known))) for names in _BESIDE]
    return min(fit(problem, one).deviance for one in tried)
