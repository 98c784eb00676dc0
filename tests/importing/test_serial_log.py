"""Logs of a serial port: labels in every line, and the clock of a monitor before it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.importing import read_file
from harness.importing.signals import Group


def group_of(file: Path, *lines: str) -> Group:
    """The only group of a file of these lines."""
    file.write_text("\n".join((*lines, "")))
    (group,) = read_file(file).groups
    return group


@pytest.mark.parametrize(
    "line",
    ["x:{0},th:{1}", "x:{0}\tth:{1}", "x: {0}; th: {1};", "x={0} th={1}", "x = {0}, th = {1}", "x:{0} cm th:{1} deg"],
)
def test_labels_in_every_line(tmp_path: Path, line: str) -> None:
    """Take labels for names, whatever parts them, and what stands behind a value for its unit."""
    group = group_of(tmp_path / "a.txt", *(line.format(0.5 * at, -at) for at in range(6)))
    units = [" [cm]", " [deg]"] if "cm" in line else ["", ""]
    assert [one.name for one in group.signals] == [f"x{units[0]}", f"th{units[1]}"]
    np.testing.assert_array_equal(group.signals[0].values, 0.5 * np.arange(6))
    np.testing.assert_array_equal(group.signals[1].values, -np.arange(6))


def test_decimal_commas_between_semicolons(tmp_path: Path) -> None:
    """Read a comma as the decimal mark where semicolons part the values."""
    group = group_of(tmp_path / "a.txt", *(f"x:{at},5;th:-0,{at}" for at in range(1, 5)))
    np.testing.assert_array_equal(group.signals[0].values, [1.5, 2.5, 3.5, 4.5])


def test_lines_without_labels_are_left_out(tmp_path: Path) -> None:
    """Say how many lines have none, keep the numbers of the others, and leave blank what a broken line lacks."""
    (tmp_path / "a.txt").write_text("Init done\nx:1,th:2,u:9\n\nx:2,th:3\nERROR 7\nx:3,th:4,u:8\nx:4,th:5,u:7\n")
    source = read_file(tmp_path / "a.txt")
    (group,) = source.groups
    assert source.notes == ("2 lines without labels left out",)
    assert group.rows.tolist() == [2, 4, 6, 7]
    np.testing.assert_array_equal(group.signals[2].values, [9.0, np.nan, 8.0, 7.0])


def test_entries_of_a_preamble_are_no_labels(tmp_path: Path) -> None:
    """Read the table below a few lines of labels."""
    group = group_of(tmp_path / "a.csv", "kp:4,kd:2", "kp:4,kd:2", "t,x", *(f"{at},{2 * at}" for at in range(8)))
    assert [one.name for one in group.signals] == ["t", "x"]


@pytest.mark.parametrize(("head", "own"), [("angle,x", False), ("t_ms,x", True)])
def test_the_clock_of_a_monitor(tmp_path: Path, head: str, own: bool) -> None:
    """Take the times at which lines were received, unless the lines tell their own."""
    rows = (f"23:59:59.{at}00 -> {100 * at},{at}" for at in range(8))
    group = group_of(tmp_path / "a.txt", f"23:59:58.900 -> {head}", *rows)
    assert [one.name for one in group.signals] == [*head.split(","), *([] if own else ["received"])]
    assert group.time == (None if own else "received")
    if not own:
        np.testing.assert_allclose(group.signals[2].values, 0.1 * np.arange(8), atol=1e-9)


def test_words_alone(tmp_path: Path) -> None:
    """Refuse a log without values by the message for text without a table."""
    (tmp_path / "a.txt").write_text("12:00:00 -> hello\n12:00:01 -> world\n12:00:02 -> again\n12:00:03 -> bye\n")
    with pytest.raises(InputError, match="no table of numbers"):
        read_file(tmp_path / "a.txt")
