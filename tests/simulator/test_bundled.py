"""The bundled recording: what ships is what the rig writes, and it is the paper's protocol."""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from harness.simulator import Record, Run, bundled

FOLDER = bundled.case_folder()
BY_HAND = {"README.md", "tolerances.toml"}


@pytest.fixture(scope="module")
def experiments() -> dict[str, tuple[Run, Record]]:
    """All three experiments, anew."""
    return bundled.perform_all()


def test_committed_files_are_the_generated_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write every file anew, byte for byte: values are rounded far coarser than platforms differ."""
    monkeypatch.setattr(sys, "argv", ["bundled", "--out", str(tmp_path / "case")])
    bundled.main()
    written = {path.name: path.read_bytes() for path in (tmp_path / "case").iterdir()}
    committed = {path.name: path.read_bytes() for path in FOLDER.iterdir() if path.name not in BY_HAND}
    assert written == committed


def test_case_says_that_it_is_simulated() -> None:
    """Say so wherever somebody may look first: README, rig.toml and truth.json."""
    assert "simulated" in (FOLDER / "README.md").read_text(encoding="utf-8").splitlines()[0].lower()
    assert tomllib.loads((FOLDER / "rig.toml").read_text(encoding="utf-8"))["origin"].startswith("simulated")
    assert json.loads((FOLDER / "truth.json").read_text(encoding="utf-8"))["origin"].startswith("simulated")


def test_rig_file_does_not_give_the_truth_away() -> None:
    """Keep what is hidden out of rig.toml, and in truth.json."""
    rig = tomllib.loads((FOLDER / "rig.toml").read_text(encoding="utf-8"))
    assert "declared" not in rig
    truth = json.loads((FOLDER / "truth.json").read_text(encoding="utf-8"))
    found = {effect["name"]: effect["parameters"] for effect in truth["effects"]}
    assert found == {"rolling_resistance": {"coefficient": 0.0035}}


def test_ball_travels_as_in_the_paper(experiments: dict[str, tuple[Run, Record]]) -> None:
    """Start at 0.36 m, roll about 0.25 m out and back, tilt both ways by 3 to 4°, in the laser's range."""
    for run, record in experiments.values():
        assert run.position[0] == 0.36
        out = np.max(run.position - np.minimum.accumulate(run.position))
        back = np.max(np.maximum.accumulate(run.position) - run.position)
        # "about 0.25 m": targets lie 0.23–0.27 m apart, and a controller in haste overshoots by up to 0.03 m each time
        assert 0.23 < out < 0.33
        assert 0.23 < back < 0.33
        tilt = np.degrees(run.angle)
        assert 2.5 < np.max(tilt) < 4.0
        assert 2.5 < -np.min(tilt) < 4.0
        assert np.all(np.isfinite(record.position))
        assert 12.0 <= record.time[-1] <= 16.0


def test_ball_rests_briefly_and_never_slips(experiments: dict[str, tuple[Run, Record]]) -> None:
    """Have the ball truly at rest at times, rolling otherwise, always in contact."""
    for run, _ in experiments.values():
        assert 0.03 < np.mean(run.velocity == 0.0) < 0.3
        # rounding of velocities of about 1 m/s
        assert np.max(np.abs(run.slip)) < 1e-15
        assert np.nanmin(run.normal_force) > 0.3  # N; the weight is 0.70 N


def test_sensor_noise_is_as_declared(experiments: dict[str, tuple[Run, Record]]) -> None:
    """Let rig.toml's one figure for the laser hold over the recordings, and its resolution for the encoder."""
    sensors = tomllib.loads((FOLDER / "rig.toml").read_text(encoding="utf-8"))["sensors"]
    errors = np.concatenate([record.position - run.position[::100] for run, record in experiments.values()])
    # it stands for two figures and the time spent with each: 10 %
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(sensors["position_noise_m"], rel=0.1)
    counts = np.concatenate([record.angle for _, record in experiments.values()]) / sensors["angle_resolution_rad"]
    # twelve digits of the resolution, 40 counts
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-7)
