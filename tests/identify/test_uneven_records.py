"""Positions that are rarer than angles, and readings that are stamped several at once, pose a problem all the same."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.rig import Rig
from harness.errors import InputError
from harness.identify import rig_completion
from harness.identify.estimate.rig import FittedRig
from harness.identify.pose import problem_of
from harness.recording import load_case
from harness.simulator import Experiment, Imperfections, Record, write_case

SPARSE = Experiment(rate=20.0, identify=2, predict=0, duration=12.0, seed=2)


def sparse(folder: Path) -> Path:
    """An unknown rig, whose log has 20 angles and five positions a second."""
    made = []
    for one in SPARSE.recordings():
        blank = np.arange(one.record.time.size) % 4 != 0
        position = np.where(blank, np.nan, one.record.position)
        made.append(replace(one, record=Record(one.record.time, one.record.angle, position)))
    write_case(folder, SPARSE, made)
    (folder / "rig.toml").write_text("", encoding="utf-8")
    return folder


@pytest.mark.slow
def test_an_unknown_rig_with_few_positions_is_completed(tmp_path: Path) -> None:
    """Find K and the level of the rig from every fourth position."""
    problem = problem_of(load_case(sparse(tmp_path / "case")))
    assert problem.rig.rolling_ratio == pytest.approx(Rig().rolling_ratio, rel=0.01)
    assert problem.rig.level_angle == pytest.approx(0.0, abs=1e-3)


def test_a_rig_that_cannot_be_estimated_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Say what to add to rig.toml where the estimate of the rig is no number."""
    nowhere = FittedRig(math.nan, math.nan, math.nan, np.full((3, 3), math.nan), math.nan, math.nan)
    monkeypatch.setattr(rig_completion, "fit_rig", lambda *_, **__: nowhere)
    with pytest.raises(InputError, match=r"do not determine .* Add what is known of it to rig\.toml"):
        problem_of(load_case(sparse(tmp_path / "case")))


def test_readings_stamped_together_leave_the_angle_as_certain(tmp_path: Path) -> None:
    """Give the input noise the floor of even stamps where those of readings taken evenly come in bunches."""
    floors = []
    for name, imperfections in (("even", None), ("bunched", Imperfections(bunch=4))):
        experiment = Experiment(identify=1, predict=0, duration=8.0, seed=2, imperfections=imperfections)
        write_case(tmp_path / name, experiment)
        floors.append(problem_of(load_case(tmp_path / name)).angle_floor)
    assert floors[1] == pytest.approx(floors[0], rel=0.05)


@pytest.mark.slow
def test_readings_taken_together_have_an_angle_error(tmp_path: Path) -> None:
    """Give the input noise a floor where a rig takes readings in bunches: above that of even ones, below any motion."""
    floors = []
    for name, taken in (("even", 40), ("together", 4)):  # of 40 readings at 1 kHz
        write_case(tmp_path / name, Experiment(rate=1000.0, identify=1, predict=0, duration=8.0, seed=2))
        file = tmp_path / name / "rec_01.csv"
        header, *rows = file.read_text(encoding="utf-8").splitlines()
        kept = [row for number, row in enumerate(rows) if number % 40 < taken]
        file.write_text("\n".join((header, *kept)) + "\n", encoding="utf-8")
        floors.append(problem_of(load_case(tmp_path / name)).angle_floor)
    assert floors[0] < floors[1] < 1e-2
