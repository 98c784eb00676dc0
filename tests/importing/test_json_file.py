"""JSON: records, lists side by side, records line by line, and what is no table."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.importing import read_file

RECORDS = [{"t": 0.1 * at, "angle": -0.01 * at, "x": 0.2 + at} for at in range(5)]


def put(file: Path, content: object) -> Path:
    """A file of this JSON."""
    file.write_text(json.dumps(content))
    return file


@pytest.mark.parametrize(
    ("content", "names"),
    [
        pytest.param(RECORDS, ["t", "angle", "x"], id="records"),
        pytest.param({"log": RECORDS}, ["t", "angle", "x"], id="records below a name"),
        pytest.param({"t": [0, 1, 2], "x": [3.5, None, 4]}, ["t", "x"], id="lists"),
        pytest.param({"a": {"b": {"t": [0, 1, 2], "x": [3, 4, 5]}}}, ["t", "x"], id="lists in objects"),
        pytest.param([[0, 3], [1, 4], [2, 5]], ["column 1", "column 2"], id="rows"),
        pytest.param([{"t": at, "ball": {"x": at}} for at in range(4)], ["t", "ball.x"], id="records in records"),
    ],
)
def test_tables(tmp_path: Path, content: object, names: list[str]) -> None:
    """Find a table of numbers however it is written."""
    (group,) = read_file(put(tmp_path / "a.json", content)).groups
    assert [one.name for one in group.signals] == names


def test_missing_values_and_words(tmp_path: Path) -> None:
    """Leave null blank, and say which columns hold words."""
    content = [{"t": at, "x": None if at == 2 else at, "state": "RUN", "ok": True} for at in range(4)]
    source = read_file(put(tmp_path / "a.json", content))
    assert source.notes == ("columns of words left out: state",)
    np.testing.assert_array_equal(source.groups[0].signals[1].values, [0.0, 1.0, np.nan, 3.0])
    np.testing.assert_array_equal(source.groups[0].signals[2].values, np.ones(4))


def test_lists_of_several_lengths_are_groups(tmp_path: Path) -> None:
    """Put lists of one length side by side, and those of another in a group of their own."""
    groups = read_file(put(tmp_path / "a.json", {"t": [0, 1, 2], "x": [3, 4, 5], "gains": [1, 2, 3, 4]})).groups
    assert [[one.name for one in group.signals] for group in groups] == [["t", "x"], ["gains"]]


def test_lines_of_a_program_that_was_stopped(tmp_path: Path) -> None:
    """Leave out a last line that is incomplete, and refuse one before it."""
    lines = [json.dumps(one) for one in RECORDS]
    (tmp_path / "a.jsonl").write_text("\n".join((*lines, lines[0][:9])))
    (group,) = read_file(tmp_path / "a.jsonl").groups
    assert len(group.rows) == len(RECORDS)
    (tmp_path / "b.jsonl").write_text("\n".join((lines[0], lines[1][:9], *lines[2:])))
    with pytest.raises(InputError, match=r"b\.jsonl, row 2: no JSON"):
        read_file(tmp_path / "b.jsonl")


@pytest.mark.parametrize("content", [{}, [], [1, 2, 3], {"kp": 4.0, "kd": [1, 2]}, "x", {"names": ["a", "b", "c"]}])
def test_no_table(tmp_path: Path, content: object) -> None:
    """Refuse JSON without a table of numbers, with how to write one."""
    with pytest.raises(InputError, match=r"a\.json: no table of numbers in it\. Write a list of records"):
        read_file(put(tmp_path / "a.json", content))


def test_an_integer_of_thousands_of_digits(tmp_path: Path) -> None:
    """Refuse a number that Python does not read by one message."""
    (tmp_path / "a.json").write_text('[{"t": ' + "9" * 5000 + "}]")
    with pytest.raises(InputError, match=r"a\.json, row 1: no JSON"):
        read_file(tmp_path / "a.json")


def test_too_many_levels(tmp_path: Path) -> None:
    """Refuse what is nested thousands deep by one message."""
    (tmp_path / "a.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match=r"levels|no JSON"):
        read_file(tmp_path / "a.json")
