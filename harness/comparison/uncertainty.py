"""Validation uncertainty u_val by Monte Carlo: the error to be expected of a perfect model.

Beam motions, start states and, if the rig was estimated, rigs are drawn from their posterior distributions and run
through CAM. The RMS deviation from the run with the best estimates is the input uncertainty (ASME V&V 20: u_input);
sensor noise is added (u_D).
"""

import numpy as np

from analytic.effects import motion_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import BeamMotion, FloatArray
from analytic.slots import CENTRIFUGAL, ECCENTRIC, GRAVITY, LEVEL
from harness.comparison.horizons import Horizon
from harness.comparison.setting import Setting
from harness.metrics import validation_uncertainty
from harness.numerics import rms


def displacements(setting: Setting) -> list[FloatArray]:
    """Displacement of the ball by each draw, one array of shape (draws, stamps) per horizon [m].

    The stamps are those of the horizon's runs, one run after the other: windows fill little of (runs, n), and of a
    recording of minutes memory would not hold that for every draw.
    """
    choices, drive, ball = setting.choices, setting.drive, setting.ball
    draws, generator = choices.draws, np.random.default_rng(choices.seed)
    grid = Grid.over(setting.time)
    paths: list[BeamMotion] = [drive, *drive.draw(draws, choices.seed)]
    tables = np.array([grid.tabulate(motion_with(path, setting.time, setting.acting)) for path in paths])
    parameters = _parameters(setting, draws, generator)
    result = []
    for horizon in setting.horizons:
        starts = np.repeat(setting.starts(horizon)[None], draws + 1, axis=0)
        if horizon.seconds is not None or choices.start is None:  # a start given by the user is exact
            for i, first in enumerate(horizon.first):
                starts[1:, i] += _normal(generator, ball.state_covariance(int(first)), draws)
            # The state was smoothed relative to CAM, whose velocity contains −K ℓ α̇: with a beam rate above the
            # estimate the ball starts correspondingly slower.
            rate = tables[:, 2 * grid.marks[horizon.first], 1]
            starts[1:, :, 1] -= parameters[1:, ECCENTRIC, None] * (rate[1:] - rate[0])
        moved = []
        for i, (first, last) in enumerate(zip(horizon.first.tolist(), horizon.last.tolist(), strict=True)):
            part, rows = _between(grid, first, last)
            every = np.arange(draws + 1)
            drawn = integrate(part, tables[:, rows], parameters, starts[:, i], table_of=every).position
            moved.append(drawn[1:] - drawn[0])
        result.append(np.concatenate(moved, axis=1))
    return result


def _between(grid: Grid, first: int, last: int) -> tuple[Grid, slice]:
    """The grid from one stamp to another, given by their indices, and the rows of a table of `grid` for it."""
    begin, end = int(grid.marks[first]), int(grid.marks[last])
    marks = grid.marks[first : last + 1] - begin
    return Grid(grid.time[first : last + 1], grid.steps[begin:end], marks), slice(2 * begin, 2 * end + 1)


def uncertainty(setting: Setting, horizon: Horizon, displacement: FloatArray) -> FloatArray:
    """u_val of the runs of a horizon with its `displacement`, shape (draws, stamps): shape (runs, n) [m]."""
    spread = rms(displacement, axis=0)
    moved, begin = np.full((len(horizon.first), len(setting.time)), np.nan), 0
    for i, where in enumerate(horizon.slices()):
        end = begin + where.stop - where.start
        moved[i, where], begin = spread[begin:end], end
    return validation_uncertainty(setting.reading_noise, moved)


def _parameters(setting: Setting, draws: int, generator: np.random.Generator) -> FloatArray:
    """CAM's kernel parameters for the estimated rig (first row) and for rigs drawn from its covariance."""
    vectors = np.tile(setting.vector(CAM), (draws + 1, 1))
    if setting.fitted is not None:
        ratio, level, lever = _normal(generator, setting.fitted.covariance, draws).T
        scale = 1.0 + ratio / setting.fitted.ratio
        vectors[1:, GRAVITY] *= scale
        vectors[1:, CENTRIFUGAL] *= scale
        vectors[1:, ECCENTRIC] += setting.fitted.ratio * lever
        vectors[1:, LEVEL] += level
    return vectors


def _normal(generator: np.random.Generator, covariance: FloatArray, draws: int) -> FloatArray:
    """Normal draws of mean zero, shape (draws, k); `covariance`, shape (k, k), may be singular."""
    return generator.multivariate_normal(np.zeros(len(covariance)), covariance, draws, method="eigh")
