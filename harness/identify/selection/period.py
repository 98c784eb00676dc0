"""The period with which a force repeats itself along the beam, as far as the linearised filter tells it."""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.starts import starting_points
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Kind, Regressor, blank

_NODES = 64  # of the force of position that waves are made of
_PER_WAVE = 4  # nodes that a wave needs
_SPACING = 0.1  # of the wave numbers, in waves over the range: between two of them phases differ by 18° at either end
_SCALED_STEP = 1.0  # of the Jacobian's differences: the innovations are nearly linear in the nodes


def period_of(problem: Problem, found: Fit, low: float, high: float) -> float:
    """The period of the sine along the beam that, added to a model, lowers the deviance most in one step [m].

    The innovations are nearly linear in the nodes of a force of position. Their derivatives are taken once, for a fine
    spline; those by a sine and a cosine of any period are sums of them. What the effects of the model could take over
    is left out.

    Args:
        problem: coarse data will do.
        found: the model, with the process noise that it needs.
        low, high: range of positions [m]. Periods from its whole length to a sixteenth of it are compared.
    """
    spline = blank(Kind(Regressor.POSITION), low, high, _NODES)
    hypothesis = Hypothesis(found.hypothesis.names, spline)
    theta = starting_points(problem, hypothesis, found.values(), found.process_noise)[0]
    residuals = Residuals(problem, hypothesis, found.process_noise)
    slopes = residuals.jacobian(theta, _SCALED_STEP)
    others, nodes = slopes[:, :-_NODES], slopes[:, -_NODES:]
    left = _beside(others, np.column_stack((residuals.at(theta), nodes)))
    target, nodes = left[:, 0], left[:, 1:]
    waves = np.arange(1.0, _NODES / _PER_WAVE, _SPACING)
    place = np.arange(_NODES) / (_NODES - 1)
    gains = [_explained(nodes @ _wave(place, count), target) for count in waves]
    return float((high - low) / waves[np.argmax(gains)])


def _wave(place: FloatArray, count: float) -> FloatArray:
    """Sine and cosine with `count` waves over places from 0 to 1, shape (n,); shape (n, 2)."""
    turn = 2.0 * np.pi * count * place
    return np.column_stack((np.sin(turn), np.cos(turn)))


def _beside(others: FloatArray, columns: FloatArray) -> FloatArray:
    """`columns`, shape (readings, m), without what is a sum of `others`, shape (readings, k)."""
    return columns - others @ np.linalg.lstsq(others, columns, rcond=None)[0] if others.shape[1] else columns


def _explained(columns: FloatArray, target: FloatArray) -> float:
    """Sum of squares of `target`, shape (readings,), that sums of `columns` explain, shape (readings, m)."""
    return float(np.sum((columns @ np.linalg.lstsq(columns, target, rcond=None)[0]) ** 2))
