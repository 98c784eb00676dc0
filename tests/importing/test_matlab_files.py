"""Timetables and tables that MATLAB itself wrote."""

from __future__ import annotations

import hashlib
import tomllib
from pathlib import Path

import numpy as np
import pytest

from harness.importing import Group, read_file

FOLDER = Path(__file__).parent / "matlab_files"
DAY = 86400.0


def groups(name: str) -> dict[str, Group]:
    """Groups of a file by name."""
    return {one.name: one for one in read_file(FOLDER / name).groups}


def values(group: Group) -> dict[str, list[float]]:
    """Values by name of the signal."""
    return {one.name: one.values.tolist() for one in group.signals}


def test_the_files_are_those_of_the_distribution() -> None:
    """Keep the files as they were published."""
    listed = tomllib.loads((FOLDER / "VERSION.toml").read_text(encoding="utf-8"))["sha256"]
    kept = {one.name: hashlib.sha256(one.read_bytes()).hexdigest() for one in FOLDER.glob("*.mat")}
    assert kept == listed


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("timetable_datetime", {"Time": [0.0, DAY, 2.0 * DAY], "data1": [1.0, 2.0, 3.0]}),
        ("timetable_duration", {"Time": [10.0, 20.0, 30.0], "data1": [1.0, 2.0, 3.0]}),
        ("timetable_from_starttime_duration", {"Time": [10.0, 11.0, 12.0], "data1": [1.0, 2.0, 3.0]}),
        ("timetable_from_sample_rate", {"Time": [0.0, 1e-4, 2e-4], "data1": [1.0, 2.0, 3.0]}),
        ("timetable_var_names", {"Time": [0.0, DAY, 2.0 * DAY], "Pressure": [1.0, 2.0, 3.0]}),
        ("table_numeric", {"Var1": [1.1, 2.2, 3.3], "Var2": [4.4, 5.5, 6.6]}),
        ("table_time", {"Time": [0.0, DAY, 2.0 * DAY], "Duration": [30.0, 60.0, 90.0]}),
    ],
)
def test_tables_and_timetables(name: str, expected: dict[str, list[float]]) -> None:
    """Read dates, durations, sampling rates and numbers as MATLAB's script set them."""
    found = values(groups("test_tables_v7.mat")[name])
    assert found.keys() == expected.keys()
    for column, numbers in expected.items():
        np.testing.assert_allclose(found[column], numbers, rtol=1e-12)


def test_units_of_a_timetable() -> None:
    """Take the unit that was set in `Properties.VariableUnits`."""
    (unit,) = [one.unit for one in groups("test_tables_v7.mat")["timetable_with_attrs"].signals if one.name == "data1"]
    assert unit == "m/s"


def test_what_is_no_signal_is_said() -> None:
    """Say which variables of the file were left out, the empty timetable with its reason."""
    notes = " ".join(read_file(FOLDER / "test_tables_v7.mat").notes)
    assert "timetable_empty (timetable): it has 0 rows" in notes
    assert "cat_scalar (Categorical)" in notes


@pytest.mark.parametrize(
    ("name", "times"),
    [
        ("timetable_step_millis", [0.0, 0.01, 0.02]),
        ("timetable_sample_rate", [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]),
    ],
)
def test_row_times_that_are_a_start_and_a_step(name: str, times: list[float]) -> None:
    """Expand row times of which the file has only the step or the rate; mat-io rounds them to nanoseconds."""
    np.testing.assert_allclose(values(groups("test_timetable_steps_v7.mat")[name])["Time"], times, atol=1e-9)


def test_a_timetable_of_version_73() -> None:
    """Read a timetable that MATLAB R2026b saved as HDF5."""
    assert values(groups("test_timetablev8_v73.mat")["timetable_v8"]) == {
        "Time": [0.0, DAY, 2.0 * DAY],
        "data1": [1.0, 2.0, 3.0],
    }
