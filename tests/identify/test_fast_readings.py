"""A rig that is recorded at 500 Hz: identified from means, predicted at every stamp."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analytic.effects import VISCOUS_DAMPING
from harness.identify.estimate.forecast import filtered, forecast
from harness.identify.model_file import model_record, observed_for, prepared_for, read_forecasting, with_noise_of
from harness.identify.pose import problem_of
from harness.identify.verdict import Identification, identify
from harness.preparation.readings import UsedReadings
from harness.recording import Case, Recording, load_case, load_recording
from harness.simulator import Experiment, write_case

pytestmark = pytest.mark.slow

TRUE = 0.02  # [N s/m]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Two recordings of 16 s, and one to predict, of a rig with viscous friction."""
    folder = tmp_path_factory.mktemp("fast") / "case"
    hidden = {VISCOUS_DAMPING.name: {"coefficient": TRUE}}
    write_case(folder, Experiment(hidden=hidden, predict=1, rate=500.0, seed=3))
    return load_case(folder)


@pytest.fixture(scope="module")
def identified(case: Case) -> Identification:
    """What is found."""
    return identify(problem_of(case))


def test_seven_readings_make_one(case: Case) -> None:
    """And the noise of one is that of the mean: about 1/√7 of a reading's, which is white."""
    problem = problem_of(case)
    recorded = sum(len(case.recordings[name].time) for name in case.identify)
    assert problem.readings == pytest.approx(recorded / 7, abs=len(case.identify))
    single = np.mean([problem.observed(case.recordings[name], case.sensors).noise ** 2 for name in case.identify])
    # 2300 means tell their variance within 3 %, rounding included; four of these.
    assert problem.reading_variance == pytest.approx(single / 7, rel=0.12)


def test_what_is_missing_is_found(identified: Identification) -> None:
    """The damping alone, with an interval of a twentieth of it at the most, which misses it by no more than itself."""
    (effect,) = identified.effects
    assert effect.name == VISCOUS_DAMPING.name
    found = effect.parameters["coefficient"]
    width = found.high - found.low
    assert width < 0.05 * TRUE
    assert abs(found.value - TRUE) < width  # four standard errors


def test_a_prediction_has_all_stamps_and_the_noise_of_means(case: Case, identified: Identification) -> None:
    """Every stamp, also where no position is known, from as many means a second as the model was fitted to."""
    kept = model_record(identified.problem, identified.found, case.sensors)
    (name,) = case.predict
    recording = case.recordings[name]
    prepared = prepared_for(kept, observed_for(kept, recording, case.sensors))
    known = int(recording.usable.sum())
    assert known < 0.2 * len(recording.time)
    assert int(np.isfinite(prepared.reading).sum()) == pytest.approx(known / 7, abs=1)
    problem, found = read_forecasting(kept, prepared, "model")
    predicted = forecast(problem, found, prepared, prepared.reading)
    np.testing.assert_array_equal(predicted.time, recording.time)
    assert np.isfinite(predicted.position).all()


def every_tenth(recording: Recording, folder: Path) -> Recording:
    """The recording at a tenth of its rate, 50 Hz."""
    file = folder / "slow.csv"
    pd.read_csv(recording.path).iloc[::10].to_csv(file, index=False)
    return load_recording(file)


def test_a_recording_at_another_rate_has_the_noise_of_its_own_readings(
    case: Case, identified: Identification, tmp_path: Path
) -> None:
    """A model of means of seven does not take single readings for as exact; its own readings stay as exact as they are.

    The share of the variance that innovations of a filter over 16 seconds show is 1: of 800 readings, within four
    times √(2/800); taken for means, they would show seven times the variance.
    """
    kept = model_record(identified.problem, identified.found, case.sensors)
    assert kept.readings_in_mean == 7
    whole = case.recordings[case.identify[0]]
    same = observed_for(kept, whole, case.sensors)
    assert with_noise_of(kept, same.used) == kept
    slow = observed_for(kept, every_tenth(whole, tmp_path), case.sensors)
    told = with_noise_of(kept, slow.used)
    assert (told.readings_in_mean, slow.used.every) == (1, 1)
    assert told.reading_variance_m2 == pytest.approx(7 * kept.reading_variance_m2)
    prepared = prepared_for(told, slow)
    problem, found = read_forecasting(told, prepared, "model")
    run = filtered(problem, found, prepared, prepared.reading)
    judged = run.innovation[prepared.judged] ** 2 / run.innovation_variance[prepared.judged]
    assert np.mean(judged) == pytest.approx(1.0, abs=4 * np.sqrt(2 / len(judged)))


def test_what_neighbours_share_no_mean_takes_away(case: Case, identified: Identification) -> None:
    """Of a variance of 4 mm² of means of seven, of which a half is coloured: 2 mm² stay beside 14 of white noise."""
    kept = model_record(identified.problem, identified.found, case.sensors)
    colour = kept.colour.model_copy(update={"share": 0.5, "time_s": 0.05})
    kept = kept.model_copy(update={"reading_variance_m2": 4e-6, "colour": colour})
    told = with_noise_of(kept, UsedReadings(1, np.zeros(1), 1.0))
    assert told.reading_variance_m2 == pytest.approx(16e-6)
    assert told.colour.share == pytest.approx(2 / 16)
    assert told.colour.time_s == 0.05
