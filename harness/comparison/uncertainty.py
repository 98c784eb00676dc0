"""What a perfect model would still be off by: sensor noise, and the start's and the angle's uncertainty propagated.

Beam motions and start states are drawn from what the record leaves open and run through CAM, many at once; their
spread around the run from the best estimates is what inputs make uncertain (ASME V&V 20: u_input), and the reading's
noise comes on top (u_D).
"""

from __future__ import annotations

import numpy as np

from analytic.effects import motion_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM, CENTRIFUGAL, ECCENTRIC, GRAVITY, LEVEL
from analytic.motion import BeamMotion, FloatArray
from harness.comparison.setting import Setting
from harness.metrics import validation_uncertainty


def displacements(setting: Setting) -> list[FloatArray]:
    """How far drawn inputs move the ball: one array a horizon, shape (draws, runs, n), NaN outside a run [m]."""
    choices, drive, ball = setting.choices, setting.drive, setting.ball
    draws, generator = choices.draws, np.random.default_rng(choices.seed)
    grid = Grid.over(setting.time)
    paths: list[BeamMotion] = [drive, *drive.draw(draws, choices.seed)]
    tables = np.array([grid.tabulate(motion_with(path, setting.time, setting.acting)) for path in paths])
    parameters = _parameters(setting, draws, generator)
    result = []
    for horizon in setting.horizons:
        runs = len(horizon.first)
        starts = np.repeat(setting.starts(horizon)[None], draws + 1, axis=0)
        if horizon.seconds is not None or choices.start is None:  # a start that was given is taken for exact
            for i, first in enumerate(horizon.first):
                root = _root(ball.spread(int(first)))
                starts[1:, i] += generator.standard_normal((draws, 2)) @ root.T
            # The state was smoothed relative to CAM, whose velocity holds −K ℓ α̇: a beam that turned faster than it was
            # read leaves the ball that much slower, and the run cancels it again.
            rate = tables[:, 2 * grid.marks[horizon.first], 1]
            starts[1:, :, 1] -= parameters[1:, ECCENTRIC, None] * (rate[1:] - rate[0])
        drawn = integrate(
            grid,
            tables,
            np.repeat(parameters, runs, axis=0),
            starts.reshape(-1, 2),
            table_of=np.repeat(np.arange(draws + 1), runs),
            first=np.tile(horizon.first, draws + 1),
            last=np.tile(horizon.last, draws + 1),
        ).position.reshape(draws + 1, runs, -1)
        result.append(drawn[1:] - drawn[0])
    return result


def uncertainty(setting: Setting, displacement: FloatArray) -> FloatArray:
    """u_val of the runs that `displacement`, shape (draws, runs, n), belongs to: shape (runs, n) [m]."""
    return validation_uncertainty(setting.reading_noise, np.sqrt(np.mean(displacement**2, axis=0)))


def _parameters(setting: Setting, draws: int, generator: np.random.Generator) -> FloatArray:
    """Kernel parameters of the best rig and of rigs drawn from what the estimation leaves open."""
    vectors = np.tile(setting.vector(CAM), (draws + 1, 1))
    if setting.fitted is not None:
        kicks = generator.standard_normal((draws, 3)) @ _root(setting.fitted.covariance).T
        ratio, level, lever = kicks.T
        scale = 1.0 + ratio / setting.fitted.ratio
        vectors[1:, GRAVITY] *= scale
        vectors[1:, CENTRIFUGAL] *= scale
        vectors[1:, ECCENTRIC] += setting.fitted.ratio * lever
        vectors[1:, LEVEL] += level
    return vectors


def _root(covariance: FloatArray) -> FloatArray:
    """A matrix whose product with its transpose is `covariance`, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    root: FloatArray = vectors * np.sqrt(values.clip(min=0.0))
    return root
