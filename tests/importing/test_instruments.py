"""Layouts of instruments: LabVIEW's segments, where oscilloscopes keep the sampling interval."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

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


@pytest.mark.parametrize(
    ("rows", "increment"),
    [
        ([["Sample Interval", "1.000000e-02"]], 0.01),
        ([["Sample Interval", "10 ms"]], 0.01),
        ([["Sampling Rate", "2 kHz"]], 5e-4),
        ([["Sample Rate (Hz)", "250"]], 4e-3),
        ([["X", "CH1", "Start", "Increment"], ["Sequence", "Volt", "-6.0", "1.0e-02"]], 0.01),
        ([["Sample Interval: 0.02"]], 0.02),
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


def test_units_of_several_channels_in_a_preamble(tmp_path: Path) -> None:
    """Take the units that Tektronix writes above the names, one a channel."""
    (group,) = read_file(made.tektronix(tmp_path / "a.csv")).groups
    assert [(one.name, one.unit) for one in group.signals] == [("TIME", "s"), ("CH1", "V"), ("CH2", "V")]
