"""Effects whose gain in likelihood is no more than correlated innovations give.

The likelihood takes innovations for independent. Where the record is worse than its noise model, with wrong stamps, a
track that is worn or a zero that wanders, they are correlated over seconds, a score sums to more than its information
says, and an effect of no size gains what the criterion asks for. A likelihood ratio is then distributed as χ² with
weights that are the eigenvalues of the score's true covariance over the supposed one; divided by their mean, it has the
mean that χ² has (Rotnitzky and Jewell, Biometrika 77, 1990). The true covariance is estimated by sums of scores over
blocks of time (Liang and Zeger, Biometrika 73, 1986).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.identify.estimate.fit import FINE_STEP, Fit, fit
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import selected_effects
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.progress import Progress

_BLOCK = 2.0  # as long as a ball takes along the beam: beyond, scores have little in common [s]
_BY_CHANCE = 2.0  # standard errors of the mean weight that chance may give it


def without_correlated(problem: Problem, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """`found` without the effects that do not pay once their gain is divided by the mean weight of their scores.

    Weights that are 1 within what chance gives, as those of a clean record, are taken for 1: nothing is then decided.
    """
    names = selected_effects(problem, found)
    if not names or found.hypothesis.spline is not None:
        return found
    weights = score_weights(problem, found, names)
    for name in sorted(names, key=lambda name: -weights[name]):
        if weights[name] == 1.0:
            break
        progress(f"without {name}: its score is correlated")
        rest = Hypothesis(tuple(other for other in found.hypothesis.names if other != name))
        without = fit(problem, rest, process_noise=found.process_noise, initial=found.values())
        if not ledger.decide(Rule.CORRELATED, found, without, (name,), Evidence(weight=weights[name])):
            return without_correlated(problem, without, ledger, progress)
    return found


def score_weights(problem: Problem, found: Fit, names: Sequence[str]) -> dict[str, float]:
    """Mean weight of the χ² distribution of each effect's likelihood ratio; 1 unless it is surely larger [1].

    1 for an effect whose values differ between recordings, which has too few blocks for each.
    """
    residuals = Residuals(problem, found.hypothesis, found.process_noise)
    slopes, smoothness = residuals.jacobian(found.theta, FINE_STEP), found.hypothesis.smoothness(problem)
    block = _blocks(problem)
    scores = np.zeros((block.max() + 1, len(found.theta)))
    np.add.at(scores, block, slopes * residuals.at(found.theta)[:, None])
    supposed = np.linalg.pinv(slopes.T @ slopes + smoothness.T @ smoothness)
    true = supposed @ scores.T @ scores @ supposed

    def weight(name: str) -> float:
        at = [i for i, (effect, _) in enumerate(found.hypothesis.parameters) if effect == name]
        if not at:
            return 1.0
        each = np.ix_(at, at)
        mean = float(np.trace(np.linalg.pinv(supposed[each]) @ true[each])) / len(at)
        # of a variance that is estimated from so many sums
        error = math.sqrt(2.0 / (len(scores) * len(at)))
        return mean if mean > 1.0 + _BY_CHANCE * error else 1.0

    return {name: weight(name) for name in names}


def _blocks(problem: Problem) -> NDArray[np.int64]:
    """Number of the block of each reading that the filter predicts, shape (readings,)."""
    numbers, begin = [], 0
    for one in problem.recordings:
        time = one.time[one.judged]
        number = np.floor((time - one.time[0]) / _BLOCK).astype(np.int64)
        numbers.append(begin + np.unique(number, return_inverse=True)[1])
        begin = int(numbers[-1].max(initial=begin - 1)) + 1
    return np.concatenate(numbers)
