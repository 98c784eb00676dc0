"""What of the scatter of the recorded angle acts as an error: told by the ball, above all where dry friction holds it.

The record of an angle alone tells how it scatters, not why. A sensor's noise moves no ball. A command that a controller
computes from noisy positions scatters as well, and the beam follows it: smoothed away as noise, it is missing in the
drive, whose error is then stated several times too large. And where it is noise indeed, the filter may do with less of
it: beside an angle of large error it takes a ball that dry friction holds for one that creeps. On both, friction came
out at 0.6 of its size, and a second law that no ball obeys lowered the deviance by 70 (docs/diagnosis_experiments.md).

Where no dry friction acts, a large error costs precision and nothing else, and the readings are left as they are.
"""

from __future__ import annotations

import math

from analytic.effects import ANGLE_SERVO, ROLLING_RESISTANCE, VISCOUS_DAMPING
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

_FIRST, _FURTHER = 0.5, (0.3, 0.1, 0.03)  # a scatter of less is none: the readings are then followed as they are
_READINGS = 2000  # that are asked, as they were taken: between coarse ones, α̈ is not what presses the ball
_SAME = 2.0  # differences of the deviance that tell nothing of a share
# Where the beam lags behind the angle, the ball tells the share by a model that lags, too, and by no other.
_DRY = (ROLLING_RESISTANCE.name, ANGLE_SERVO.name)
_FREE = (VISCOUS_DAMPING.name, ANGLE_SERVO.name)


def told_held(smoothed: Problem, held: Problem) -> bool:
    """Whether the ball's readings tell that the beam follows each command, in place of a smooth motion among them.

    Asked where the angle answers the readings (`harness.recording.commanded`): a command among whose scatter the beam
    moves smoothly, as one that comes over a slow link, is better smoothed. A beam that lags is compared, without and
    with dry friction. `held` has the same recordings; its deviance has to be lower as by an effect.
    """
    smoothed, held = (problem.beginning(_READINGS) for problem in (smoothed, held))
    price = smoothed.settings.keep + math.log(smoothed.readings)
    known = {term.effect.name for term in smoothed.declared}

    def lowest_deviance(problem: Problem) -> float:
        tried = ([name for name in names if name not in known] for names in (_DRY, (ANGLE_SERVO.name,)))
        return min(fit(problem, Hypothesis((*problem.unknown, *names))).deviance for names in tried)

    return lowest_deviance(held) < lowest_deviance(smoothed) - price


def told_noise_share(problem: Problem) -> float:
    """Share of the angle's scatter that is an error [1]; 1 unless the ball's readings tell that it is less.

    Both it and the dry friction have to lower the BIC as much as an effect has. Of shares that fit as well as each
    other it is the largest, with which the readings of the angle say the least.
    """
    known = {term.effect.name for term in problem.declared}
    if ROLLING_RESISTANCE.name in known or all(one.drive.sensor.rounded for one in problem.recordings):
        return 1.0
    part = problem.beginning(_READINGS)
    price = problem.settings.keep + math.log(part.readings)

    def lowest_deviance(share: float, names: tuple[str, ...]) -> float:
        tried = (*problem.unknown, *(name for name in names if name not in known))
        return fit(part.quieter(share), Hypothesis(tried)).deviance

    deviances = {share: lowest_deviance(share, _DRY) for share in (1.0, _FIRST)}
    if deviances[_FIRST] >= deviances[1.0]:
        return 1.0
    deviances |= {share: lowest_deviance(share, _DRY) for share in _FURTHER}
    lowest = min(deviances.values())
    share = max(share for share, one in deviances.items() if one < lowest + _SAME)
    told = deviances[share] < deviances[1.0] - price and deviances[share] < lowest_deviance(share, _FREE) - price
    return share if told else 1.0
