"""Predictions stay where the ball was recorded, unless the likelihood explains the recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.identify.estimate.band import AS_FORESEEN
from harness.identify.estimate.block_errors import block_errors
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.forecast import forecast
from harness.identify.estimate.predictions import as_predicted
from harness.identify.estimate.travel import ANYWHERE, Travel, travel_of
from harness.identify.estimate.window_errors import FARTHEST, window_errors
from harness.identify.model_file import model_record, read_model
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.windows import blocks_of, windows_of
from harness.identify.validation.baseline_comparison import AFTER, BEFORE, compare_with_baselines
from harness.identify.verdict import identify
from harness.recording import Sensors
from tests.posed import Posed, pose

NAN = np.nan


@pytest.fixture(scope="module")
def tilted(tmp_path_factory: pytest.TempPathFactory) -> Posed:
    """A rig whose level is wrong by 1.1°, which nobody declared."""
    return pose(tmp_path_factory.mktemp("tilted") / "case", 3, {"level_error": {"angle": 0.02}})


@pytest.fixture(scope="module")
def ignorant(tilted: Posed) -> Fit:
    """The fit that knows nothing of it, as its predictions are made."""
    return as_predicted(tilted.problem, fit(tilted.problem, Hypothesis(())))


def test_what_is_known_of_a_recording_widens_its_travel() -> None:
    """Keep positions between the ends, or a reading beyond them; nothing is kept of what has no ends."""
    travel, position = Travel(-0.1, 0.2), np.array([-1.0, 0.0, 1.0])
    np.testing.assert_array_equal(travel.kept(position, np.array([NAN, 0.05])), [-0.1, 0.0, 0.2])
    np.testing.assert_array_equal(travel.kept(position, np.array([NAN, 0.3])), [-0.1, 0.0, 0.3])
    np.testing.assert_array_equal(travel.kept(position, np.array([NAN])), [-0.1, 0.0, 0.2])
    np.testing.assert_array_equal(ANYWHERE.kept(position, np.array([0.3])), position)
    assert Travel.of(travel.ends) == travel
    assert Travel.of(ANYWHERE.ends) == ANYWHERE


def test_a_ball_that_would_leave_stays_at_the_end(tilted: Posed, ignorant: Fit) -> None:
    """Predict no position beyond those of the recordings with a model whose ball runs away, and so with less error."""
    problem, recording = tilted.problem, tilted.problem.recordings[0]
    known = np.where(recording.time < recording.time[0] + 2.0, recording.reading, NAN)
    free = forecast(problem, replace(ignorant, travel=ANYWHERE), recording, known).position
    kept = forecast(problem, ignorant, recording, known).position
    assert np.ptp(free) > 2.0 * np.ptp(kept)
    assert travel_of(problem.recordings) == ignorant.travel
    assert np.all((kept >= ignorant.travel.low) & (kept <= ignorant.travel.high))
    inside = (free > ignorant.travel.low) & (free < ignorant.travel.high)
    np.testing.assert_array_equal(kept[inside], free[inside])
    told = np.isfinite(recording.reading)
    assert np.std((kept - recording.reading)[told]) < np.std((free - recording.reading)[told])


def test_its_held_out_errors_are_those_of_such_predictions(tilted: Posed, ignorant: Fit) -> None:
    """Give each block the error of a fit and a travel that know nothing of it, not above those without any travel."""
    free = block_errors(tilted.problem, fit(tilted.problem, Hypothesis(())))
    kept = block_errors(tilted.problem, ignorant)
    assert len(kept) == len(blocks_of(tilted.problem.recordings))
    assert np.sqrt(np.mean(kept**2)) < np.sqrt(np.mean(free**2))


def test_all_sources_are_compared_within_it(tilted: Posed, ignorant: Fit) -> None:
    """Compare the model's own predictions, and baselines that stay where they do; with the same model before."""
    problem, base = tilted.problem, fit(tilted.problem, Hypothesis(()))
    free, kept = (compare_with_baselines(problem, base, found) for found in (base, ignorant))
    assert free is not None
    assert kept is not None
    assert tuple(kept.errors[AFTER]) == ignorant.forecast_errors
    np.testing.assert_array_equal(kept.errors[BEFORE], kept.errors[AFTER])
    assert kept.rms("constant_velocity") < free.rms("constant_velocity")
    assert kept.rms("at_rest") == free.rms("at_rest")


def test_what_comes_to_no_number_is_not_predicted_at_the_end(tilted: Posed, ignorant: Fit) -> None:
    """Count it as far away, although the travel ends nearby."""
    window = windows_of(tilted.problem.recordings)[0]
    lost = replace(ignorant, terms=ignorant.terms, process_noise=NAN)
    assert min(window_errors(tilted.problem, lost, [window])) > 0.9 * FARTHEST


def test_recordings_without_windows_have_a_travel(tilted: Posed, ignorant: Fit) -> None:
    """Keep predictions where nothing can be held out; there is no band but the foreseen one then."""
    short = tuple(replace(one, time=one.time[:260], reading=one.reading[:260]) for one in tilted.problem.recordings[:1])
    made = as_predicted(
        replace(tilted.problem, recordings=short), replace(ignorant, band=AS_FORESEEN, forecast_errors=())
    )
    assert made.travel == travel_of(short)
    assert (made.band, made.forecast_errors) == (AS_FORESEEN, ())


def test_it_is_read_from_the_file(tilted: Posed, ignorant: Fit) -> None:
    """Predict alike from the file, whose model says from where to where."""
    kept = model_record(tilted.problem, ignorant, tilted.case.sensors)
    assert kept.travel_m == ignorant.travel.ends
    _, found = read_model(kept, tilted.problem.recordings[0], "made")
    assert (found.travel, found.band) == (ignorant.travel, ignorant.band)
    free = model_record(tilted.problem, replace(ignorant, travel=ANYWHERE), Sensors())
    assert free.travel_m is None


def test_a_complete_model_predicts_a_ball_anywhere(plain: Posed) -> None:
    """Leave predictions alone where nothing is missing: a swing that is wider than any recorded is predicted."""
    assert identify(plain.problem).found.travel == ANYWHERE
