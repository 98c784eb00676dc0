"""Position readings with an error of a colour of its own, which no model declares."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from harness.identify.problem.problem import Problem


def with_coloured_readings(problem: Problem, correlation: float, innovation: float) -> Problem:
    """The same with an AR(1) error added to all readings, which begins at zero.

    Args:
        correlation: of the errors of neighbouring readings [1].
        innovation: standard deviation of what each adds [m].
    """
    generator = np.random.default_rng(0)
    recordings = []
    for one in problem.recordings:
        white = np.append(0.0, innovation * generator.standard_normal(len(one.time) - 1))
        recordings.append(replace(one, reading=one.reading + lfilter([1.0], [1.0, -correlation], white)))
    return replace(problem, recordings=tuple(recordings))
