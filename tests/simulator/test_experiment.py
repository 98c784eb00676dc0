"""Whole experiments: one seed one truth, effects that show, the style of the cases, folders that load."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analytic.motion import FloatArray, State
from harness.errors import InputError
from harness.recording import load_case
from harness.simulator import Experiment, SimulatedRecording, simulate, truth, write_case
from harness.simulator.protocol import turned_before
from tests.simulator.acting import EACH, EACH_UNLISTED

DECLARED = {"rolling_resistance": {"coefficient": 0.002}}


def arrays(recording: SimulatedRecording) -> tuple[FloatArray, ...]:
    """Everything that was recorded and everything that was true."""
    return recording.record.angle, recording.record.position, recording.position, recording.noiseless


@pytest.mark.slow
def test_same_seed_same_case() -> None:
    """Repeat a case to the bit with its seed; change moves and noise with another, and from recording to recording."""
    first, again, other = (Experiment(seed=seed, hidden=DECLARED).recordings() for seed in (3, 3, 4))
    for one, two in zip(first, again, strict=True):
        for mine, yours in zip(arrays(one), arrays(two), strict=True):
            np.testing.assert_array_equal(mine, yours)
    assert len({one.record.position.tobytes() for one in (*first, *other)}) == 6
    assert len({one.seed for one in (*first, *other)}) == 6


def test_recording_is_sampled_as_asked() -> None:
    """Record 16 s at 100 Hz from rest, or what else was asked for, to the sensors' resolutions."""
    usual = Experiment(seed=1, identify=1, predict=0).recordings()[0]
    assert len(usual.record.time) == 1601
    assert usual.record.time[-1] == pytest.approx(16.0)
    assert usual.velocity[0] == 0.0
    asked = Experiment(seed=1, identify=1, predict=0, rate=50.0, duration=5.0, start=0.31, counts=4096)
    one = asked.recordings()[0]
    np.testing.assert_allclose(one.record.time, np.arange(251) / 50.0, atol=1e-12)
    assert one.position[0] == 0.31
    counts = one.record.angle / (2 * np.pi / 4096)
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-9)
    tenths = one.record.position / 1e-4
    np.testing.assert_allclose(tenths, np.rint(tenths), atol=1e-6)


@pytest.mark.parametrize("noise", [0.3e-3, 0.6e-3])
def test_noise_is_as_declared(noise: float) -> None:
    """Scatter about the noiseless channel by the declared noise and the rounding, about the angle by a count's."""
    one = Experiment(seed=2, identify=1, predict=0, position_noise=noise, angle_noise=3e-4).recordings()[0]
    expected = np.hypot(noise, 1e-4 / np.sqrt(12))
    # standard error of a standard deviation from 1601 samples: 1.8 %; four of them
    assert np.std(one.record.position - one.noiseless) == pytest.approx(expected, rel=0.07)
    expected = np.hypot(3e-4, 2 * np.pi / 40_000 / np.sqrt(12))
    assert np.std(one.record.angle - one.angle) == pytest.approx(expected, rel=0.07)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*EACH, *EACH_UNLISTED])
def test_every_effect_shows_in_its_case(name: str) -> None:
    """Move the ball, or its record, otherwise than the declared rig would under the same measured angle."""
    listed = name in EACH
    values = {name: EACH[name]} if listed else {name: EACH_UNLISTED[name]}
    experiment = Experiment(
        seed=6, identify=1, predict=0, duration=10.0, **{"hidden" if listed else "unlisted": values}
    )
    seed = experiment.seeds[0]
    run, record = experiment.carried_out(seed)
    bare = simulate(
        experiment.plant(seed, {}), run.shaft_motion, State(float(run.position[0]), 0.0), experiment.duration
    )
    error = np.sqrt(np.mean((record.position - bare.position[::50]) ** 2))
    assert error > 3 * experiment.position_noise


@pytest.mark.slow
def test_open_loop_makes_the_moves_of_the_declared_rig() -> None:
    """Turn the beam as it would be turned without the hidden effect, and say so where the ball then runs off."""
    settings = {"seed": 7, "identify": 1, "predict": 0, "duration": 4.0, "closed_loop": False}
    hidden = {"viscous_damping": {"coefficient": 0.05}}
    with_effect = Experiment(**settings, hidden=hidden).recordings()[0]
    without = Experiment(**settings).recordings()[0]
    np.testing.assert_array_equal(with_effect.angle, without.angle)
    assert np.max(np.abs(with_effect.position - without.position)) > 1e-3
    tilted = Experiment(**{**settings, "duration": 8.0}, hidden={"level_error": {"angle": 0.02}})
    with pytest.raises(InputError, match="Close the loop"):
        tilted.recordings()


def test_ball_lies_differently_in_every_recording() -> None:
    """Draw φ₀ anew for each recording, evenly over the circle."""
    phases = np.array([turned_before(seed) for seed in range(400)])
    # the mean of 400 unit vectors is 0.05 long; 0.15 in one of 10,000 draws
    assert np.abs(np.mean(np.exp(1j * phases))) < 0.15


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"declared": DECLARED, "hidden": DECLARED}, "both declared and hidden"),
        ({"hidden": {"gust": EACH_UNLISTED["gust"]}}, "in no catalogue"),
        ({"unlisted": DECLARED}, "not an unlisted effect"),
        ({"hidden": {"level": {"angle": 0.1}}}, "level_error"),
    ],
)
def test_contradictory_experiment_is_refused(wrong: dict[str, dict[str, dict[str, float]]], message: str) -> None:
    """Refuse what cannot be meant, before anything is recorded."""
    with pytest.raises(InputError, match=message):
        Experiment(**wrong)


def test_impossible_rig_is_refused() -> None:
    """Say which rig cannot exist when an effect makes one."""
    with pytest.raises(InputError, match="rolling_radius"):
        Experiment(hidden={"rolling_radius": {"radius": 0.02}}).recordings()


def test_case_folder_loads(tmp_path: Path) -> None:
    """Write a case that the loader reads without a warning and that does not give the truth away."""
    experiment = Experiment(seed=8, declared=DECLARED, hidden={"channel_delay": {"delay": 0.06}}, angle_noise=1e-4)
    recordings = write_case(tmp_path / "case", experiment)
    case = load_case(tmp_path / "case")
    assert case.identify == ("rec_01.csv", "rec_02.csv")
    assert case.predict == ("rec_03.csv",)
    assert [(one.name, one.parameters) for one in case.declared] == [("rolling_resistance", {"coefficient": 0.002})]
    assert case.rig.complete() == experiment.rig
    assert case.sensors.angle_noise == 1e-4
    assert not [finding for finding in case.findings if finding.severity == "warning"]
    assert "delay" not in (tmp_path / "case" / "rig.toml").read_text(encoding="utf-8")
    for one, name in zip(recordings, case.recordings, strict=True):
        loaded = case.recordings[name]
        known = loaded.known
        np.testing.assert_allclose(loaded.angle, one.record.angle, atol=0.5e-7)  # half a unit of the last digit
        np.testing.assert_allclose(loaded.position[known], one.record.position[known], atol=1e-12)
    predicted = case.recordings["rec_03.csv"]
    np.testing.assert_array_equal(predicted.known, predicted.time <= 1.5)
    true = pd.read_csv(tmp_path / "case" / "rec_03_true.csv")
    np.testing.assert_allclose(true.ball_position_m, recordings[2].noiseless, atol=0.5e-6)


def test_hidden_pivot_is_not_declared(tmp_path: Path) -> None:
    """Leave open where the pivot is when that is what has to be found, and only then."""
    write_case(tmp_path, Experiment(seed=8, identify=1, predict=0, hidden={"eccentric_pivot": {"eccentricity": 0.1}}))
    assert load_case(tmp_path).rig.unknown == ("eccentricity",)


def test_truth_reads_back(tmp_path: Path) -> None:
    """Recover from truth.json and rig.toml the experiment that was made, and make it again."""
    made = Experiment(
        seed=9,
        identify=1,
        declared=DECLARED,
        hidden={"level_error": {"angle": 0.004}},
        unlisted={"gust": EACH_UNLISTED["gust"]},
    )
    write_case(tmp_path, made)
    told = json.loads((tmp_path / "truth.json").read_text(encoding="utf-8"))
    assert told == json.loads(json.dumps(truth(made)))
    assert told["unlisted"] == "time"
    assert told["unlisted_effects"][0]["depends_on"] == ["time"]

    def effects(key: str) -> dict[str, dict[str, float]]:
        return {one["name"]: one["parameters"] for one in told[key]}

    read = Experiment(
        seed=told["seed"],
        identify=len(tomllib.loads((tmp_path / "rig.toml").read_text(encoding="utf-8"))["recordings"]["identify"]),
        declared=effects("declared"),
        hidden=effects("effects"),
        unlisted=effects("unlisted_effects"),
    )
    assert read == made


def style(time: FloatArray, angle: FloatArray, position: FloatArray) -> dict[str, float]:
    """Figures that describe how a recording was made."""
    return {
        "nearest place": float(np.min(position)),
        "farthest place": float(np.max(position)),
        "angle RMS": float(np.std(angle)),
        "largest angle": float(np.max(np.abs(angle))),
        "angle rate RMS": float(np.std(np.gradient(angle, time))),
        "position noise": float(np.std(np.diff(position, 4)) / np.sqrt(70.0)),
    }


@pytest.mark.slow
def test_recordings_have_the_style_of_the_cases(shared: Path) -> None:
    """Lie, in every figure's mean, within the spread of the recordings of the cases."""
    theirs = []
    for file in sorted(shared.glob("cases/*/rec_0[12].csv")):
        table = pd.read_csv(file)
        theirs.append(style(*(table[c].to_numpy() for c in ("time_s", "beam_angle_rad", "ball_position_m"))))
    ours = [
        style(one.record.time, one.record.angle, one.record.position)
        for seed in range(6)
        for one in Experiment(seed=seed, hidden=DECLARED, predict=0).recordings()
    ]
    for figure in theirs[0]:
        values = np.array([one[figure] for one in theirs])
        assert values.min() <= np.mean([one[figure] for one in ours]) <= values.max(), figure
