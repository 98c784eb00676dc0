"""The baselines' section says who predicts better, and does not claim more than the blocks carry."""

from __future__ import annotations

import numpy as np
import pytest

from harness.formatting import number
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    FORECASTS,
    BaselineComparison,
)
from harness.identify.validation.baselines import BLACK_BOXES
from harness.numerics import rms
from harness.report.diagnosis.baselines import TITLES, _answer, _table

ONE = 1e-3 * np.array([1.0, 2.0, 1.5, 2.5, 1.2, 1.8])
WORSE_BASELINES = dict.fromkeys(BASELINES, 3.0 * ONE)
WORSE = {BEFORE: 2.0 * ONE, AFTER: ONE} | WORSE_BASELINES


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, "better than all baselines, beyond"),
        ({"output_error_3": 1.01 * ONE[::-1]}, "not make it sure of the output-error model of order 3."),
        ({"double_integrator": 0.5 * ONE}, "no better than the double integrator:"),
        ({"at_rest": 0.5 * ONE, "output_error_2": 0.9 * ONE}, "no better than the ball at rest and output-error model"),
    ],
    ids=["all beaten", "one perhaps", "one not", "two not"],
)
def test_the_answer_goes_with_the_margins(changed, said):
    """Claim a significant improvement only if all intervals are above 0."""
    assert said in _answer(BaselineComparison(WORSE | changed))


def test_three_blocks_allow_no_answer():
    """Say that there are too few."""
    assert "too few blocks" in _answer(BaselineComparison({name: errors[:3] for name, errors in WORSE.items()}))


def test_every_contender_has_a_row_and_the_best_is_set_apart():
    """Count the blocks, and mark the least RMS error."""
    rows = _table(BaselineComparison(WORSE)).rows
    assert [row.kind == "best" for row in rows] == [False, True, *[False] * len(BASELINES)]
    assert [row.cells[-1] for row in rows] == ["—", "—", *["6 of 6"] * len(BASELINES)]


def test_black_boxes_are_called_so():
    """Say of the output-error models, and of them alone, what they are fitted to."""
    assert {name for name in TITLES if "a black box fitted to the forecast" in TITLES[name]} == set(BLACK_BOXES)


def test_parameters_for_predictions_have_a_row():
    """Give the error of parameters fitted to forecasts beside that of those found, and compare what predicts."""
    rows = _table(BaselineComparison({BEFORE: 2.0 * ONE, AFTER: ONE, FORECASTS: 0.5 * ONE} | WORSE_BASELINES)).rows
    assert rows[2].cells[0] == "fitted to forecasts, for predictions alone"
    assert [row.kind == "best" for row in rows] == [False, False, True, *[False] * len(BASELINES)]
    gain = 1e3 * (rms(3.0 * ONE) - rms(0.5 * ONE))
    assert rows[3].cells[3] == number(gain, 3)
