"""Whole diagnoses: of rigs made here, and of the cases handed out with the project."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from harness.identify.diagnosis import diagnose
from harness.identify.estimate.fit import fit
from harness.identify.estimate.forecast import forecast
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording
from harness.identify.verdict import Verdict
from harness.preparation.recordings import observe
from harness.recording import load_case
from tests.posed import pose
from tests.shared_data import CASES

pytestmark = pytest.mark.slow
needs_shared = pytest.mark.skipif(not CASES.is_dir(), reason="the folder ../shared is absent")
FOLDERS = sorted(path.parent for path in CASES.glob("*/truth.json"))
ROLLING = {"rolling_resistance": {"coefficient": 0.004}}
LEVEL = {"level_error": {"angle": -0.0025}}
AS_LARGE = {"level_error": {"angle": 0.004}}


def truth_of(folder: Path) -> dict[str, Any]:
    """What acts in a case."""
    return json.loads((folder / "truth.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("hidden", [{}, ROLLING, {**ROLLING, **LEVEL}], ids=["none", "rolling", "rolling+level"])
def test_hidden_effects_are_named(tmp_path: Path, hidden: dict[str, dict[str, float]]) -> None:
    """Name exactly what is hidden: nothing, one effect, or both of two."""
    found = diagnose(pose(tmp_path / "case", 0, hidden).problem)
    assert found.verdict is (Verdict.EFFECT if hidden else Verdict.NONE)
    assert {one.name for one in found.effects} == set(hidden)


def test_a_level_error_as_large_as_the_resistance(tmp_path: Path) -> None:
    """Name both where together they resist one way only, although directional resistance comes close to that."""
    found = diagnose(pose(tmp_path / "case", 0, {**ROLLING, **AS_LARGE}).problem)
    assert {one.name for one in found.effects} == {"rolling_resistance", "level_error"}


def test_a_gust_is_in_no_catalogue(tmp_path: Path) -> None:
    """Say that something unlisted acts which depends on time."""
    gust = {"gust": {"force": 0.01, "start": 5.0, "end": 8.0}}
    found = diagnose(pose(tmp_path / "case", 0, unlisted=gust).problem)
    assert found.verdict is Verdict.UNLISTED
    assert found.found.terms.spline is not None
    assert str(found.found.terms.spline.depends) == "time"


@needs_shared
@pytest.mark.parametrize("name", ["rolling", "null_plain", "two_rolling_level", "unlisted_wind"])
def test_cases_are_diagnosed(name: str) -> None:
    """Name what the case hides, or what the unlisted force depends on."""
    truth = truth_of(CASES / name)
    found = diagnose(problem_of(load_case(CASES / name)))
    assert {one.name for one in found.effects} == {one["name"] for one in truth["effects"]}
    spline = found.found.terms.spline
    assert (None if spline is None else str(spline.depends)) == truth["unlisted"]


@needs_shared
@pytest.mark.parametrize("folder", [one for one in FOLDERS if not truth_of(one)["unlisted"]], ids=lambda one: one.name)
def test_cases_are_fitted_and_forecast(folder: Path) -> None:
    """Hold the truth within 95 % intervals, and predict the blank part of the third recording."""
    truth, case = truth_of(folder), load_case(folder)
    problem = problem_of(case)
    found = fit(problem, Hypothesis(tuple(one["name"] for one in truth["effects"])))
    for one in truth["effects"]:
        for key, value in one["parameters"].items():
            reach = 1.96 * found.deviations()[one["name"], key]
            assert abs(found.values()[one["name"], key] - value) < reach, key
            assert reach < 0.03 * abs(value), key  # what the prediction below is allowed for it
    record = PreparedRecording.of(observe(case.recordings["rec_03.csv"], case.sensors, problem.rig))
    made = forecast(problem, found, record, record.reading)
    true = pd.read_csv(folder / "rec_03_true.csv")["ball_position_m"].to_numpy()
    error = np.sqrt(np.mean((made.position - true)[np.isnan(record.reading)] ** 2))
    # Twice what the true model reaches, since the start has to be estimated too, 1 mm for the position's noise in it,
    # and 3 % of what the effect did, for the error of its value.
    heldout = truth["heldout"]
    assert error < 2.0 * heldout["oracle_rms_m"] + 1e-3 + 0.03 * heldout["before_rms_m"]
