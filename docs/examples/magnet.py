"""A small magnet beside the track: it pulls the steel ball from both sides, most from half its distance away."""

import numpy as np

from analytic.effects import Effect, Force, Parameter

PEAK = 25.0 * np.sqrt(5.0) / 16.0  # makes the largest force 1, at x = 1/2


def pull(s, force, centre, distance):
    """Force on the ball [N], positive towards +s, at the positions s, shape (n,) [m]."""
    x = (centre - s) / distance
    return force * PEAK * x / (1.0 + x**2) ** 2.5


MAGNET = Effect(
    name="magnet",
    law="F = F_max · 25 √5/16 · x/(1 + x²)^(5/2), x = (s_c − s)/d; F_max < 0 repels",
    parameters=(
        Parameter("force", "N", low=-0.1, high=0.1, typical=0.01),
        Parameter("centre", "m", low=0.0, high=0.7, typical=0.3, place=True, starts=(0.15, 0.25, 0.35, 0.45)),
        Parameter("distance", "m", low=0.01, high=0.3, typical=0.05),
    ),
    source="energy of two dipoles side by side; Jackson, Classical Electrodynamics, 3rd ed., sections 5.6 and 5.7",
    force=Force("position", pull),
)
