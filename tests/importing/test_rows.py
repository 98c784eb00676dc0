"""Rows that a column chooses: a state in words, a number, several values, and times of what is left out."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.errors import InputError
from harness.importing import Options, Understood, read_file, understand
from tests.importing import made


def log(file: Path, *, timed: bool = True) -> Path:
    """A controller's log: it waits, runs from the 100th to the 900th row, brakes, and is off."""
    rows = []
    for at, (t, a, s) in enumerate(zip(*made.truth(), strict=True)):
        state = "WAIT" if at < 100 else "RUN" if at < 900 else "BRAKE" if at < 950 else "OFF"
        rows.append(",".join([*([f"{t:.2f}"] if timed else []), f"{a:.6f}", state, str(at // 300), f"{s:.5f}"]))
    head = ["t_s,"] * timed
    file.write_text("\n".join((f"{''.join(head)}alpha_rad,state,phase,x_m", *rows, "")))
    return file


def taken(file: Path, *where: str, rate: float | None = None) -> Understood:
    """What is understood of these rows of the log."""
    return understand([read_file(file)], Options(where=where, rate=rate))


@pytest.mark.parametrize(
    ("where", "first", "last"),
    [
        (("state=RUN",), 100, 899),
        (("state=run", "state=brake"), 100, 949),
        (("phase=1",), 300, 599),
        (("phase=1.0", "phase=2"), 300, 899),
        (("state=RUN", "phase=0"), 100, 299),
    ],
)
def test_rows_of_a_state(tmp_path: Path, where: tuple[str, ...], first: int, last: int) -> None:
    """Take the rows with one of the values of each column, with their own times."""
    got = taken(log(tmp_path / "a.csv"), *where)
    time, angle, _ = made.truth()
    np.testing.assert_allclose(got.time, time[first : last + 1], atol=1e-9)
    np.testing.assert_allclose(got.angle, angle[first : last + 1], atol=1e-6)
    assert any("the others are left out" in note for note in got.notes)


def test_rows_that_only_a_rate_times(tmp_path: Path) -> None:
    """Count the rows that were left out where no column holds the time."""
    got = taken(log(tmp_path / "a.csv", timed=False), "phase=0", "phase=2", rate=100.0)
    time = made.truth()[0]
    np.testing.assert_allclose(got.time, np.concatenate((time[:300], time[600:900])), atol=1e-9)


@pytest.mark.parametrize(
    ("where", "told"),
    [
        ("stat=RUN", r"a\.csv: --where: there is no column 'stat'\. Did you mean 'state'\?"),
        ("state=GO", r"a\.csv: --where: no row has state = GO; it has 'WAIT', 'RUN', 'BRAKE', 'OFF'\."),
        ("state", r"--where 'state': write COLUMN=VALUE"),
    ],
)
def test_rows_that_are_not_there(tmp_path: Path, where: str, told: str) -> None:
    """Refuse a column or a value that no row has, with those that there are."""
    with pytest.raises(InputError, match=told):
        taken(log(tmp_path / "a.csv"), where)


def frame() -> pd.DataFrame:
    """A log with a state and a counter of seven digits."""
    time, angle, position = made.truth()
    at = np.arange(len(time))
    running = at >= 300
    return pd.DataFrame(
        {
            "t_s": time.round(2),
            "alpha_rad": angle,
            "x_m": position,
            "state": np.where(running, "RUN", "WAIT"),
            "count": 1_234_567 + running,
        }
    )


def as_json(file: Path) -> Path:
    """Records of JSON below a name."""
    file.write_text(json.dumps({"log": frame().to_dict("records")}))
    return file


def as_sheet(file: Path) -> Path:
    """The only sheet of a workbook."""
    frame().to_excel(file, index=False)
    return file


@pytest.mark.parametrize("where", ["state=RUN", "count=1234568"])
@pytest.mark.parametrize(("name", "write"), [("a.json", as_json), ("a.xlsx", as_sheet)])
def test_rows_of_the_only_table_of_a_file(tmp_path: Path, name: str, write: Callable[[Path], Path], where: str) -> None:
    """Choose by words or by every digit of a number where the table has a name that nobody needs."""
    got = taken(write(tmp_path / name), where)
    np.testing.assert_allclose(got.time, made.truth()[0][300:], atol=1e-9)
