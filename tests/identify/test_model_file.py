"""What a saved model makes of a recording before it predicts it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.api.saved import load_diagnosis
from harness.identify.model_file import observed_for, prepared_for
from harness.recording import load_case
from tests.identify.estimate.test_angle_noise import write

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"


def test_a_recording_is_read_as_those_of_the_diagnosis(tmp_path: Path) -> None:
    """Smooth its angle with the share of the noise and the roughness of the beam that the model was identified with."""
    case = load_case(write(tmp_path / "case", measured=None))
    recording = case.recordings["rec_01.csv"]
    model = load_diagnosis(SEED).record.model
    plain = observed_for(model, recording, case.sensors).drive
    told = model.model_copy(update={"noise_share": 0.3, "roughness": 10.0})
    drive = prepared_for(told, observed_for(told, recording, case.sensors)).drive
    np.testing.assert_array_equal(drive.states, plain.quieter(0.3).rougher(10.0).states)
    for other in (plain, plain.quieter(0.3), plain.rougher(10.0)):
        assert np.any(drive.states != other.states)
