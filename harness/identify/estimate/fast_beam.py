"""A beam that turns far between two readings of its angle: what the smoother takes for noise of them is motion.

From the record of an angle alone, white noise and a motion faster than half the sampling rate look alike: of a beam
that is moved at 1.5 Hz and sampled without noise at 10 Hz, a tenth of the swing is taken for noise, and smoothed away.
The density of its third derivative, which has as many values as there are readings then, comes out too large at the
same time. With such a drive a delay of the position looks like whatever smooths the angle: a hold, or a servo. The
ball, which has followed the beam between the readings too, tells both apart.
"""

from __future__ import annotations

from analytic.effects import CHANNEL_DELAY
from harness.identify.estimate.angle_noise import ASKED, SAME, lowest_deviance
from harness.identify.problem.problem import Problem
from harness.threads import in_threads

_SHARES = (0.3, 0.1, 0.03, 0.01)  # of the deviation that the angle's readings tell; less is none
_DENSITIES = (0.3, 0.1, 0.03, 0.01)  # times that which they tell
_ASKED_BESIDE = (CHANNEL_DELAY.name,)
_FELT = 1e-4  # noise of the angle [rad]: less accelerates a ball by less than 1 mm/s²


def with_fast_beam(problem: Problem) -> Problem:
    """The same problem, with less noise of the angle and a smoother beam where the ball's readings tell so.

    Asked is a model with a delay, which most records have. The less noise, and beside it the smoother beam, each have
    to lower the BIC as much as an effect has. Of what fits as well as each other it is that nearest to what the
    readings of the angle tell. Nothing is asked where the noise is declared, less than the rounding, or not felt.
    """
    sensors = [one.drive.sensor for one in problem.recordings]
    noisy = all(one.estimated and not one.rounded for one in sensors)
    if not noisy or max(one.noise for one in sensors) < _FELT:
        return problem
    part = problem.beginning(ASKED)
    price = part.least_gain
    share = _told(part, [part.quieter(share) for share in _SHARES], _SHARES, price)
    if share == 1.0:
        return problem
    part = part.quieter(share)
    density = _told(part, [part.rougher(density) for density in _DENSITIES], _DENSITIES, price)
    return problem.quieter(share).rougher(density)


def _told(asked: Problem, others: list[Problem], factors: tuple[float, ...], price: float) -> float:
    """The factor of the one among `others` that is preferred to the problem asked, 1 if none is."""
    before, *deviances = in_threads(lambda one: lowest_deviance(one, _ASKED_BESIDE), (asked, *others))
    if min(deviances) >= before - price:
        return 1.0
    return max(factor for factor, one in zip(factors, deviances, strict=True) if one < min(deviances) + SAME)
