"""`harness tune` as a user types it: planted friction and level come out, and nothing comes out of nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.api.writing import written
from harness.recording.rig_changes import rig_changes
from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness

SETTINGS = ("--set", "mujoco.time_step=2e-3", "--free", "friction,solref_timeconst")
MU, LEVEL = 0.0085, 0.002


def case(folder: Path, seed: int, *, planted: bool) -> Path:
    """A simulated recording of 9 s at 25 Hz, of a ball that slips on a beam that is not level, or of neither."""
    hidden = {"contact_slip": {"friction_coefficient": MU}, "level_error": {"angle": LEVEL}} if planted else {}
    write_case(
        folder, Experiment(hidden=hidden, duration=9.0, rate=25.0, counts=4096, identify=1, predict=0, seed=seed)
    )
    return folder


@pytest.mark.slow
def test_planted_friction_and_level_come_out_and_can_be_given_on(harness: Harness, tmp_path: Path) -> None:
    """Find both, tell that the contact's time constant is not seen, and write a file that `run` takes."""
    rig = case(tmp_path / "rig", 501, planted=True)
    done = harness("tune", rig, *SETTINGS, "--out", "tuned")
    assert done.code == 0, done.err
    folder = done.folder / "tuned"
    told = json.loads((folder / "tuning.json").read_text(encoding="utf-8"))
    assert told["verdict"] == "tuned"
    # within three half-widths: one recording is one draw, and MuJoCo's friction law is not quite the plant's
    for name, truth in (("friction", MU), ("level_angle_rad", LEVEL)):
        low, high = told["parameters"][name]["interval"]
        assert abs(told["parameters"][name]["value"] - truth) < 1.5 * (high - low)
    assert not told["left_at_default"]["solref_timeconst"]["seen"]
    assert set(written(folder / "tuning.json")) == {"tuning.json", "tuning.html", "tuned.toml"}
    assert rig_changes(folder / "tuned.toml") == {"level_angle": told["parameters"]["level_angle_rad"]["value"]}
    run = harness("run", rig, "--engine", "mujoco", "--parameters", folder / "tuned.toml", "--out", "compared")
    assert run.code == 0, run.err
    used = json.loads((run.folder / "compared" / "manifest.json").read_text(encoding="utf-8"))["settings"]
    assert used["engines"]["mujoco"]["friction"] == told["parameters"]["friction"]["value"]
    assert used["rig"]["level_angle"] == told["parameters"]["level_angle_rad"]["value"]


@pytest.mark.slow
def test_nothing_is_tuned_where_nothing_acts(harness: Harness, tmp_path: Path) -> None:
    """Say so with exit code 1, and write no settings file."""
    done = harness("tune", case(tmp_path / "rig", 502, planted=False), *SETTINGS, "--out", "tuned", "--json")
    assert done.code == 1
    assert json.loads(done.out)["verdict"] == "nothing_to_tune"
    assert sorted(path.name for path in (done.folder / "tuned").iterdir()) == ["tuning.html", "tuning.json"]


def test_a_wrong_name_is_told_before_anything_is_computed(harness: Harness) -> None:
    """Name the mistake and what was meant."""
    done = harness("tune", "paper_protocol", "--free", "fricton")
    assert done.code == 2
    (error,) = done.errors
    assert "Did you mean 'friction'" in error
    done = harness("tune", "paper_protocol", "--free", ", ")
    assert done.code == 2
    assert "--free names no parameter" in done.err
