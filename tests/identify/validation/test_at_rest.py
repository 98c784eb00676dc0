"""Predictions of the next second against a ball that stays where it was last read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.identify.estimate.fit import fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.validation.at_rest import AgainstRest, against_rest
from harness.recording import load_case
from tests.posed import pose
from tests.shared_data import RECORDINGS


def test_a_model_that_knows_the_rig_beats_a_ball_at_rest(tmp_path: Path) -> None:
    """Predict a rig without hidden effects far better; the other stays at its last reading before each second."""
    posed = pose(tmp_path / "case", 0, {})
    made = against_rest(posed.problem, fit(posed.problem, Hypothesis(())))
    assert made is not None
    assert not made.worse
    assert made.model < 0.3 * made.at_rest
    squares = []
    for one in posed.problem.recordings:
        time = one.time - one.time[0]
        for begin in np.arange(2.0, time[-1] - 1.0 + 1e-6):
            first, last = np.searchsorted(time, (begin, begin + 1.0))
            squares.append((one.reading[first:last] - one.reading[first - 1]) ** 2)
    assert made.at_rest == pytest.approx(np.sqrt(np.mean(np.concatenate(squares))), rel=1e-3)


@pytest.mark.slow
@pytest.mark.skipif(not RECORDINGS.is_dir(), reason="the folder ../shared is absent")
def test_a_declared_model_that_lacks_much_does_not() -> None:
    """Predict the Quanser rig worse than a ball at rest would be, as long as what it lacks is not found."""
    problem = problem_of(load_case(RECORDINGS / "quanser_bb01"))
    made = against_rest(problem, fit(problem, Hypothesis(problem.unknown)))
    assert made is not None
    assert made.worse


def test_a_prediction_that_is_no_number_is_worse() -> None:
    """Call a model worse that ran away to no number."""
    assert AgainstRest(float("nan"), 0.02).worse
