"""Whether a beam that shakes between the readings of its angle pushes the ball outward as far as an effect does.

The centrifugal force of a rate that nobody recorded grows with s: a mean square of σ² pushes as a tilt of σ²/g for each
metre does, which is a beam that bends, or a hill. A controller that follows a noisy position shakes a beam so, and
where its command changes with each reading, what is between two readings of the angle may be as fast as what they show:
on simulated rigs whose rates had a mean square of 0.06 to 0.08 rad²/s², 0.02 to 0.04 of it was not in the smoothed
angle, and a compliance was found that was not there.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from analytic.effects import BEAM_COMPLIANCE, TRACK_CURVATURE
from harness.identify.problem.problem import Problem


def may_be_shaking(problem: Problem, name: str, values: Mapping[str, float]) -> bool:
    """Whether an effect tilts the track outward by no more than a beam would that shakes as fast as it moves.

    Of a command that is held the beam's rates are not known (`HeldDrive`), and nothing is said.

    Args:
        name: of the effect.
        values: its parameters by name, in the units of the catalogue: compliance [rad/(N m)], curvature [1/m].
    """
    if name == BEAM_COMPLIANCE.name:
        tilt = values["compliance"] * problem.rig.mass * problem.rig.gravity  # 1/m
    elif name == TRACK_CURVATURE.name:
        tilt = -values["curvature"]
    else:
        return False
    rates = np.concatenate([one.drive.states[:, 1] for one in problem.recordings])
    return 0.0 < tilt < float(np.mean(rates**2)) / problem.rig.gravity
