"""How predictions are made with a fit: their band, their travel, and their errors on blocks that are held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from operator import call

from harness.identify.estimate.band import Foreseen, fitted_band
from harness.identify.estimate.block_errors import fit_without_blocks, groups_of
from harness.identify.estimate.covariance import with_interval_covariance
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.travel import travel_of
from harness.identify.estimate.window_errors import foreseen_errors
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Block, Window, without_predicted
from harness.numerics import rms
from harness.parallel import side_by_side
from harness.threads import in_threads


def as_predicted(problem: Problem, found: Fit, *, jobs: int = 1) -> Fit:
    """A fit with the travel of the recordings, and band and errors of its predictions by fits without what is held out.

    For recordings that the likelihood does not explain. It takes as long as a cross-validation, and is asked of one fit
    alone. Where nothing can be held out, band and errors stay as they are.

    Args:
        jobs: processes for the fits without a group of blocks; 1 for threads.
    """
    found = replace(found, travel=travel_of(problem.recordings))
    groups = groups_of(problem.recordings)
    work = [partial(_foreseen, problem, found, *group) for group in groups]
    blocks = list(chain.from_iterable(side_by_side(work, jobs) if jobs > 1 else in_threads(call, work)))
    if not blocks:
        return found
    errors = tuple(rms(block.error) for block in blocks)
    return replace(found, band=fitted_band(blocks, problem.reading_variance), forecast_errors=errors)


def _foreseen(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> list[Foreseen]:
    """Errors of each of the blocks that are held out together, and what a fit without them foresees.

    It foresees as the whole fit does: with its process noise, where that is not fitted to forecasts, and with the
    covariance that intervals have.
    """
    part = fit_without_blocks(problem, whole, fitted, blocks)
    if whole.estimator is Estimator.LIKELIHOOD:
        part = replace(part, process_noise=whole.process_noise)
        part = with_interval_covariance(without_predicted(problem, blocks), part)
    return [foreseen_errors(problem, part, block.held_out) for block in blocks]
