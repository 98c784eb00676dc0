"""Designs: which runs there are."""

from __future__ import annotations

import hashlib
import itertools
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from tests.acceptance.short import write_short_case
from tests.own_scenes import flat_track
from tests.sweeps.made import planned

GRID = """
sources = ["mujoco", "cam"]
recordings = "all"
time_step = [2e-3, 1e-3]
[mujoco]
friction = { low = 0.01, high = 1.0, scale = "log", levels = 3 }
condim = [3, 4]
[rig]
mass_kg = [0.05, 0.07]
"""


def test_a_grid_has_every_combination_once(tmp_path: Path) -> None:
    """Cross all values of a source, on each recording; CAM has no factors of an engine."""
    plan = planned(tmp_path, GRID)
    runs = [plan.run(number) for number in range(len(plan))]
    assert len(plan) == 2 * (2 * 3 * 2 * 2 + 2)
    assert [one.number for one in runs] == list(range(len(plan)))
    first = [one for one in runs if one.source == "mujoco" and one.recording == plan.recordings[0][1]]
    found = {tuple(one.values[name] for name in plan.names) for one in first}
    # Ends are exact; the middle of a logarithmic range is the geometric mean, to rounding.
    frictions = {one.values["mujoco.friction"] for one in first}
    assert {0.01, 1.0} < frictions
    assert sorted(frictions)[1] == pytest.approx(0.1, rel=1e-12)
    assert found == set(itertools.product([2e-3, 1e-3], frictions, [3, 4], [0.05, 0.07]))
    cam = [one for one in runs if one.source == "cam"]
    assert {tuple(one.values) for one in cam} == {("rig.mass_kg",)}


def test_a_latin_hypercube_has_one_point_in_every_stratum(tmp_path: Path) -> None:
    """Sample ranges, cross listed values with all samples, the same for the same seed and others for another."""
    text = """
    sources = ["mujoco"]
    design = "latin_hypercube"
    size = 8
    seed = {seed}
    time_step = [2e-3, 1e-3]
    [mujoco]
    friction = {{ low = 0.2, high = 1.0 }}
    """
    plan, again = planned(tmp_path, text.format(seed=3)), planned(tmp_path, text.format(seed=3))
    assert len(plan) == 16
    values = np.array([plan.run(number).values["mujoco.friction"] for number in range(16)])
    assert sorted(((values[:8] - 0.2) / 0.1).astype(int)) == list(range(8))
    assert (values[8:] == values[:8]).all()
    assert [plan.run(number) for number in range(16)] == [again.run(number) for number in range(16)]
    other = planned(tmp_path, text.format(seed=4))
    assert plan.run(0).values != other.run(0).values


def test_indices_take_a_run_a_factor_and_two_a_base_sample(tmp_path: Path) -> None:
    """Sample N (D + 2) points within the ranges."""
    plan = planned(
        tmp_path,
        """
        sources = ["cam"]
        design = "sobol"
        size = 16
        indices = true
        [rig]
        mass_kg = { low = 0.05, high = 0.09 }
        level_angle_rad = { low = -0.01, high = 0.01 }
        """,
    )
    assert len(plan) == 16 * 4
    values = [plan.run(number).values for number in range(len(plan))]
    assert all(0.05 <= one["rig.mass_kg"] <= 0.09 and abs(one["rig.level_angle_rad"]) <= 0.01 for one in values)


def test_batches_share_a_recording_and_a_source(tmp_path: Path) -> None:
    """Hand out every missing run once, in order."""
    plan = planned(tmp_path, GRID)
    missing = [number for number in range(len(plan)) if number % 3]
    batches = list(plan.batches(missing, 5))
    assert [one.number for batch in batches for one in batch] == missing
    assert all(len({(one.recording, one.source) for one in batch}) == 1 and len(batch) <= 5 for batch in batches)


def test_a_recording_that_is_not_there_is_refused(tmp_path: Path) -> None:
    """Say which there are."""
    with pytest.raises(InputError, match=r"no recording 'rec_9.csv'; it has .*\.csv"):
        planned(tmp_path, 'recordings = ["rec_9.csv"]')


def test_a_scene_of_the_users_own_is_an_input(tmp_path: Path) -> None:
    """Have the SHA-256 of the scene's file among the inputs, so that a sweep is not resumed with another scene."""
    write_short_case(tmp_path / "rig")
    scene, rig = tmp_path / "rig" / "plank.xml", tmp_path / "rig" / "rig.toml"
    scene.write_text(flat_track(), encoding="utf-8")
    with rig.open("a", encoding="utf-8") as file:
        file.write('[scene]\nmjcf = "plank.xml"\nbeam_joint = "bearing"\nball = "marble"\ndirection = -1\n')
    text = 'sources = ["mujoco"]\ntime_step = [2e-3]\n'
    plan = planned(tmp_path, text)
    assert plan.inputs["rig: plank.xml"] == hashlib.sha256(scene.read_bytes()).hexdigest()
    assert scene in plan.files
    scene.write_text(flat_track() + "<!-- -->", encoding="utf-8")
    assert planned(tmp_path, text).inputs != plan.inputs
