"""The filter with coloured reading noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import acting
from harness.identify.estimate.fit import PROCESS_NOISE
from harness.identify.filter.run import deviance, innovations, run_filter
from harness.identify.problem.hypothesis import NOTHING, Terms
from harness.identify.problem.problem import WHITE, Colour, Problem
from tests.coloured_record import NOISE, TIME, coloured_problem
from tests.posed import Posed

_LAG = Terms((), (acting("position_lag", {"time_constant": 0.05}),), np.zeros(0), None)
_SLIP = Terms((), (acting("contact_slip", {"friction_coefficient": 0.02}),), np.zeros(0), None)


@pytest.mark.parametrize("added", [NOTHING, _LAG, _SLIP], ids=["ball", "lagging sensor", "slip"])
def test_noise_that_is_forgotten_between_readings_is_white(plain: Posed, added: Terms) -> None:
    """Find the likelihood of white noise of the same variance where the correlation time is a microsecond."""
    problem = plain.problem
    forgotten = replace(problem, colour=Colour(0.7, 1e-6))
    # e^(−10⁴) is 0: only rounding is left, of thousands of terms
    assert deviance(forgotten, added, PROCESS_NOISE) == pytest.approx(deviance(problem, added, PROCESS_NOISE), rel=1e-9)


@pytest.mark.slow
def test_innovations_of_coloured_readings_are_white_with_their_colour_only(tmp_path: Path) -> None:
    """Leave nothing of the correlation between neighbouring readings, and the variance that was foreseen."""
    problem = coloured_problem(tmp_path / "case", 1)
    ratios = {}
    for name, colour in (("white", WHITE), ("coloured", Colour(0.999, TIME))):
        known = replace(problem, reading_variance=NOISE**2, colour=colour)
        innovation, variance = innovations(known, NOTHING, 1e-12)
        ratios[name] = innovation / np.sqrt(variance)
    n = len(ratios["white"])
    correlations = {name: float(np.mean(z[1:] * z[:-1]) / np.mean(z * z)) for name, z in ratios.items()}
    # 4 standard deviations of a correlation and of a mean square of n white numbers; the steps of 0.1 mm, which
    # the share leaves out, add 5 % to a variance of (1 − 0.8²) (0.3 mm)²
    assert abs(correlations["coloured"]) < 4.0 / np.sqrt(n)
    assert abs(np.mean(ratios["coloured"] ** 2) - 1.05) < 0.05 + 4.0 * np.sqrt(2.0 / n)
    assert correlations["white"] > 0.3


def test_a_run_without_readings_is_that_of_the_ball(plain: Posed) -> None:
    """Predict the ball's position where readings end, not what the noise was when they did."""
    problem, recording = plain.problem, plain.problem.recordings[0]
    reading = np.where(recording.time < recording.time[0] + 2.0, recording.reading, np.nan)

    def ends_at(one: Problem) -> float:
        return float(run_filter(one, recording, NOTHING, 1e-10, reading=reading).recorded[-1])

    shifted = replace(problem, colour=Colour(0.5, 1e-6))
    assert ends_at(shifted) == pytest.approx(ends_at(problem), abs=1e-9)
