"""What an unlisted law depends on, strongest first."""

from __future__ import annotations

from collections.abc import Sequence

from harness.identify.estimate.fit import Fit
from harness.identify.problem.spline_term import Depends, Shape
from harness.identify.selection.candidates import Entry
from harness.identify.selection.spline_terms import CURVE_THRESHOLD


def depends_on(found: Fit, ledger: Sequence[Entry]) -> list[Depends]:
    """What the curve of `found` depends on, then that of any other curve that explains nearly as much; none without.

    A friction follows the sign of the velocity beside what its coefficient depends on. Nearly as much is what would not
    have decided for a curve: a BIC within `CURVE_THRESHOLD` of the best one's, with the same effects beside it.
    """
    best = found.hypothesis.shape
    if best is None:
        return []
    curves = [one for one in ledger if one.fit.hypothesis.shape is not None and one.effect.startswith("curve ")]
    least = min((one.fit.bic for one in curves), default=found.bic)
    near = sorted((one for one in curves if one.fit.bic - least <= CURVE_THRESHOLD), key=lambda one: one.fit.bic)
    shapes = [best, *(one.fit.hypothesis.shape for one in near)]
    return list(dict.fromkeys(on for shape in shapes if shape is not None for on in _of(shape)))


def _of(shape: Shape) -> list[Depends]:
    return [shape.depends, Depends.VELOCITY] if shape.friction else [shape.depends]
