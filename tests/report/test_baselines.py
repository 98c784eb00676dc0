"""The baselines' section says who predicts better, and does not claim more than the windows carry."""

from __future__ import annotations

import numpy as np
import pytest

from harness.identify.validation.baseline_comparison import AFTER, BEFORE, BLACK_BOX, INTEGRATOR, BaselineComparison
from harness.report.diagnosis.baselines import _answer, _table

ONE = 1e-3 * np.array([1.0, 2.0, 1.5, 2.5, 1.2, 1.8])


@pytest.mark.parametrize(
    ("integrator", "black_box", "said"),
    [
        (3.0 * ONE, 2.0 * ONE, "better than both baselines, beyond"),
        (3.0 * ONE, 1.01 * ONE[::-1], "do not make it sure of the output-error model"),
        (0.5 * ONE, 2.0 * ONE, "no better than the double integrator:"),
        (3.0 * ONE[:3], 2.0 * ONE[:3], "too few windows"),
    ],
    ids=["both beaten", "one perhaps", "one not", "too few"],
)
def test_the_answer_goes_with_the_margins(integrator, black_box, said):
    """Say that both are beaten only where both intervals lie beyond 0."""
    own = ONE[: len(integrator)]
    made = BaselineComparison({BEFORE: 2.0 * own, AFTER: own, INTEGRATOR: integrator, BLACK_BOX: black_box})
    assert said in _answer(made)


def test_every_contender_has_a_row_and_the_best_is_set_apart():
    """Count the windows, and mark the least RMS error."""
    made = BaselineComparison({BEFORE: 2.0 * ONE, AFTER: ONE, INTEGRATOR: 3.0 * ONE, BLACK_BOX: 4.0 * ONE})
    rows = _table(made).rows
    assert [row.kind == "best" for row in rows] == [False, True, False, False]
    assert [row.cells[-1] for row in rows] == ["—", "—", "6 of 6", "6 of 6"]
