"""The period of a force along the beam, from one linear step."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.spline_term import Regressor
from harness.identify.selection.period import period_of
from harness.identify.selection.spline_terms import visited
from tests.posed import pose

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("wavelength", [0.04, 0.075, 0.11])
def test_the_period_of_a_ripple_is_seen_before_it_is_fitted(tmp_path: Path, wavelength: float) -> None:
    """Be near enough for a fit: wrong by less than a quarter of a wave over the places that the ball visits."""
    ripple = {"ripple_force": {"force": 0.006, "wavelength": wavelength}}
    problem = pose(tmp_path / "case", 4, unlisted=ripple).problem
    low, high = visited(problem, Regressor.POSITION)
    period = period_of(problem.coarse, fit(problem, Hypothesis(())), low, high)
    assert abs((high - low) / period - (high - low) / wavelength) < 0.25
