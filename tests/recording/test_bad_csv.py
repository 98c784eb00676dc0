"""What cannot be used is refused by one message that names file, row and column and says what to do."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import load_recording
from tests.recording.simulated import contract_columns, csv_text

LINES = csv_text(contract_columns()).splitlines()


def cell(row: int, column: int, text: str) -> Callable[[], str]:
    """The sound file with one cell replaced; rows from 1, the header being row 1."""

    def build() -> str:
        lines = list(LINES)
        cells = lines[row - 1].split(",")
        cells[column] = text
        lines[row - 1] = ",".join(cells)
        return "\n".join(lines)

    return build


def line(row: int, text: str) -> Callable[[], str]:
    """The sound file with one row replaced."""
    return lambda: "\n".join([*LINES[: row - 1], text, *LINES[row:]])


def columns(**replaced: np.ndarray | None) -> Callable[[], str]:
    """The sound file with whole columns replaced, added or (None) left out."""
    merged = {**contract_columns(), **replaced}
    return lambda: csv_text({name: values for name, values in merged.items() if values is not None})


def renamed(**names: str) -> Callable[[], str]:
    """The sound file with columns renamed."""
    return lambda: "\n".join([",".join(names.get(name, name) for name in LINES[0].split(",")), *LINES[1:]])


def blank_angles(first: int, last: int) -> Callable[[], str]:
    """The sound file with the angle blank from row to row."""
    angle = contract_columns()["beam_angle_rad"].copy()
    angle[first - 2 : last - 1] = np.nan
    return columns(beam_angle_rad=angle)


TIME = contract_columns()["time_s"]
ANGLE = contract_columns()["beam_angle_rad"]

BAD: dict[str, tuple[Callable[[], str], tuple[str, ...]]] = {
    "empty": (lambda: "", ("contains no data",)),
    "comments only": (lambda: "# nothing\n\n", ("contains no data",)),
    "header only": (lambda: LINES[0], ("no rows",)),
    "no header": (lambda: "\n".join(LINES[1:]), ("row 1", "column names", "time_s,beam_angle_rad")),
    "no separator": (lambda: "time angle\n0 0\n", ("row 1", "no separator", "semicolon")),
    "text": (cell(57, 1, "0.1o"), ("row 57", "'beam_angle_rad'", "'0.1o'", "not a number", "blank")),
    "underscore": (cell(57, 1, "0.3_6"), ("row 57", "'beam_angle_rad'", "'0.3_6'", "not a number")),
    "text in position": (cell(9, 2, "lost"), ("row 9", "'ball_position_m'", "'lost'")),
    "units below the header": (line(2, "s,rad,m"), ("row 2", "'s'", "units", "column names")),
    "infinite": (cell(30, 2, "inf"), ("row 30", "'ball_position_m'", "not a measured value")),
    "overrange": (cell(31, 1, "9.9e37"), ("row 31", "'beam_angle_rad'", "not a measured value")),
    "blank time": (cell(12, 0, ""), ("row 12", "'time_s'", "blank")),
    "time back": (cell(101, 0, "0.5"), ("row 101", "'time_s'", "decreases from 0.98 to 0.5 s")),
    "short row": (line(44, "0.42,0.01"), ("row 44", "2 cells", "row 1 has 3", "Complete the row")),
    "decimal commas between commas": (line(2, "0,0,0,05,0,3"), ("row 2", "6 cells", "semicolons")),
    "mixed decimal marks": (
        lambda: "\n".join(LINES).replace(",", ";").replace("0.01;", "0,01;", 1),
        ("row 3", "'0,01' has a comma", "one decimal mark"),
    ),
    "open quote": (cell(20, 2, '"0.3'), ("row 20", "quotation mark")),
    "no angle": (columns(beam_angle_rad=None), ("row 1", "no column 'beam_angle_rad'", "'time_s', 'ball_position_m'")),
    "servo angle": (renamed(beam_angle_rad="theta_rad"), ("no column 'beam_angle_rad'", "'theta_rad'")),
    "misspelt": (renamed(ball_position_m="ball_postion_m"), ("'ball_postion_m'", "Did you mean 'ball_position_m'?")),
    "unknown unit": (renamed(ball_position_m="ball_position_inch"), ("unit 'inch'", "position", "mm, cm")),
    "unknown unit of a short name": (renamed(beam_angle_rad="alpha_turns"), ("unit 'turns'", "rad, ")),
    "twice the same": (renamed(ball_position_m="time_s"), ("'time_s' occurs more than once",)),
    "ambiguous": (
        lambda: csv_text({"t": TIME, "beam_angle_rad": ANGLE, "x_m": ANGLE, "position_m": ANGLE}),
        ("'x_m', 'position_m'", "all match the position", "ball_position_m"),
    ),
    "two units of one": (
        lambda: csv_text({"time_ms": TIME, "time_us": TIME, "beam_angle_rad": ANGLE}),
        ("'time_ms', 'time_us'", "all match the time"),
    ),
    "equal stamps": (
        columns(time_s=np.zeros(len(TIME))),
        ("'time_s'", "all 1201 rows have the time 0 s", "each reading"),
    ),
    "stamps in whole seconds": (columns(time_s=np.floor(TIME)), ("only 13 different times in 1201 rows", "digits")),
    "far too many columns": (
        lambda: "\n".join([",".join(f"c{i}" for i in range(100_000)), ",".join(["0"] * 100_000)]),
        ("row 1", "100000 columns", "at most 1000"),
    ),
    "few samples": (lambda: "\n".join(LINES[:16]), ("only 15 samples", "20")),
    "seconds under ms": (renamed(time_s="time_ms"), ("'time_ms'", "only 0.012 s long", "unit")),
    "angle missing": (columns(beam_angle_rad=np.full(len(TIME), np.nan)), ("'beam_angle_rad'", "no numbers")),
    "long dropout": (blank_angles(100, 119), ("'beam_angle_rad'", "rows 100-119", "0.21 s", "Split")),
    "blank start": (blank_angles(2, 3), ("rows 2-3", "beginning", "Delete")),
    "blank end": (blank_angles(1200, 1202), ("rows 1200-1202", "end of the recording", "Delete")),
}


@pytest.mark.parametrize("name", BAD)
def test_refused_with_place_and_advice(tmp_path: Path, name: str) -> None:
    """Refuse the file in one line that names it, the place, the fault and the remedy."""
    build, parts = BAD[name]
    path = tmp_path / "rec.csv"
    path.write_text(build(), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_recording(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    for part in parts:
        assert part in message


@pytest.mark.parametrize(
    ("raw", "part"),
    [(b"PK\x03\x04rest", "spreadsheet"), (b"\x00\x01\x02\x00", "binary data"), (b"t\x00i\x00m\x00", "binary data")],
)
def test_no_text(tmp_path: Path, raw: bytes, part: str) -> None:
    """Say that a file is not text instead of complaining about its columns."""
    path = tmp_path / "rec.csv"
    path.write_bytes(raw)
    with pytest.raises(InputError, match=part):
        load_recording(path)


def test_no_file(tmp_path: Path) -> None:
    """Name the file that is not there."""
    with pytest.raises(InputError, match=r"gone\.csv: there is no such file"):
        load_recording(tmp_path / "gone.csv")


def test_a_pipe_is_refused(tmp_path: Path) -> None:
    """Refuse at once what might never end."""
    os.mkfifo(tmp_path / "rec.csv")
    with pytest.raises(InputError, match=r"rec\.csv: a pipe or a device, not a file\. Save the data"):
        load_recording(tmp_path / "rec.csv")


def test_rows_count_like_an_editor(tmp_path: Path) -> None:
    """Count comments, blank rows and the header when a row is named."""
    path = tmp_path / "rec.csv"
    path.write_text("\n".join(["# by hand", "", LINES[0], "# start", LINES[1], "", "0.01,bad,0.3"]), encoding="utf-8")
    with pytest.raises(InputError, match="row 7, column 'beam_angle_rad': 'bad'"):
        load_recording(path)
