"""The colour of the reading noise: estimated by likelihood, beside whatever moves the ball.

A sensor with a filter or an interface of its own delivers noise that one reading shares with the next. Taken for white,
it makes the ball seem to move at random, and its variance, from differences of neighbouring readings, is too small.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from analytic.motion import FloatArray
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import NOTHING
from harness.identify.problem.problem import Colour, Problem

LONGEST = 0.1  # correlation time [s]: what lasts longer cannot be told from what moves the ball
_READINGS = 1500  # from which the colour is estimated: its two numbers need no more
_PRICE = 20.0  # by which colour lowers the BIC at least: very strong evidence begins at 10
_TIMES = (2.0, 5.0, 15.0)  # correlation times that are tried first, over the median interval of readings
_DENSITIES = 10.0 ** np.arange(-11.0, 0.0, 2.0)  # of the process noise [m²/s³]
_MOST_ODDS = 7.0  # log of share to rest: no sensor's readings are free of white noise
_REACH = (0.7, 1.0, 0.7, 2.0)  # of the first simplex, in the logs that `_start` returns
_SHARE = 0.9  # of the variance that is coloured where the search begins


def with_noise_colour(problem: Problem) -> Problem:
    """The same problem with coloured reading noise if the readings tell so, else the problem itself.

    The model is the baseline with process noise of any density, which stands for all that it may lack: a random
    acceleration shows in the position as its second integral, slowly; coloured noise within its correlation time.
    """
    part = problem.beginning(_READINGS)
    white = min(deviance(part, NOTHING, density) for density in _DENSITIES)
    interval = float(np.median(np.concatenate([np.diff(one.time) for one in part.recordings])))
    tried = [
        (deviance(_coloured(part, start), NOTHING, math.exp(start[3])), start)
        for time in _TIMES
        if time * interval <= LONGEST
        for density in _DENSITIES
        for start in [_start(part, time * interval, interval, density)]
    ]
    price = _PRICE + 2.0 * math.log(part.readings)
    lowest, start = min(tried, key=lambda one: one[0], default=(math.inf, np.zeros(4)))
    if lowest >= white:
        return problem

    def objective(x: FloatArray) -> float:
        return deviance(_coloured(part, x), NOTHING, math.exp(x[3]))

    simplex = start + np.vstack((np.zeros(4), np.diag(_REACH)))
    found = minimize(objective, start, method="Nelder-Mead", options={"initial_simplex": simplex, "fatol": 0.5})
    if found.fun >= white - price:
        return problem
    estimated = _coloured(problem, found.x)
    return problem if estimated.colour.time >= LONGEST else estimated


def _start(part: Problem, time: float, interval: float, density: float) -> FloatArray:
    """Logs of variance, odds of its coloured share, time and density, for the variance that differences tell.

    Second differences of noise with the correlation ρ from reading to reading have the variance
    σ² (1 − ρ) (3 − ρ)/3 of those of white noise.
    """
    rho = math.exp(-interval / time)
    told = 1.0 - _SHARE * (1.0 - (1.0 - rho) * (3.0 - rho) / 3.0)
    odds = math.log(_SHARE / (1.0 - _SHARE))
    return np.array([math.log(part.reading_variance / told), odds, math.log(time), math.log(density)])


def _coloured(problem: Problem, x: FloatArray) -> Problem:
    """With the variance and colour of the parameters of `_start`."""
    share = 1.0 / (1.0 + math.exp(-min(x[1], _MOST_ODDS)))
    return replace(problem, reading_variance=math.exp(x[0]), colour=Colour(share, min(math.exp(x[2]), LONGEST)))
