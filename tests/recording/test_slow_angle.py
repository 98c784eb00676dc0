"""A beam that turns far between the readings of its angle is told, and nothing else is taken for one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import Case, load_case
from harness.recording.slow_angle import between_readings
from tests.recording.hand_turned import Hand, write_hand_turned
from tests.recording.simulated import write
from tests.recording.stopped import Run, stopped

CODES = {"slow-angle", "undersampled-angle"}


def told(case: Case) -> set[str]:
    """Which of the two codes are found in a case."""
    return {one.code for one in case.findings} & CODES


@pytest.mark.parametrize(
    ("corner", "size", "rate", "codes"),
    [
        (1.0, 0.1, 15.0, set()),
        (2.0, 0.15, 100.0, set()),
        (2.0, 0.15, 10.0, {"slow-angle"}),
        (4.0, 0.15, 6.0, {"undersampled-angle"}),
    ],
)
def test_the_faster_the_beam_the_more_readings_it_takes(
    tmp_path: Path, corner: float, size: float, rate: float, codes: set[str]
) -> None:
    """Say nothing of a beam that is followed, warn of one whose turns are half seen, stop before one that is lost."""
    case = load_case(write_hand_turned(tmp_path / "case", Hand(corner=corner, size=size, rate=rate), seed=1))
    assert told(case) == codes
    assert any(one.stops for one in case.findings) == ("undersampled-angle" in codes)


def test_the_message_says_what_to_do(tmp_path: Path) -> None:
    """Name the recording, its rate, how much is not seen, and the remedy."""
    case = load_case(write_hand_turned(tmp_path / "case", Hand(corner=4.0, size=0.15, rate=6.0), seed=1))
    first = next(str(one) for one in case.findings if one.code == "undersampled-angle")
    for part in ("rec_01.csv", "6 times a second", "% of the swing", "at least three times as often"):
        assert part in first


def test_noise_of_a_fast_sensor_is_no_motion(tmp_path: Path) -> None:
    """Say nothing where the angle scatters by a few milliradians a hundred times a second."""
    hand = Hand(corner=1.0, size=0.02, rate=100.0, angle_noise=3e-3)
    assert not told(load_case(write_hand_turned(tmp_path / "case", hand, seed=2)))


def test_declared_noise_is_no_motion(tmp_path: Path) -> None:
    """Warn of an angle that scatters by a degree, which may be motion, but not where rig.toml calls it noise."""
    hand = Hand(corner=1.0, size=0.1, rate=40.0, angle_noise=0.02)
    folder = write_hand_turned(tmp_path / "case", hand, seed=3)
    assert told(load_case(folder)) == {"slow-angle"}
    rig = (folder / "rig.toml").read_text()
    (folder / "rig.toml").write_text(rig.replace("[sensors]", "[sensors]\nangle_noise_rad = 0.02"))
    assert not told(load_case(folder))


def test_a_command_that_answers_the_readings_is_known_in_between(tmp_path: Path) -> None:
    """Say nothing of a controller's command that jumps from row to row, however far."""
    made = stopped(Run(swing=0.05, noise=3e-2, commanded=True), seed=1).columns
    between = between_readings(made["time_s"], made["beam_angle_rad"])
    assert between.share > 0.9  # of a measured angle, this would stop a diagnosis
    assert between.way > 0.03
    assert not told(load_case(write(tmp_path / "rec_01.csv", made)))


def test_stamps_of_a_bunch_tell_nothing() -> None:
    """Leave out readings whose stamps are much closer than others: a cubic through them is nothing but their noise."""
    time = np.arange(400) * 0.05
    bunched = time - 0.049 * (np.arange(400) % 2)
    angle = 0.05 * np.sin(time)
    assert between_readings(time, angle).share < 0.01
    assert between_readings(bunched, angle + 1e-3 * np.random.default_rng(0).standard_normal(400)) == (0.0, 0.0)


def test_a_beam_at_rest_has_no_swing() -> None:
    """Nothing can be off from what does not move."""
    assert between_readings(np.arange(100) * 0.1, np.full(100, 0.02)) == (0.0, 0.0)


@pytest.mark.slow
def test_no_shared_rig_is_too_slow(shared: Path) -> None:
    """All measured and simulated rigs are sampled fast enough, or have a command."""
    for group in ("cases", "recordings"):
        for one in sorted((shared / group).iterdir()):
            assert not told(load_case(one)), one.name
