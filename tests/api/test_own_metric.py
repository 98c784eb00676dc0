"""`harness.compare` with metrics of the user's own, as functions."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import harness
from harness.metrics import RunComparison
from tests.acceptance.short import write_short_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short case."""
    return write_short_case(tmp_path_factory.mktemp("own_metric") / "case")


def largest(run: RunComparison) -> float:
    """The catalogue's max_error_m, in other words."""
    return float(np.max(np.abs(run.error)))


@pytest.mark.slow
def test_it_is_a_column_of_scores_file_and_summary(folder: Path, tmp_path: Path) -> None:
    """Agree with the catalogue's metric on the whole run, take the median of windows, and leave out NaN."""
    calls: list[float] = []

    def first_only(run: RunComparison) -> float:
        calls.append(run.time[0])
        return 7.0 if run.time[0] < 0.5 else math.nan

    metrics = {"largest_m": largest, "first_only": first_only}
    comparison = harness.compare(folder, engines=["mujoco"], windows=[1.0], metrics=metrics)
    scores = comparison.scores
    whole = scores[scores["horizon"] == "whole"]
    assert np.array_equal(whole["largest_m"], whole["max_error_m"])
    windowed = scores[scores["horizon"] == "1 s"]
    assert (windowed["windows"] > 1).all()
    assert (windowed["largest_m"] <= windowed["max_error_m"]).all()
    assert (scores["first_only"] == 7.0).all()  # the median of 7 and windows without a value
    assert max(calls) > 0.5
    written = pd.read_csv(comparison.save(tmp_path / "out") / "metrics.csv")
    # Written with seven digits.
    np.testing.assert_allclose(written["largest_m"], scores["largest_m"], rtol=1e-6)
    assert "largest_m" in str(comparison)


@pytest.mark.parametrize(
    ("metrics", "said"),
    [
        ({"Largest error": largest}, r"'Largest error' cannot be the name of a column; use lower case"),
        ({"rms_error_mm": largest}, r"the name 'rms_error_mm' is taken"),
        ({"horizon": largest}, r"the name 'horizon' is taken"),
        ({"largest_m": 3.0}, r"largest_m is 3\.0, and not a function"),
    ],
)
def test_what_cannot_be_a_column_is_refused(folder: Path, metrics: dict[str, Any], said: str) -> None:
    """Raise an error that says why, before anything is computed."""
    with pytest.raises(harness.InputError, match=said):
        harness.compare(folder, metrics=metrics)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda run: run.error, r"bad_m gives array\(.* for cum, horizon whole; return one number"),
        (lambda run: None, r"bad_m gives None for cum, horizon whole; return one number"),
        (lambda run: run.velocity, r"bad_m fails for cum, horizon whole: AttributeError: .*velocity"),
    ],
)
def test_a_bad_value_is_told(folder: Path, tmp_path: Path, function: Callable[[Any], Any], said: str) -> None:
    """Name metric, source and horizon, and write nothing."""
    with pytest.raises(harness.InputError, match=f"(?s){said}"):
        harness.compare(folder, engines=["mujoco"], windows=[1.0], metrics={"bad_m": function}, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
