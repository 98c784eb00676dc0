"""Layouts of instruments: LabVIEW's segments, where oscilloscopes keep the sampling interval."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.importing import Options, understand
from harness.importing.oscilloscope import preamble_of
from harness.importing.read import read_file
from tests.importing import made


@pytest.mark.parametrize(("columns", "segments"), [("One", 1), ("One", 3), ("No", 1), ("No", 2)])
def test_labview_files(tmp_path: Path, columns: str, segments: int) -> None:
    """Read X columns or Delta_X, and join segments of the same channels."""
    (group,) = read_file(made.labview(tmp_path / "a.lvm", columns, segments)).groups
    names = [one.name for one in group.signals]
    assert names[-2:] == ["Beam Angle", "Ball Position"]
    assert [one.unit for one in group.signals][-2:] == ["deg", "mm"]
    # Six decimals of a degree or a millimetre, rounded by half of the last.
    np.testing.assert_allclose(group.signals[-1].values, 1e3 * made.truth()[2], atol=5.1e-7)
    if columns == "One":
        assert group.time == "X_Value"
        np.testing.assert_allclose(group.signals[0].values, made.truth()[0], atol=5.1e-7)
    else:
        assert (group.time, group.step) == (None, 0.01)


def lvm(path: Path, columns: str, heads: list[str], bodies: list[str]) -> Path:
    """A measurement file of segments with these entries and rows."""
    text = f"LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\t{columns}\n***End_of_Header***\t\n\t\n"
    for head, body in zip(heads, bodies, strict=True):
        text += f"Channels\t2\n{head}X_Dimension\tTime\tTime\nDelta_X\t0.1\t0.1\n***End_of_Header***\n{body}\n"
    path.write_text(text)
    return path


def test_an_x_column_for_each_channel(tmp_path: Path) -> None:
    """Make a group of each pair of columns, without the blanks below the shorter one."""
    rows = "".join(
        f"{0.1 * at:.1f}\t{at}\t" + (f"{0.2 * at:.1f}\t{10 * at}\t\n" if at < 5 else "\t\t\n") for at in range(10)
    )
    body = "X_Value\tAngle\tX_Value\tDistance\tComment\n" + rows
    angle, distance = read_file(lvm(tmp_path / "a.lvm", "Multi", ["Y_Unit_Label\tdeg\tcm\n"], [body])).groups
    assert [(one.name, one.unit) for one in angle.signals] == [("X_Value", "s"), ("Angle", "deg")]
    assert [(one.name, one.unit) for one in distance.signals] == [("X_Value", "s"), ("Distance", "cm")]
    np.testing.assert_allclose(distance.signals[0].values, 0.2 * np.arange(5), atol=1e-12)
    np.testing.assert_array_equal(distance.signals[1].values, 10.0 * np.arange(5))
    assert (angle.time, distance.time, len(angle.rows)) == ("X_Value", "X_Value", 10)


@pytest.mark.parametrize(
    "second",
    [
        "X0\t1.5\t1.5\n",
        "Date\t2024/03/05\t2024/03/05\nTime\t12:00:01.5\t12:00:01.5\nX0\t0\t0\n",
        "Date\t2024/03/05\t2024/03/05\nTime\t12:00:01.5\t12:00:01.5\nX0\t1.5\t1.5\n",
    ],
)
def test_segments_with_a_gap_between_them(tmp_path: Path, second: str) -> None:
    """Give each segment its own start, by X0 or by date and time."""
    first = "Date\t2024/03/05\t2024/03/05\nTime\t12:00:00\t12:00:00\nX0\t0\t0\n"
    body = "X_Value\tAngle\tDistance\tComment\n" + "".join(f"\t{at}\t{at}\t\n" for at in range(5))
    (group,) = read_file(lvm(tmp_path / "a.lvm", "No", [first, second], [body, body])).groups
    assert group.time == group.signals[0].name
    np.testing.assert_allclose(
        group.signals[0].values, [*(0.1 * np.arange(5)), *(1.5 + 0.1 * np.arange(5))], atol=1e-12
    )


@pytest.mark.parametrize(
    ("second", "told"),
    [
        ("X0\t0\t0\n", r"row 26: by X0, Date and Time this segment begins 0\.5 s before the one above ends"),
        ("Date\t2024/03/05\nTime\t12:00:09\nX0\t3\t3\n", r"by X0 this segment begins 3 s .* Date and Time 9 s"),
    ],
)
def test_segments_whose_times_cannot_be_told(tmp_path: Path, second: str, told: str) -> None:
    """Refuse segments over each other, and starts that contradict each other."""
    first = "Date\t2024/03/05\nTime\t12:00:00\nX0\t0\t0\n"
    body = "X_Value\tAngle\tDistance\tComment\n" + "".join(f"\t{at}\t{at}\t\n" for at in range(5))
    with pytest.raises(InputError, match=told):
        read_file(lvm(tmp_path / "a.lvm", "No", [first, second], [body, body]))


@pytest.mark.parametrize(
    ("rows", "increment"),
    [
        ([["Sample Interval", "1.000000e-02"]], 0.01),
        ([["Sample Interval", "10 ms"]], 0.01),
        ([["Sampling Rate", "2 kHz"]], 5e-4),
        ([["Sample Rate (Hz)", "250"]], 4e-3),
        ([["X", "CH1", "Start", "Increment"], ["Sequence", "Volt", "-6.0", "1.0e-02"]], 0.01),
        ([["Sample Interval: 0.02"]], 0.02),
        ([["Abtastrate: 100,0 Hz"]], 0.01),
        ([["Sample rate: 1,000 Hz"]], None),
        ([["t0 =-6.0e+00"], ["tInc = 1.000000e-02"]], 0.01),
        ([["Record Length", "2500"]], None),
        ([["Sample Interval", "0"]], None),
        ([["Sample Interval", "three"]], None),
    ],
)
def test_the_sampling_interval_of_a_preamble(rows: list[list[str]], increment: float | None) -> None:
    """Find interval or rate under the names that instruments give them, in their units."""
    assert preamble_of(rows).increment == (None if increment is None else pytest.approx(increment, rel=1e-12))


def test_a_start_that_counts_samples(tmp_path: Path) -> None:
    """Begin at the start that Rigol writes, and drop the column that counts."""
    (group,) = read_file(made.rigol(tmp_path / "a.csv")).groups
    assert (group.step, group.start) == (0.01, -6.0)
    assert [one.name for one in group.signals] == ["CH1", "CH2"]


@pytest.mark.parametrize("stamped", [True, False])
def test_a_start_behind_the_names(tmp_path: Path, stamped: bool) -> None:
    """Read `t0` and `tInc` of Rigol's DHO series, with and without a column of times."""
    time, *_ = made.truth()
    file = tmp_path / "a.csv"
    head = ("Time(s)," if stamped else "") + "CH1(V),CH2(V),t0 =-6.000000e+00, tInc = 1.000000e-02,\n"
    rows = zip(time, *made.volts(), strict=True)
    file.write_text(head + "".join((f"{t - 6.0:.6e}," if stamped else "") + f"{a:.6e},{s:.6e}\n" for t, a, s in rows))
    chosen = Options(angle="CH1(V):0.05 rad/V", position="CH2(V):0.125 m/V-0.1")
    understood = understand([read_file(file)], chosen)
    np.testing.assert_allclose(understood.time, time - 6.0, atol=5e-6)
    np.testing.assert_allclose(understood.angle, made.truth()[1], atol=1e-6)


def test_numbers_of_channels_are_their_names(tmp_path: Path) -> None:
    """Take `1` for the channel that the file calls so, and not for the first column."""
    source = read_file(made.keysight(tmp_path / "a.csv"))
    understood = understand([source], Options(angle="1:0.05 rad/V", position="2:0.125 m/V-0.1"))
    # 1e-6 V of five decimals are 5e-8 rad, and rounding the time to 1e-6 s changes nothing.
    np.testing.assert_allclose(understood.angle, made.truth()[1], atol=1e-6)
    assert [line.column for line in understood.lines] == ["time", "CH1", "CH2"]


def test_units_of_several_channels_in_a_preamble(tmp_path: Path) -> None:
    """Take the units that Tektronix writes above the names, one a channel."""
    (group,) = read_file(made.tektronix(tmp_path / "a.csv")).groups
    assert [(one.name, one.unit) for one in group.signals] == [("TIME", "s"), ("CH1", "V"), ("CH2", "V")]
