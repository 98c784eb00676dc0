"""Which combination of parameters the recordings do not tell apart: collinear directions of the sensitivities.

Columns are what each parameter does to the runs, whitened, without what starts can undo, and scaled to unit length. A
singular value far below 1 is a combination in which the parameters undo one another; its inverse is the collinearity
index, beyond 10 to 15 of which parameters are called not identifiable together (Brun, Reichert and Künsch, Water
Resources Research 37, 2001).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.formatting import listed, number, percent
from harness.tuning.estimate.free import Free
from harness.tuning.estimate.selection import Selection

INDEX = 10.0
"""Collinearity index from which a combination is not identifiable."""
_SHARE = 0.2  # of the largest coefficient, from which a parameter belongs to a combination


@dataclass(frozen=True)
class Combination:
    """A combination of parameters that these recordings do not determine.

    Attributes:
        moves: by how much each parameter moves in it, on its scale of the fit, the first one by +1 %, or by a hundredth
            of its unit where that scale is linear.
        index: collinearity index [1].
        text: in words.
    """

    moves: dict[str, float]
    index: float
    text: str


def combinations(selection: Selection, free: Sequence[Free]) -> tuple[Combination, ...]:
    """The combinations among the level angle and all parameters that the recordings tell at all, worst first.

    A parameter that was left at its default is represented by its effect at the value at which it is most visible.
    """
    found = selection.found
    columns: list[FloatArray] = []
    shown: list[Free] = []
    by_name = {one.name: one for one in free}
    for at, one in enumerate(found.free):
        columns.append(found.jacobian[:, at])
        shown.append(one)
    for name, screened in selection.screened.items():
        one = by_name[name]
        if name in found.names or not screened.seen or one.default is None:
            continue
        reach = one.scaled(screened.at) - one.scaled(max(one.default, one.low))
        columns.append(screened.response / reach)
        shown.append(one)
    if len(shown) < 2:
        return ()
    matrix = np.column_stack(columns)
    lengths = np.linalg.norm(matrix, axis=0)
    use = lengths > 0.0
    matrix, lengths = matrix[:, use] / lengths[use], lengths[use]
    kept = [one for one, used in zip(shown, use, strict=True) if used]
    _, singular, directions = np.linalg.svd(matrix, full_matrices=False)
    made = []
    for value, direction in zip(singular[::-1], directions[::-1], strict=True):
        index = float(1.0 / max(value, 1e-9))
        if index >= INDEX:
            made.append(_combination(direction / lengths, np.abs(direction), kept, index))
    return tuple(made)


def _combination(moves: FloatArray, weights: FloatArray, free: Sequence[Free], index: float) -> Combination:
    belongs = np.flatnonzero(weights > _SHARE * weights.max()).tolist()
    first = int(belongs[np.argmax(weights[belongs])])
    one = free[first]
    step = 0.01 if one.logarithmic else 0.01 / (one.high - one.low)
    moves = moves / moves[first] * step
    told = [_told(free[at], float(moves[at])) for at in (first, *(at for at in belongs if at != first))]
    undone = f"{told[0]} is undone by {listed(told[1:])}" if len(told) > 1 else told[0]
    text = f"{undone}: free runs change by less than 1/{number(index, 2)} of what each alone would change them"
    return Combination({free[at].name: float(moves[at]) for at in belongs}, index, text)


def _told(one: Free, move: float) -> str:
    """`rolling_radius_m by +1 %`; a parameter on a linear scale in its unit."""
    sign = "+" if move > 0.0 else "−"
    if one.logarithmic:
        return f"`{one.name}` by {sign}{percent(abs(move))}"
    return f"`{one.name}` by {sign}{number(abs(move) * (one.high - one.low), 2)} {one.unit}"
