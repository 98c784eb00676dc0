"""What of the scatter of the recorded angle acts as an error: told by the ball, above all where dry friction holds it.

The record of an angle alone tells how it scatters, not why. A sensor's noise moves no ball. A command that a controller
computes from noisy positions scatters as well, and the beam follows it: smoothed away as noise, it is missing in the
drive, whose error is then stated several times too large. And where it is noise indeed, the filter may do with less of
it: beside an angle of large error it takes a ball that dry friction holds for one that creeps. On both, friction came
out at 0.6 of its size, and a second law that no ball obeys lowered the deviance by 70 (docs/diagnosis_experiments.md).

Where no dry friction acts, a large error costs precision and nothing else, and the readings are left as they are here;
of a beam that turns far between its readings `fast_beam` asks the ball.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from analytic.effects import ANGLE_SERVO, LEVEL_ERROR, ROLLING_RESISTANCE, TRACK_CURVATURE, VISCOUS_DAMPING
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.threads import in_threads

_FIRST, _FURTHER = 0.5, (0.3, 0.1, 0.03)  # a scatter of less is none: the readings are then followed as they are
ASKED = 2000
"""Readings that are asked, as they were taken: between coarse ones, α̈ is not what presses the ball."""
SAME = 2.0
"""Differences of the deviance that tell nothing of a share."""
# Where the beam lags behind the angle, the ball tells the share by a model that lags, too, and by no other.
_DRY = (ROLLING_RESISTANCE.name, ANGLE_SERVO.name)
_FREE = (VISCOUS_DAMPING.name, ANGLE_SERVO.name)
# What is asked for beside a command and the servo that it drives: what most rigs have, from what is there most often.
_BESIDE_SERVO = (
    (LEVEL_ERROR.name,),
    (LEVEL_ERROR.name, ROLLING_RESISTANCE.name),
    (LEVEL_ERROR.name, VISCOUS_DAMPING.name),
    (TRACK_CURVATURE.name,),
)


def prefers_held_command(smoothed: Problem, held: Problem) -> bool:
    """Whether the ball's readings are more likely with a beam that follows each command than with a smoothed angle.

    Both have the same recordings, a servo, and one after the other of what most rigs have beside it, until the lowest
    deviance of the one is below that of the other by as much as an effect has to lower it. Where something is missing
    in both, process noise covers what either explains.
    """
    smoothed, held = (problem.beginning(ASKED) for problem in (smoothed, held))
    price = smoothed.least_gain
    lowest, of_held = math.inf, math.inf
    for names in _BESIDE_SERVO:
        both = in_threads(partial(lowest_deviance, names=(*names, ANGLE_SERVO.name)), (smoothed, held))
        lowest, of_held = min(lowest, both[0]), min(of_held, both[1])
        if of_held < lowest - price:
            return True
    return False


def told_noise_share(problem: Problem) -> float:
    """Share of the angle's scatter that is an error [1]; 1 unless the ball's readings tell that it is less.

    Both it and the dry friction have to lower the BIC as much as an effect has. Of shares that fit as well as each
    other it is the largest, with which the readings of the angle say the least.
    """
    dry = any(term.effect is ROLLING_RESISTANCE for term in problem.declared)
    if dry or all(one.drive.sensor.rounded for one in problem.recordings):
        return 1.0
    part = problem.beginning(ASKED)
    price = part.least_gain

    def by_share(shares: Sequence[float]) -> dict[float, float]:
        each = in_threads(lambda share: lowest_deviance(part.quieter(share), _DRY), shares)
        return dict(zip(shares, each, strict=True))

    deviances = by_share((1.0, _FIRST))
    if deviances[_FIRST] >= deviances[1.0]:
        return 1.0
    deviances |= by_share(_FURTHER)
    lowest = min(deviances.values())
    share = max(share for share, one in deviances.items() if one < lowest + SAME)
    limit = min(deviances[1.0], lowest_deviance(part.quieter(share), _FREE)) - price
    return share if deviances[share] < limit else 1.0


def lowest_deviance(problem: Problem, names: tuple[str, ...]) -> float:
    """Lowest deviance of a problem with these effects beside those that are known or stood for."""
    known = {*problem.unknown, *(term.effect.name for term in problem.declared)}
    return fit(problem, Hypothesis((*problem.unknown, *(name for name in names if name not in known)))).deviance
