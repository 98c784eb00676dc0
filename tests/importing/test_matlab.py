"""MAT-files of all versions, and objects that only MATLAB reads."""

from __future__ import annotations

import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io as sio

from harness.errors import InputError
from harness.importing.read import read_file


def element(kind: int, data: bytes) -> bytes:
    """A data element of the MAT-file format, padded to eight bytes."""
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def timeseries(name: bytes) -> bytes:
    """An object of class timeseries as MATLAB stores it: name, MCOS, class, and a reference to hidden data."""
    flags = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 6, 1)) + element(1, b"")
    reference = element(14, flags + element(6, np.array([0xDD000000, 2, 1, 1, 1, 1], "<u4").tobytes()))
    texts = b"".join(element(1, one) for one in (name, b"MCOS", b"timeseries"))
    return element(14, element(6, struct.pack("<II", 17, 0)) + texts + reference)


HEAD = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x01IM"


def test_objects_of_version_5_are_told_with_what_to_do(tmp_path: Path) -> None:
    """Name every timeseries, and the lines to type in MATLAB."""
    file = tmp_path / "a.mat"
    file.write_bytes(HEAD + timeseries(b"ball") + timeseries(b"beam"))
    with pytest.raises(InputError) as caught:
        read_file(file)
    assert "ball (timeseries), beam (timeseries)" in str(caught.value)
    assert "t = x.Time; y = x.Data; save(" in str(caught.value)


def test_objects_of_version_73_are_told(tmp_path: Path) -> None:
    """Likewise for HDF5, where the object is a reference into hidden data; what can be read is read."""
    file = tmp_path / "a.mat"
    with h5py.File(file, "w", userblock_size=512) as content:
        ball = content.create_dataset("ball", data=np.array([[0xDD000000, 2, 1, 1, 1, 1]], np.uint32))
        ball.attrs["MATLAB_class"], ball.attrs["MATLAB_object_decode"] = np.bytes_(b"timeseries"), 3
        content.create_dataset("t", data=np.arange(5.0)[None, :]).attrs["MATLAB_class"] = np.bytes_(b"double")
    made = read_file(file)
    assert [one.name for one in made.groups[0].signals] == ["t"]
    assert "ball (timeseries)" in made.notes[0]


@pytest.mark.parametrize("version", ["4", "5"])
def test_vectors_and_matrices(tmp_path: Path, version: str) -> None:
    """Take vectors, columns of a matrix, and rows of one that is wider than high, as To File writes it."""
    file = tmp_path / "a.mat"
    wide = np.arange(30.0).reshape(3, 10)
    sio.savemat(file, {"t": np.arange(10.0), "tall": wide.T, "wide": wide, "scalar": 3.0}, format=version)
    (group,) = read_file(file).groups
    names = [one.name for one in group.signals]
    assert names == ["t", "tall(1)", "tall(2)", "tall(3)", "wide(1)", "wide(2)", "wide(3)"]
    for at in range(3):
        np.testing.assert_array_equal(group.signals[1 + at].values, wide[at])
        np.testing.assert_array_equal(group.signals[4 + at].values, wide[at])


def test_structs_and_converted_timeseries(tmp_path: Path) -> None:
    """Read fields of structs, and structs with Time and Data as groups with a time."""
    file = tmp_path / "a.mat"
    time = np.arange(10.0)
    log = {"run": {"t": time, "x": time**2}, "ball": {"Time": time, "Data": 2.0 * time, "Name": "ball position"}}
    sio.savemat(file, {"log": log})
    groups = {group.name: group for group in read_file(file).groups}
    assert [one.name for one in groups["log.run"].signals] == ["log.run.t", "log.run.x"]
    assert groups["log.ball"].time == "Time"
    assert [one.name for one in groups["log.ball"].signals] == ["Time", "ball position"]


def test_signals_of_simulink_along_the_third_dimension(tmp_path: Path) -> None:
    """Read scalars that Simulink stores as 1-by-1-by-n."""
    file = tmp_path / "a.mat"
    values = np.arange(10.0).reshape(1, 1, 10)
    sio.savemat(file, {"out": {"time": np.arange(10.0)[:, None], "signals": {"values": values, "label": "angle"}}})
    (group,) = read_file(file).groups
    assert group.time == "time"
    np.testing.assert_array_equal(group.signals[1].values, np.arange(10.0))


def test_what_is_no_signal_is_left_out_and_said(tmp_path: Path) -> None:
    """Leave out complex numbers by name, and refuse a file without anything else."""
    file = tmp_path / "a.mat"
    sio.savemat(file, {"z": np.arange(5.0) * 1j, "t": np.arange(5.0)})
    assert read_file(file).notes == ("left out: z (complex numbers)",)
    sio.savemat(file, {"z": np.arange(5.0) * 1j})
    with pytest.raises(InputError, match="without numeric signals"):
        read_file(file)


@pytest.mark.parametrize("count", [10, 130, 200])
def test_a_file_that_was_cut_off(tmp_path: Path, count: int) -> None:
    """Say that it cannot be read, whatever is missing."""
    file = tmp_path / "a.mat"
    sio.savemat(file, {"t": np.arange(100.0)})
    file.write_bytes(file.read_bytes()[:count])
    with pytest.raises(InputError, match="MAT-file"):
        read_file(file)
