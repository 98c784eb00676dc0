"""Cross-validation of a hypothesis over seconds: fitted to free runs without a block of a recording, which it predicts.

The errors of held-out blocks are the evidence; they also choose the process noise with which the filter predicts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.free_run_fit import Effort, fit_free_runs
from harness.identify.estimate.window_errors import DENSITIES, errors_by_density
from harness.identify.filter.run import deviance
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Block, Window, block_groups, of_windows
from harness.parallel import side_by_side


def cross_validated(problem: Problem, whole: Fit, *, jobs: int = 1) -> Fit:
    """A fit to free runs with the errors of held-out blocks, and the process noise that predicts these best.

    Of densities that predict as well the highest is taken: it trusts the readings most.

    Args:
        whole: to all windows.
        jobs: processes for the folds.
    """
    made = side_by_side([partial(_without, problem, whole, fold) for fold in block_groups(problem.recordings)], jobs)
    of_blocks = np.concatenate(made)
    means = np.mean(of_blocks, axis=0)
    best = int(np.flatnonzero(means <= (1.0 + problem.settings.held_out_rival) * means.min())[-1])
    density = float(DENSITIES[best])
    return replace(
        whole,
        process_noise=density,
        deviance=deviance(problem, whole.terms, density),
        held_out=tuple(of_blocks[:, best].tolist()),
    )


def _without(problem: Problem, whole: Fit, blocks: Sequence[Block]) -> FloatArray:
    """Errors of blocks that are held out together, by a fit without them, shape (blocks, densities) [m]."""
    part = fit_without(problem, whole, blocks[0].fitted)
    by_density = errors_by_density(problem, part, [window for block in blocks for window in block.held_out])
    ends = np.cumsum([len(block.held_out) for block in blocks])[:-1]
    return np.array([np.sqrt(np.mean(each**2, axis=1)) for each in np.split(by_density, ends, axis=1)])


def fit_without(problem: Problem, whole: Fit, fitted: Sequence[Window]) -> Fit:
    """The hypothesis of a fit to free runs, fitted from its values to some windows and the recordings they are of."""
    return fit_free_runs(
        of_windows(problem, fitted), whole.refined, fitted, initial=whole.values(), effort=Effort.NEAR
    ).fit
