"""Text of any instrument: separators, decimal commas, dates, rows of units, what stands above and below."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.importing.read import read_file

ROWS = [(0.1 * at, 0.5 * at, -0.25 * at) for at in range(8)]


def text_of(separator: str, *, comma: bool = False, head: str = "t,angle,x") -> str:
    """Three columns of eight rows."""
    lines = [separator.join(head.split(","))]
    for row in ROWS:
        cells = [f"{one:.2f}" for one in row]
        lines.append(separator.join(cell.replace(".", ",") if comma else cell for cell in cells))
    return "\n".join(lines) + "\n"


def check(path: Path, text: str, *, names: tuple[str, ...] = ("t", "angle", "x"), encoding: str = "utf-8") -> None:
    """Read the text, and compare names and numbers."""
    path.write_text(text, encoding=encoding)
    (group,) = read_file(path).groups
    assert tuple(one.name for one in group.signals) == names
    np.testing.assert_allclose(np.transpose([one.values for one in group.signals]), ROWS, atol=1e-12)


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "   "])
def test_separators(tmp_path: Path, separator: str) -> None:
    """Find each separator."""
    check(tmp_path / "a.txt", text_of(separator))


@pytest.mark.parametrize("separator", [";", "\t", " "])
def test_decimal_commas(tmp_path: Path, separator: str) -> None:
    """Take commas within cells for decimal marks."""
    check(tmp_path / "a.csv", text_of(separator, comma=True))


@pytest.mark.parametrize(
    "preamble",
    [
        "",
        "Datum;12.5.2024\nOrt;Labor 3\n\n",
        "# a comment\n# another: 3\n",
        "Recorder 7\nSerial no. 12345\nChannels: 2\n\n",
        "sep=;\n",
    ],
)
def test_preambles(tmp_path: Path, preamble: str) -> None:
    """Leave out what stands above the names."""
    check(tmp_path / "a.csv", preamble + text_of(";"))


def test_encodings(tmp_path: Path) -> None:
    """Read UTF-8 with a mark, UTF-16, and what Windows writes."""
    for encoding in ("utf-8-sig", "utf-16", "cp1252"):
        check(tmp_path / "a.csv", text_of(",", head="t,Winkel °,x"), names=("t", "Winkel °", "x"), encoding=encoding)


def test_no_names(tmp_path: Path) -> None:
    """Number the columns of a file that begins with numbers."""
    text = "\n".join(text_of(",").split("\n")[1:])
    check(tmp_path / "a.csv", text, names=("column 1", "column 2", "column 3"))


@pytest.mark.parametrize(
    "head", ["t,angle,x\n[s],[deg],[mm]\n", "s,deg,mm\nt,angle,x\n", "t,angle,x\n(s),(deg),(mm)\n\n"]
)
def test_a_row_of_units(tmp_path: Path, head: str) -> None:
    """Tell names and units apart, whichever comes first."""
    file = tmp_path / "a.csv"
    file.write_text(head + "\n".join(text_of(",").split("\n")[1:]))
    (group,) = read_file(file).groups
    assert [(one.name, one.unit) for one in group.signals] == [("t", "s"), ("angle", "deg"), ("x", "mm")]


@pytest.mark.parametrize("stamp", ["2024-05-01 23:59:{:05.2f}", "01.05.2024 23:59:{:05.2f}", "23:59:{:05.2f}"])
def test_dates_and_clock_times(tmp_path: Path, stamp: str) -> None:
    """Count dates and times of day from the first, also past midnight."""
    seconds = [58.0 + 0.5 * at for at in range(4)]
    stamps = [stamp.format(one) for one in seconds]
    later = stamp.replace("23:59", "00:00").replace("01.05.2024", "02.05.2024").replace("05-01", "05-02")
    stamps += [later.format(0.5 * at) for at in range(4)]
    file = tmp_path / "a.csv"
    file.write_text("time;x\n" + "".join(f"{one};{at}\n" for at, one in enumerate(stamps)))
    (group,) = read_file(file).groups
    np.testing.assert_allclose(group.signals[0].values, 0.5 * np.arange(8), atol=1e-9)
    assert group.signals[0].unit == "s"


def test_a_date_in_a_column_of_its_own(tmp_path: Path) -> None:
    """Take the time of day from the second column, and leave the date out."""
    file = tmp_path / "a.csv"
    file.write_text("Datum;Zeit;x\n" + "".join(f"01.05.2024;12:00:0{at},5;{at}\n" for at in range(8)))
    (group,) = read_file(file).groups
    assert [one.name for one in group.signals] == ["Zeit", "x"]
    np.testing.assert_allclose(group.signals[0].values, np.arange(8.0), atol=1e-9)


def test_blank_cells_and_overflows_are_not_known(tmp_path: Path) -> None:
    """Take blanks, nan and the huge numbers of instruments for values that are not known."""
    file = tmp_path / "a.csv"
    file.write_text("t,x\n0,1\n1,\n2,nan\n3,9.9E+37\n4,-\n5,6\n")
    (group,) = read_file(file).groups
    np.testing.assert_array_equal(np.isnan(group.signals[1].values), [False, True, True, True, True, False])


def test_time_grows_with_the_rows_only(tmp_path: Path) -> None:
    """Read 40 000 rows in seconds: linear growth takes 0.7 s here, copying the rest at each row took 12 s."""
    file = tmp_path / "a.csv"
    file.write_text("t,x\n" + "".join(f"{at},{at % 7}\n" for at in range(40_000)))
    begin = time.process_time()
    (group,) = read_file(file).groups
    assert time.process_time() - begin < 6.0
    assert len(group.rows) == 40_000


def test_what_stands_below_is_left_out_and_said(tmp_path: Path) -> None:
    """Leave out a footer and a row that was cut off, and say so."""
    file = tmp_path / "a.csv"
    file.write_text(text_of(",") + "end of record\n")
    assert read_file(file).notes == ("rows 10 to 10 below the numbers left out",)
    file.write_text(text_of(",") + "0.80,4")
    assert read_file(file).notes == ("row 10 is incomplete and was left out",)


def test_a_column_of_words_is_left_out_and_said(tmp_path: Path) -> None:
    """Leave out a column of words."""
    file = tmp_path / "a.csv"
    file.write_text("t,x,state\n" + "".join(f"{at},{at * at},RUN\n" for at in range(9)))
    made = read_file(file)
    assert [one.name for one in made.groups[0].signals] == ["t", "x"]
    assert made.notes == ("columns of words left out: state",)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is empty"),
        ("hello\n", "no table of numbers"),
        (text_of(",") + "a,b,c\n" + text_of(","), "row 10: 'a b c' stands among the numbers"),
        (text_of(",") + "0.8,4.0,E7x\n" + "0.9,4.5,1\n", "row 10, column 'x': 'E7x' is not a number"),
        (
            text_of(";") + '0.9;"1,004";3\n',
            "row 10, column 'angle': '1,004' has a comma, but '0.00' in row 2 has a point",
        ),
        (text_of(",") + "1,2,3,4,5\n", "row 10: 5 cells where the rows above have 3"),
    ],
)
def test_what_cannot_be_read_is_told(tmp_path: Path, text: str, told: str) -> None:
    """Say file, row and what to do."""
    file = tmp_path / "a.csv"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_file(file)
    assert told in str(caught.value)
    assert str(file) in str(caught.value)
