"""Recordings of a ball that random accelerations move, which no law explains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.identify.problem.problem import Problem


def with_random_accelerations(problem: Problem, root_density: float) -> Problem:
    """The same problem with the position that white accelerations lead to added to every reading.

    Args:
        root_density: square root of their spectral density [m/s^1.5].
    """
    generator = np.random.default_rng(0)
    moved = []
    for one in problem.recordings:
        step = np.diff(one.time, prepend=one.time[0])
        velocity = np.cumsum(root_density * np.sqrt(step) * generator.standard_normal(len(step)))
        moved.append(replace(one, reading=one.reading + np.cumsum(velocity * step)))
    return replace(problem, recordings=tuple(moved))
