"""What of the scatter of the recorded angle is an error: told by the ball, where rig.toml does not declare the noise.

The record of an angle alone tells how it scatters, not why. A sensor's noise moves no ball. A command that a controller
computes from noisy positions scatters as well, and the beam follows it: smoothed away as noise, it is missing in the
drive, whose error is then stated several times too large. Dry friction came out at half its size and with a third of
its standard error so, since a ball on a beam of uncertain angle may stop at any time; and a second law that no ball
obeys lowered the deviance by 70 (docs/diagnosis_experiments.md).

Where the beam lags behind the command, the ball tells it by a model that lags, too, and by no other: hence the few
hypotheses below. They stand for what acts on many rigs, and are not what is searched for.
"""

from __future__ import annotations

import math

from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

_SHARES = (0.3, 0.1, 0.03)  # a scatter of less is none: the readings are then followed as they are
_BESIDE: tuple[tuple[str, ...], ...] = (
    (),
    ("channel_delay",),
    ("angle_lag",),
    ("rolling_resistance", "angle_lag"),
    ("viscous_damping", "angle_lag"),
)
_PRICE = 20.0  # by which a share lowers the BIC at least: very strong evidence begins at 10
_SAME = 2.0  # differences of the deviance that tell nothing of a share


def told_noise_share(problem: Problem) -> float:
    """Share of the angle's scatter that is an error [1]; 1 unless the ball's readings tell that it is less.

    Of shares that fit as well as each other the largest, which leaves the readings the least to say.
    """
    if not any(one.drive.sensor.scatters for one in problem.recordings):
        return 1.0
    coarse = problem.coarse
    deviances = {share: _lowest_deviance(coarse.quieter(share)) for share in (1.0, *_SHARES)}
    lowest = min(deviances.values())
    share = max(share for share, one in deviances.items() if one < lowest + _SAME)
    told = deviances[share] < deviances[1.0] - _PRICE - math.log(coarse.readings)
    return share if told else 1.0


def _lowest_deviance(problem: Problem) -> float:
    known = {term.effect.name for term in problem.declared}
    tried = [names for names in _BESIDE if not known.intersection(names)]
    return min(fit(problem, Hypothesis((*problem.unknown, *names))).deviance for names in tried)
