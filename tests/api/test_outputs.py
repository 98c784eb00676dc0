"""What a run leaves behind, in exactly the promised form."""

from __future__ import annotations

import csv
import hashlib
import json
import math
from pathlib import Path

import numpy as np
import pytest

from harness.api.outputs import manifest, metrics, to_json, trajectories, write_tables
from harness.comparison import Choices, Study, prepare, study
from harness.engines.catalogue import engine_of, parameters_of
from harness.recording import load_case
from harness.recording.case import BUNDLED

COLUMNS = [
    "time_s",
    "measured_m",
    "cum_m",
    "cum_linear_m",
    "cam_m",
    "friction_printed_m",
    "friction_printed_dissipative_m",
    "friction_coulomb_m",
    "friction_viscous_m",
]


@pytest.fixture(scope="module")
def one() -> Study:
    """The bundled recording through all models, and a PyBullet whose ball falls."""
    engine = engine_of("pybullet")
    falling = parameters_of(engine, {"contact_stiffness": 10.0, "contact_damping": 0.1})
    choices = Choices(lengths=(2.0,), level_angle="estimate")
    return study(prepare(load_case(BUNDLED), choices), [(engine, falling)])


@pytest.mark.slow
def test_trajectories_have_a_column_a_source(one: Study, tmp_path: Path) -> None:
    """Write the measurement and every source on the recording's stamps, to the micrometre, a fallen ball blank."""
    assert list(trajectories(one).columns) == [*COLUMNS, "pybullet_m"]
    write_tables(one, tmp_path)
    with (tmp_path / "trajectories.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [*COLUMNS, "pybullet_m"]
    assert {row["pybullet_m"] for row in rows} == {""}
    read = np.array([[float(row["time_s"]), float(row["cam_m"])] for row in rows])
    expected = np.column_stack((one.setting.time, one.run_of("cam", one.setting.horizons[0]).position))
    np.testing.assert_allclose(read, expected, atol=0.51e-6)


@pytest.mark.slow
def test_metrics_have_a_row_a_source_and_horizon(one: Study, tmp_path: Path) -> None:
    """Write every score once."""
    table = metrics(one)
    assert list(zip(table["source"], table["horizon"], strict=True)) == [
        *((source, horizon) for horizon in ("whole", "2 s") for source in one.sources if source != "pybullet"),
        ("pybullet", "whole"),
        ("pybullet", "2 s"),
    ]
    write_tables(one, tmp_path)
    with (tmp_path / "metrics.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    cam = next(row for row in rows if (row["source"], row["horizon"]) == ("cam", "whole"))
    assert float(cam["rms_error_mm"]) == pytest.approx(one.score_of("cam", one.setting.horizons[0]).rms_error_mm, 1e-6)


@pytest.mark.slow
def test_manifest_holds_what_repeats_the_run(one: Study) -> None:
    """Record hashes of every file that had a say, versions, settings, seed, failures and time."""
    facts = json.loads(to_json(manifest(one, command="harness run", wall_time=1.23456)))
    # α₀ was estimated, so that the second recording to identify from had a say.
    assert facts["inputs"] == {
        name: hashlib.sha256((BUNDLED / name).read_bytes()).hexdigest()
        for name in ("rec_01.csv", "rec_02.csv", "rig.toml")
    }
    assert {"harness", "python", "platform", "numpy", "numba", "pybullet"} <= facts["versions"].keys()
    assert "mujoco" not in facts["versions"]  # it did not run
    assert facts["settings"]["engines"]["pybullet"]["contact_stiffness"] == 10.0
    assert facts["settings"]["recording"] == "rec_01.csv"
    assert facts["settings"]["rig"]["level_angle"] == one.setting.rig.level_angle
    assert facts["settings"]["estimates"][0]["std"] == pytest.approx(one.setting.estimates[0].std)
    assert (facts["seed"], facts["wall_time_s"], facts["command"]) == (0, 1.235, "harness run")
    assert all(text.startswith("pybullet failed at t =") for text in facts["failures"])
    assert len(facts["failures"]) == 1 + len(one.setting.horizons[1].first)


def test_json_knows_no_infinity() -> None:
    """Write null for what is no number, and arrays' scalars as numbers."""
    text = to_json({"a": math.inf, "b": [np.float64(1.5), np.nan], "c": (np.int64(2), np.bool_(True)), 3: "α₀"})
    assert json.loads(text) == {"a": None, "b": [1.5, None], "c": [2, True], "3": "α₀"}
    assert "α₀" in text
