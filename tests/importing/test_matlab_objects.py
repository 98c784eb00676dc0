"""Objects of MATLAB and Simulink become signals with names, units and times."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matio.utils import MatlabOpaque, MatlabOpaqueArray

from harness.errors import InputError
from harness.importing import Group, read_file
from harness.importing.matlab import read_matlab
from tests.importing import made_matlab as mat

# What mat-io says when it writes durations, and of pandas when it is loaded.
pytestmark = [pytest.mark.filterwarnings("ignore:duration_to_mat"), pytest.mark.filterwarnings("ignore:.*infer_string")]
TIME = np.array([0.0, 0.1, 0.3, 0.6, 1.0])
RAMP = np.arange(5.0)


def groups(folder: Path, variables: dict[str, Any], version: str = "v7") -> dict[str, Group]:
    """What is read of a file with these variables, by name of the group."""
    return {one.name: one for one in read_file(mat.save(folder / "a.mat", variables, version)).groups}


def columns(group: Group) -> dict[str, list[float]]:
    """Values by name of the signal, without the time."""
    return {one.name: one.values.tolist() for one in group.signals if one.name != group.time}


def times(group: Group) -> list[float]:
    """The time of a group."""
    return next(one.values for one in group.signals if one.name == group.time).tolist()


def units(group: Group) -> dict[str, str]:
    """Units by name of the signal."""
    return {one.name: one.unit for one in group.signals}


@pytest.mark.parametrize("version", mat.VERSIONS)
def test_a_timeseries_has_name_unit_and_time(tmp_path: Path, version: str) -> None:
    """Take name, data, stamps and both units of a timeseries of either version."""
    ball = mat.timeseries(RAMP, TIME, name="ball", unit="cm", time_unit="minutes")
    made = groups(tmp_path, {"x": ball}, version)[""]
    assert columns(made) == {"ball": RAMP.tolist()}
    assert times(made) == TIME.tolist()
    assert units(made) == {"Time": "minutes", "ball": "cm"}


@pytest.mark.parametrize("version", mat.VERSIONS)
def test_even_times_are_expanded(tmp_path: Path, version: str) -> None:
    """Make the stamps of start, increment and length where no others are stored, as Simulink does."""
    made = groups(tmp_path, {"x": mat.timeseries(RAMP, uniform=(2.0, 0.5, 5))}, version)[""]
    assert times(made) == [2.0, 2.5, 3.0, 3.5, 4.0]


def test_times_of_2009_are_in_the_object(tmp_path: Path) -> None:
    """Take stamps from the timeseries itself, where MATLAB before 2010 stored them."""
    old = mat.timeseries(RAMP, uniform=(0.0, np.nan, 0.0), Time_=TIME[:, None])
    assert times(groups(tmp_path, {"x": old})[""]) == TIME.tolist()


@pytest.mark.parametrize("name", ["", "unnamed"])
def test_a_timeseries_without_a_name_has_that_of_its_variable(tmp_path: Path, name: str) -> None:
    """Use the variable's name where the series has none, or the one that MATLAB gives to all."""
    assert columns(groups(tmp_path, {"angle": mat.timeseries(RAMP, TIME, name=name)})[""]) == {"angle": RAMP.tolist()}


def test_a_unit_object_of_simulink_is_a_unit(tmp_path: Path) -> None:
    """Take the name of a `Simulink.SimulationData.Unit`."""
    unit = MatlabOpaque({"Name": mat.text("deg")}, f"{mat.SIMULINK}.Unit")
    assert units(groups(tmp_path, {"angle": mat.timeseries(RAMP, TIME, unit=unit)})[""])["angle"] == "deg"


def test_samples_of_several_values_are_numbered(tmp_path: Path) -> None:
    """Number the columns of a matrix, and what stands before the time in an array of three dimensions."""
    matrix = np.column_stack((RAMP, -RAMP))
    cube = np.arange(20.0).reshape(2, 2, 5)
    variables = {"m": mat.timeseries(matrix, TIME), "c": mat.timeseries(cube, TIME + 9.0)}
    read = read_file(mat.save(tmp_path / "a.mat", variables)).groups
    assert columns(read[0]) == {"m(1)": RAMP.tolist(), "m(2)": (-RAMP).tolist()}
    # MATLAB counts downwards first: c(2) is the second row of the first column.
    assert columns(read[1]) == {f"c({at + 1})": cube[at % 2, at // 2].tolist() for at in range(4)}


def test_flags_and_integers_are_numbers(tmp_path: Path) -> None:
    """Read logical and integer data."""
    variables = {"on": mat.timeseries(RAMP > 2.0, TIME), "n": mat.timeseries(RAMP.astype(np.int16), TIME)}
    made = columns(groups(tmp_path, variables)[""])
    assert made == {"on": [0.0, 0.0, 0.0, 1.0, 1.0], "n": RAMP.tolist()}


def test_series_with_one_time_share_their_rows(tmp_path: Path) -> None:
    """Put series side by side whose stamps differ by rounding only, and leave others with their own."""
    even = np.arange(5) / 10.0  # 0.3 differs in the last digit from 3 · 0.1
    variables = {
        "angle": mat.timeseries(RAMP, even),
        "x": mat.timeseries(RAMP, uniform=(0.0, 0.1, 5)),
        "other": mat.timeseries(RAMP, even + 0.01),
    }
    made = read_file(mat.save(tmp_path / "a.mat", variables)).groups
    assert [list(columns(one)) for one in made] == [["angle", "x"], ["other"]]


@pytest.mark.parametrize("version", mat.VERSIONS)
def test_a_dataset_has_a_column_an_element(tmp_path: Path, version: str) -> None:
    """Name the columns by the elements of `out.logsout`, and by their blocks where a signal has no name."""
    elements = [
        mat.signal("beam angle", mat.timeseries(RAMP, TIME, name="Gain1", unit="deg")),
        mat.signal("", mat.timeseries(-RAMP, TIME), block="model/Sub/Ball x//m"),
        mat.timeseries(2.0 * RAMP, TIME, name="direct"),
    ]
    out = mat.output(tout=TIME[:, None], logsout=mat.dataset(elements))
    made = groups(tmp_path, {"out": out}, version)
    assert columns(made["out.logsout"]) == {
        "beam angle": RAMP.tolist(),
        "Ball x/m": (-RAMP).tolist(),
        "direct": (2.0 * RAMP).tolist(),
    }
    assert units(made["out.logsout"])["beam angle"] == "deg"


def test_elements_with_times_of_their_own_stay_apart(tmp_path: Path) -> None:
    """Make a group for every time of a Dataset, with names that tell them apart."""
    elements = [mat.signal("x", mat.timeseries(RAMP, TIME)), mat.signal("x", mat.timeseries(RAMP, 2.0 * TIME))]
    made = read_file(mat.save(tmp_path / "a.mat", {"logsout": mat.dataset(elements)})).groups
    assert [list(columns(one)) for one in made] == [["x"], ["x (2)"]]
    assert [times(one) for one in made] == [TIME.tolist(), (2.0 * TIME).tolist()]


def test_a_bus_is_a_struct_of_signals(tmp_path: Path) -> None:
    """Read the signals of a bus in a group of its own."""
    bus = mat.struct(angle=mat.timeseries(RAMP, TIME), x=mat.timeseries(-RAMP, TIME))
    made = groups(tmp_path, {"logsout": mat.dataset([mat.signal("rig", bus)])})
    assert columns(made["logsout.rig"]) == {"angle": RAMP.tolist(), "x": (-RAMP).tolist()}


def test_a_dataset_before_2015_holds_its_elements_itself(tmp_path: Path) -> None:
    """Read a Dataset whose elements are a property of its own."""
    old = MatlabOpaque({"any": mat.struct(Name=mat.text(""), Elements=mat.cell(mat.timeseries(RAMP, TIME, name="x")))},
                       mat.DATASET)  # fmt: skip
    assert columns(groups(tmp_path, {"logsout": old})["logsout"]) == {"x": RAMP.tolist()}


def test_arrays_and_structs_of_objects(tmp_path: Path) -> None:
    """Read series in an array, in a struct and in a cell, and plain arrays beside them."""
    pair = np.empty((1, 2), dtype=object)
    pair[0, :] = mat.timeseries(RAMP, TIME), mat.timeseries(-RAMP, TIME)
    variables = {
        "a": MatlabOpaqueArray(pair, "timeseries"),
        "s": mat.struct(x=mat.timeseries(RAMP, TIME), t=TIME[:, None]),
        "c": mat.cell(mat.timeseries(RAMP, TIME)),
        "plain": RAMP,
    }
    made = read_file(mat.save(tmp_path / "a.mat", variables)).groups
    assert sorted((one.name, list(columns(one))) for one in made) == [
        ("", ["plain"]),
        ("a", ["a(1)", "a(2)"]),
        ("c", ["c{1}"]),
        ("s", ["s.t"]),
        ("s", ["x"]),
    ]


@pytest.mark.parametrize("version", mat.VERSIONS)
def test_a_timetable_has_the_columns_of_its_variables(tmp_path: Path, version: str) -> None:
    """Take row times that are durations, and dates as seconds since the first."""
    frame = pd.DataFrame({"angle": RAMP, "x": -RAMP}, index=pd.to_timedelta(TIME, unit="s"))
    dated = frame.set_index(pd.Timestamp("2024-05-01 12:00") + frame.index)
    made = groups(tmp_path, {"log": frame, "dated": dated}, version)
    for name in ("log", "dated"):
        assert columns(made[name]) == {"angle": RAMP.tolist(), "x": (-RAMP).tolist()}
        np.testing.assert_allclose(times(made[name]), TIME, atol=1e-9)


def test_a_logged_timetable_is_named_by_its_element(tmp_path: Path) -> None:
    """Name the one column of a timetable in a Dataset by its element, as Simulink calls them all Data."""
    frame = pd.DataFrame({"Data": RAMP}, index=pd.to_timedelta(TIME, unit="s"))
    made = groups(tmp_path, {"logsout": mat.dataset([mat.signal("angle", frame)])})
    assert columns(made["logsout"]) == {"angle": RAMP.tolist()}


def test_a_table_and_a_duration_are_columns(tmp_path: Path) -> None:
    """Read the columns of a table, and a vector of durations in seconds."""
    variables = {"log": pd.DataFrame({"t": TIME, "angle": RAMP}), "t": pd.to_timedelta(TIME, unit="s").to_numpy()}
    made = groups(tmp_path, variables)
    assert columns(made["log"]) == {"t": TIME.tolist(), "angle": RAMP.tolist()}
    np.testing.assert_allclose(columns(made[""])["t"], TIME, atol=1e-9)
    assert units(made[""]) == {"t": "s"}


def test_objects_need_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Say which extra to install where mat-io is missing, and read the plain arrays."""
    monkeypatch.setitem(sys.modules, "matio", None)
    path = mat.save(tmp_path / "a.mat", {"x": mat.timeseries(RAMP, TIME)})
    with pytest.raises(InputError, match=r"x \(timeseries\): .*pip install 'ball-beam-harness\[matlab\]'"):
        read_matlab(path)
    read = read_matlab(mat.save(tmp_path / "b.mat", {"x": mat.timeseries(RAMP, TIME), "t": TIME}))
    assert columns(read.groups[0]) == {"t": TIME.tolist()}
    assert "ball-beam-harness[matlab]" in read.notes[0]
