"""Objects that cannot be read: one message with file, variable, reason and what to type in MATLAB."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matio.utils import MatlabOpaque

from harness.api.importing import import_recording
from harness.errors import InputError
from harness.importing import matlab_process, read_file
from tests.importing import made
from tests.importing import made_matlab as mat

TIME = np.arange(5.0)
TIMESERIES = "for a timeseries x, t = x.Time; y = x.Data; save('plain.mat','t','y')"
LOGGED = "for a logged signal, x = out.logsout.get('NAME').Values"
RECORDS = MatlabOpaque({"Version_": mat.scalar(4.0)}, f"{mat.SIMULINK}.Storage.MatFileDatasetStorage")


def refusal(path: Path) -> str:
    """The message by which a file is refused."""
    with pytest.raises(InputError) as caught:
        read_file(path)
    return str(caught.value)


@pytest.mark.parametrize("version", mat.VERSIONS)
@pytest.mark.parametrize(
    ("series", "reason"),
    [
        (mat.timeseries(TIME, TIME[:4]), "its time has 4 values and its data are 5-by-1"),
        (mat.timeseries(TIME, uniform=(0.0, 0.1, 1e15)), "its time has 1e+15 values and its data are 5-by-1"),
        (mat.timeseries(TIME, uniform=(0.0, np.nan, 5)), "its time has neither stamps nor a start and an increment"),
        (mat.timeseries(TIME, uniform=(0.0, -0.1, 5)), "its time has neither stamps nor a start and an increment"),
        (mat.timeseries(TIME, uniform=(0.0, 0.1, np.nan)), "it holds no time"),
        (mat.timeseries(TIME, TIME, TimeInfo=mat.EMPTY), "it holds no time"),
        (mat.timeseries(np.empty((0, 1)), []), "it holds no data"),
        (mat.timeseries(TIME * 1j, TIME), "its data are no real numbers"),
        (mat.timeseries(TIME, TIME, Data_=mat.text("five")), "its data are no real numbers"),
        (mat.timeseries(TIME[:2], TIME[:2]), "its data are 2-by-1; at least 3 samples of at most 64 signals are read"),
        (mat.timeseries(np.ones((5, 65)), TIME), "its data are 5-by-65; at least 3 samples of at most 64 signals"),
    ],
)
def test_a_timeseries_that_does_not_fit_together(tmp_path: Path, version: str, series: Any, reason: str) -> None:
    """Say what is wrong with it, and the line that writes plain arrays."""
    path = mat.save(tmp_path / "a.mat", {"ball": series}, version)
    message = refusal(path)
    assert message.startswith(f"{path}: ball (timeseries): {reason}")
    assert message.endswith(f"type in MATLAB: {TIMESERIES}.")


@pytest.mark.parametrize(
    ("variables", "reason", "typed"),
    [
        ({"log": mat.dataset([])}, "log (Simulink.SimulationData.Dataset): it holds no elements", LOGGED),
        (
            {"log": MatlabOpaque({"any": mat.struct(Name=mat.text(""), Storage=RECORDS)}, mat.DATASET)},
            "in version 7.3 Simulink keeps it in records of its own. Save it with save(FILE, 'NAME', '-v7')",
            LOGGED,
        ),
        (
            {"log": pd.DataFrame({"word": ["a", "b", "c"]}, index=pd.to_timedelta([0, 1, 2], unit="s"))},
            "log (timetable): it has 3 rows and 0 columns of numbers",
            "for a timetable x, t = seconds(x.Time - x.Time(1)); y = x.NAME",
        ),
        (
            {"own": MatlabOpaque({"Data_": TIME[:, None]}, "lab.Rig")},
            "own (lab.Rig): no timeseries, timetable, table or Dataset",
            "save('plain.mat','t','y')",
        ),
    ],
    ids=["empty", "records", "words", "own class"],
)
def test_other_objects(tmp_path: Path, variables: dict[str, Any], reason: str, typed: str) -> None:
    """Name the class and the reason."""
    message = refusal(mat.save(tmp_path / "a.mat", variables))
    assert reason in message
    assert typed in message


def test_what_can_be_read_is_read(tmp_path: Path) -> None:
    """Read one series and say of the other that it was left out, and why."""
    variables = {"ball": mat.timeseries(TIME, TIME), "beam": mat.timeseries(TIME, TIME[:4])}
    read = read_file(mat.save(tmp_path / "a.mat", variables))
    assert [one.name for one in read.groups[0].signals] == ["Time", "ball"]
    assert read.notes[0].startswith("left out: beam (timeseries): its time has 4 values")


@pytest.mark.parametrize("version", mat.VERSIONS)
def test_objects_within_themselves_end(tmp_path: Path, version: str) -> None:
    """Refuse Datasets that hold each other many times over, whose parts would be without number."""
    log: Any = mat.timeseries(TIME, TIME)
    for _ in range(6):
        log = mat.dataset([log] * 8)
    assert "more than 10000 parts" in refusal(mat.save(tmp_path / "a.mat", {"log": log}, version))


@pytest.mark.parametrize("name", ["logsout.mat", "log73.mat"])
@pytest.mark.parametrize("part", [0.001, 0.01, 0.3, 0.7, 0.999])
def test_a_file_that_was_cut_off_leaves_nothing(tmp_path: Path, name: str, part: float) -> None:
    """Refuse a file of which a part is missing with one message, and write nothing."""
    path = made.FILES[name][0](tmp_path / name)
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])
    with pytest.raises(InputError) as caught:
        import_recording(path, out=tmp_path / "case")
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "case").exists()


def test_a_file_without_the_data_of_its_objects(tmp_path: Path) -> None:
    """Refuse a file whose header does not say where the data of its objects are."""
    path = mat.save(tmp_path / "a.mat", {"ball": mat.timeseries(TIME, TIME)})
    content = path.read_bytes()
    path.write_bytes(content[:116] + bytes(8) + content[124:])
    assert "ball (timeseries): the data it refers to are missing or damaged" in refusal(path)


@pytest.mark.parametrize("variable", [mat.timeseries(TIME, TIME), TIME[:, None]], ids=["object", "plain"])
def test_a_type_that_does_not_exist(tmp_path: Path, variable: Any) -> None:
    """Refuse a file on which the libraries that read it crash, and read the next one."""
    path = mat.save(tmp_path / "a.mat", {"ball": variable}, compressed=False)
    content = path.read_bytes()
    doubles, size = 9, TIME.nbytes
    tag = struct.pack("<II", doubles, size)
    assert tag in content
    path.write_bytes(content.replace(tag, struct.pack("<II", 0, size)))
    assert "cannot be read as a MAT-file" in refusal(path)
    path.write_bytes(content)
    assert read_file(path).groups[0].signals[-1].values.tolist() == TIME.tolist()


def test_reading_that_does_not_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give up a file that takes too long, and read it where there is time."""
    path = mat.save(tmp_path / "a.mat", {"t": TIME})
    with monkeypatch.context() as patch:
        patch.setattr(matlab_process, "_started", None)  # a process that has yet to start takes longer than that
        patch.setattr(matlab_process, "LONGEST", 0.0)
        assert "or took more than 0 s" in refusal(path)
    assert read_file(path).groups[0].signals[0].name == "t"


def test_paths_are_those_of_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read a file by a path that is relative, wherever the one before was read from."""
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(mat.save(tmp_path / name / f"{name}.mat", {"t": TIME}).parent)
        assert read_file(Path(f"{name}.mat")).path == Path(f"{name}.mat")


def test_text_with_the_name_of_a_mat_file(tmp_path: Path) -> None:
    """Say that it is text, and what to do."""
    file = tmp_path / "log.mat"
    file.write_text("# Created by Octave 8.4\n# name: t\n# type: matrix\n 0\n 1\n")
    with pytest.raises(InputError, match=r"text, and no MAT-file\. Rename it to \.csv"):
        read_file(file)
