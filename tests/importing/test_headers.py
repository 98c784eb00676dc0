"""Names above columns: fewer than columns, blank columns, names with a line break."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from openpyxl import Workbook

from harness.errors import InputError
from harness.importing import Ambiguity, Options, read_file, understand
from tests.importing import made

ROWS = [(0.1 * at, 0.5 * at, -0.25 * at) for at in range(8)]


def put(file: Path, head: str, separator: str = ",", *, first: str = "{}") -> Path:
    """Eight rows of three columns, behind a column that is made of the row's number."""
    lines = [separator.join((first.format(at), *map(str, row))) for at, row in enumerate(ROWS, start=1)]
    file.write_text("\n".join((head, *lines, "")))
    return file


@pytest.mark.parametrize(
    ("head", "separator", "first"),
    [
        ("t,angle,x", ",", "{}"),
        ('"t","angle","x"', ",", '"{}"'),
        ("t angle x", " ", "{}"),
        ('"t" "angle" "x"', " ", '"{}"'),
    ],
)
def test_row_numbers_without_a_name(tmp_path: Path, head: str, separator: str, first: str) -> None:
    """Give the names to the columns behind the row numbers of R, and say so."""
    source = read_file(put(tmp_path / "a.txt", head, separator, first=first))
    signals = source.groups[0].signals
    assert [one.name for one in signals] == ["column 1", "t", "angle", "x"]
    np.testing.assert_allclose(np.transpose([one.values for one in signals[1:]]), ROWS, atol=1e-12)
    assert source.notes == ("the header has 3 names for 4 columns; the first, which counts the rows, was given none",)


@pytest.mark.parametrize(
    ("head", "told"),
    [
        ("t,angle,x", "row 2: 4 cells, but the header in row 1 has 3 names. Write one above each column."),
        ("t,angle", "row 2: 4 cells, but the header in row 1 has 2 names. Write one above each column; if commas are"),
        ("s,deg,mm", "row 2: 4 cells, but the header in row 1 has 3 units"),
    ],
)
def test_names_that_are_too_few(tmp_path: Path, head: str, told: str) -> None:
    """Refuse names of which nobody knows which column they belong to."""
    with pytest.raises(InputError) as caught:
        read_file(put(tmp_path / "a.csv", head, first="0.0{}"))
    assert told in str(caught.value)
    assert str(tmp_path / "a.csv") in str(caught.value)


def test_remarks_between_names_and_numbers(tmp_path: Path) -> None:
    """Find the names above the remarks that a logger writes between them and the first reading."""
    head = "n,t,angle,x\n# Run: trial 21\n# Controller: PID, tuned\n# Scale: 0.15 m per unit"
    source = read_file(put(tmp_path / "a.csv", head))
    assert [one.name for one in source.groups[0].signals] == ["n", "t", "angle", "x"]


def test_a_line_of_the_preamble_is_no_header(tmp_path: Path) -> None:
    """Number columns below words that name no quantity."""
    source = read_file(put(tmp_path / "a.csv", "Operator,Miller", first="0.0{}"))
    assert [one.name for one in source.groups[0].signals] == [f"column {at}" for at in (1, 2, 3, 4)]


@pytest.mark.parametrize(
    "preamble",
    [
        "# units: t [s], angle [deg], x [inch]\n",
        "# t in s\n# angle in deg\n# x in inch\n",
        "# t: s, angle: deg, x: inch\n",
        "# columns: t (s), angle (deg), x (inch)\n",
    ],
)
def test_units_in_comments(tmp_path: Path, preamble: str) -> None:
    """Take the units that comments write behind the names of columns."""
    file = tmp_path / "a.csv"
    file.write_text(preamble + "t,angle,x\n" + "".join(",".join(map(str, row)) + "\n" for row in ROWS))
    (group,) = read_file(file).groups
    assert [(one.name, one.unit) for one in group.signals] == [("t", "s"), ("angle", "deg"), ("x", "inch")]


def test_a_name_with_a_line_break(tmp_path: Path) -> None:
    """Read names between quotation marks that go on in the next line."""
    file = tmp_path / "a.csv"
    rows = "".join(";".join(map(str, row)) + "\n" for row in ROWS)
    file.write_text('"Time\n(s)";"Angle\n(deg)";"Distance\n(cm)"\n' + rows)
    (group,) = read_file(file).groups
    assert [one.name for one in group.signals] == ["Time (s)", "Angle (deg)", "Distance (cm)"]
    assert (group.rows[0], len(group.rows)) == (5, 8)


def test_a_quotation_mark_that_stays_open(tmp_path: Path) -> None:
    """Refuse a mark that swallows rows of numbers."""
    file = tmp_path / "a.csv"
    file.write_text('t,x\n0,1\n1,2\n2,3\n3,"4\n4,5"\n5,6\n')
    with pytest.raises(InputError, match="row 5: a quotation mark is not closed"):
        read_file(file)


def test_blank_columns_are_said_and_asked_about(tmp_path: Path) -> None:
    """Name columns of formulas without values, and take no other column for the quantity that they name."""
    time, angle, position = made.truth()
    book = Workbook()
    sheet = book.active
    sheet.append(["t (s)", "angle raw", "alpha (deg)", "note", "x (mm)"])
    for at, (t, a, s) in enumerate(zip(time, 2.0 * np.degrees(angle), 1e3 * position, strict=True), start=2):
        sheet.append([float(t), float(a), f"=B{at}/2", f"=B{at}", float(s)])
    book.save(tmp_path / "a.xlsx")
    source = read_file(tmp_path / "a.xlsx")
    assert source.notes == ("columns without a value: alpha (deg), note",)
    with pytest.raises(Ambiguity, match=r"'alpha \(deg\)' is the beam's angle by its name, but has no value") as caught:
        understand([source], Options())
    assert [one.typed for one in caught.value.choices] == ["--angle 'angle raw'"]
    assert "save it" in caught.value.advice


def test_more_names_than_columns(tmp_path: Path) -> None:
    """Say that a row of names is too long for anybody to know which belong to the columns."""
    source = read_file(put(tmp_path / "a.csv", "t,I1,alpha,x,dotx,doty", first="0.0{}"))
    assert [one.name for one in source.groups[0].signals] == [f"column {at}" for at in (1, 2, 3, 4)]
    assert source.notes == ("row 1 has 6 names for 4 columns, which are called by their numbers",)


def test_a_sampling_period_within_a_row(tmp_path: Path) -> None:
    """Take the sampling interval that a program writes beside the date above the names."""
    file = put(tmp_path / "a.txt", "Thursday\t16:05:25\tSampling Period : 50  ms\t\tFree control\n\nangle\tx\tu", "\t")
    file.write_text(file.read_text().replace("\nangle\tx\tu\n", "\nn\tangle\tx\tu\n"))
    (group,) = read_file(file).groups
    assert (group.step, group.step_from) == (0.05, "sampling period")


def counted(file: Path, preamble: str = "") -> Path:
    """A table whose time counts the rows, of a ball that does not follow the angle: only sizes tell the unit."""
    rows = "".join(f"{at}\t{3.0 * math.sin(0.02 * at)}\t{0.3 + 0.02 * math.sin(0.11 * at)}\n" for at in range(900))
    file.write_text(f"{preamble}t\tAlpha [deg]\tx [m]\n{rows}")
    return file


def test_a_time_that_counts_the_rows(tmp_path: Path) -> None:
    """Take the sampling period above the table for a time without a unit that counts the rows."""
    file = counted(tmp_path / "a.txt", "Sampling Period : 10 ms\n")
    assert np.ptp(understand([read_file(file)], Options()).time) == pytest.approx(0.01 * 899)


def test_a_count_of_rows_is_not_taken_for_milliseconds(tmp_path: Path) -> None:
    """Ask for the time where a column without a unit counts the rows and nothing but its size would tell."""
    with pytest.raises(Ambiguity, match=r"'t' \(time\) has no unit, and counts the rows") as caught:
        understand([read_file(counted(tmp_path / "a.txt"))], Options())
    assert "--rate" in caught.value.advice
