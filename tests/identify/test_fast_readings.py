"""A rig that is recorded at 500 Hz: identified from means, predicted at every stamp."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import VISCOUS_DAMPING
from harness.identify.estimate.forecast import forecast
from harness.identify.model_file import model_record, observed_for, prepared_for, read_forecasting
from harness.identify.pose import problem_of
from harness.identify.verdict import Identification, identify
from harness.recording import Case, load_case
from harness.simulator import Experiment, write_case

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
