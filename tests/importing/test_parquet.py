"""Parquet: which column of stamps is the time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from harness.importing import Ambiguity, Options, read_file, understand
from tests.importing import made

BEGIN = pd.Timestamp("2024-03-05 12:00")


def frame() -> pd.DataFrame:
    """Angle and position."""
    _, angle, position = made.truth()
    return pd.DataFrame({"angle_rad": angle, "x_m": position})


@pytest.mark.parametrize("name", [None, "when"])
@pytest.mark.parametrize("absolute", [True, False])
def test_an_index_of_stamps_is_the_time(tmp_path: Path, name: str | None, absolute: bool) -> None:
    """Take the one column of dates or durations for the time, whatever it is called."""
    steps = pd.to_timedelta(made.truth()[0], unit="s")
    frame().set_index((BEGIN + steps if absolute else steps).rename(name)).to_parquet(tmp_path / "a.parquet")
    understood = understand([read_file(tmp_path / "a.parquet")], Options())
    np.testing.assert_allclose(understood.time, made.truth()[0], atol=5e-7)  # nanoseconds since 1970 in a double


def test_times_of_day(tmp_path: Path) -> None:
    """Count times of day from the first."""
    ticks = pa.array(np.round(made.truth()[0] * 1e6).astype(np.int64)).cast(pa.time64("us"))
    table = pa.Table.from_pandas(frame()).append_column("clock", ticks)
    pq.write_table(table, tmp_path / "a.parquet")
    assert understand([read_file(tmp_path / "a.parquet")], Options()).time[-1] == pytest.approx(12.0)


def test_two_columns_of_stamps_are_asked_about(tmp_path: Path) -> None:
    """Guess nothing where two columns could be the time."""
    steps = BEGIN + pd.to_timedelta(made.truth()[0], unit="s")
    frame().assign(a=steps, b=steps).to_parquet(tmp_path / "a.parquet")
    with pytest.raises(Ambiguity, match="no column is called the time"):
        understand([read_file(tmp_path / "a.parquet")], Options())


@pytest.mark.parametrize("kind", ["string", "category"])
def test_rows_of_a_state(tmp_path: Path, kind: str) -> None:
    """Take the rows that a column of words chooses."""
    state = np.where(np.arange(len(made.truth()[0])) < 300, "WAIT", "RUN")
    table = frame().assign(t_s=made.truth()[0], state=pd.Series(state).astype(kind))
    table.to_parquet(tmp_path / "a.parquet")
    got = understand([read_file(tmp_path / "a.parquet")], Options(where=("state=RUN",)))
    np.testing.assert_allclose(got.time, made.truth()[0][300:], atol=1e-9)
