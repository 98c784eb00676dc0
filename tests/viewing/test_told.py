from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.comparison import Choices, prepare
from harness.comparison.setting import Setting
from harness.engines.catalogue import engine_of
from harness.identify.record import DiagnosisRecord
from harness.identify.record.answer import BaselinesRecord
from harness.identify.record.notices import FailureRecord
from harness.recording import load_case
from harness.viewing.playback import Playback
from harness.viewing.runs import run_without
from harness.viewing.told import told_of
from tests.acceptance.short import write_short_case

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"
BLOCKS = 4  # of 3 s that two recordings of 8 s have, each after two known seconds: from 2 s and from 5 s, to 8 s


@pytest.fixture(scope="module")
def setting(tmp_path_factory: pytest.TempPathFactory) -> Setting:
    """Two recordings of 8 s, the second of which is shown."""
    case = write_short_case(tmp_path_factory.mktemp("told") / "case", duration=8.0)
    return prepare(load_case(case), Choices(recording="rec_02.csv"))


def playback_of(setting: Setting, begin: float = 0.0, lifted_off: float | None = None) -> Playback:
    """The run of MuJoCo from `begin` [s] on."""
    run = replace(run_without(setting, engine_of("mujoco"), {}), lifted_off=lifted_off)
    known = setting.ball.trusted
    stamps, reading = setting.time[known], setting.recording.position[known]
    return Playback("mujoco", (run,), stamps, reading, begin, float(setting.time[-1]), setting.case.simulated)


def record_of(setting: Setting) -> DiagnosisRecord:
    """A diagnosis of this case that held out its blocks."""
    record = DiagnosisRecord.model_validate_json(SEED.read_bytes())
    hashes = {name: one.sha256 for name, one in setting.case.recordings.items()}
    inputs = record.problem.inputs.model_copy(update={"hashes": hashes})
    errors = {"before": (0.011, 0.012, 0.013, 0.014), "after": (0.001, 0.002, 0.003, None)}
    rms = dict.fromkeys(errors, 0.01)
    baselines = BaselinesRecord(
        known_s=2.0, ahead_s=3.0, blocks=BLOCKS, rms_m=rms, errors_m=errors, blocks_won={}, better_by_m={}
    )
    problem = record.problem.model_copy(update={"inputs": inputs})
    return record.model_copy(update={"baselines": baselines, "problem": problem})


def test_held_out_blocks_are_told_when_they_begin(setting: Setting) -> None:
    """Tell those of the shown recording alone, with both errors."""
    assert setting.case.recordings.keys() == {"rec_01.csv", "rec_02.csv"}
    told = [one for one in told_of(setting, playback_of(setting), record_of(setting)) if "held-out block" in one.text]
    assert [one.time for one in told] == pytest.approx([2.0, 5.0])
    # Its windows begin at 0, 1 and 2 s; the last ends before 2 + 5 s, at 100 readings a second.
    assert "block 3 of 4: 2.00 s to 6.99 s" in told[0].text
    assert "13.0 mm without the effects and 3.0 mm with them" in told[0].text
    assert "14.0 mm without the effects and not known with them" in told[1].text


def test_a_block_that_has_begun_is_told_at_the_begin(setting: Setting) -> None:
    """Tell at the begin of what is shown what began before it and goes on."""
    told = told_of(setting, playback_of(setting, begin=4.0), record_of(setting))
    assert [one.time for one in told if "held-out block" in one.text] == pytest.approx([4.0, 5.0])
    assert all(one.time >= 4.0 for one in told)


def test_a_diagnosis_of_other_recordings_has_no_blocks_here(setting: Setting) -> None:
    """Say that its held-out windows are not known where a recording is another."""
    record = record_of(setting)
    hashes = dict.fromkeys(record.problem.inputs.hashes, "0" * 64)
    inputs = record.problem.inputs.model_copy(update={"hashes": hashes})
    other = record.model_copy(update={"problem": record.problem.model_copy(update={"inputs": inputs})})
    told = told_of(setting, playback_of(setting), other)
    assert not any("held-out block" in one.text for one in told)
    assert [one.level for one in told if "held-out windows" in one.text] == ["WARN"]


def test_failures_of_the_diagnosis_are_errors(setting: Setting) -> None:
    """Tell each at the begin."""
    failure = FailureRecord(part="engine", name="dart", message="is gone", where="")
    record = record_of(setting).model_copy(update={"failures": (failure,)})
    told = told_of(setting, playback_of(setting), record)
    assert [(one.time, one.text) for one in told if one.level == "ERROR"] == [
        (0.0, "diagnosis: engine dart failed: is gone")
    ]


def test_a_lift_off_is_told_when_it_happens(setting: Setting) -> None:
    """Warn at its time, and say that runs are simulated."""
    told = told_of(setting, playback_of(setting, lifted_off=1.5), None)
    assert [(one.time, one.level) for one in told if "lifts off" in one.text] == [(1.5, "WARN")]
    assert all("simulated" in one.text for one in told if "mujoco" in one.text)
    assert [one.time for one in told] == sorted(one.time for one in told)


def test_outliers_are_counted(setting: Setting) -> None:
    """Warn of readings that no ball is drawn at."""
    trusted = setting.ball.trusted.copy()
    trusted[np.array([30, 40])] = False
    spiked = replace(setting, ball=replace(setting.ball, trusted=trusted))
    told = told_of(spiked, playback_of(spiked), None)
    assert [one.text for one in told if one.level == "WARN"] == [
        "2 readings of the recording are outliers, which no ball is drawn at"
    ]
