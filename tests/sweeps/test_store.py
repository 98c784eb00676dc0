"""Rows on disk: none is lost, none is there twice, wherever a kill comes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from harness.errors import InputError
from harness.sweeps import store as stores
from harness.sweeps.store import Store, begun, schema_of


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part is full after four rows."""
    monkeypatch.setattr(stores, "FULL", 4)


SCHEMA = schema_of({"mujoco.friction": [0.1], "mujoco.condim": [3, 4], "mujoco.cone": ["elliptic"]})


def row(number: int) -> dict[str, Any]:
    """What came of a run; every third failed."""
    if number % 3 == 2:
        return {"run": number, "failure": "slipped", "message": "it \u201cslid\u201d,\nand so on"}
    return {"run": number, "mujoco.friction": 0.1 * number, "cpu_s": 1e-3, "mujoco.condim": 3, "failure": None}


def written(store: Store, file: Path) -> list[dict[str, Any]]:
    """All rows of the result."""
    store.write(file)
    rows: list[dict[str, Any]] = pq.read_table(file).to_pylist()
    return rows


def test_rows_come_out_in_the_order_of_runs(tmp_path: Path) -> None:
    """Write whatever order they came in by number, with every digit and the columns' types."""
    store = Store(tmp_path / "rows", SCHEMA, 11)
    for batch in ((7, 8), (0, 1, 2), (10,), (3, 9, 4), (6, 5)):
        store.append([row(number) for number in batch])
    rows = written(store, tmp_path / "runs.parquet")
    assert [one["run"] for one in rows] == list(range(11))
    assert [one["mujoco.friction"] for one in rows] == [row(n).get("mujoco.friction") for n in range(11)]
    assert rows[2]["message"] == row(2)["message"]
    assert pq.read_schema(tmp_path / "runs.parquet").equals(SCHEMA)


@pytest.mark.parametrize("batches", range(6))
def test_a_store_goes_on_where_it_was_left(batches: int, tmp_path: Path) -> None:
    """Know which runs are missing after a kill between any two batches."""
    every = [(0, 1), (2,), (3, 4, 5), (6,), (7, 8, 9)]
    first = Store(tmp_path / "rows", SCHEMA, 10)
    for batch in every[:batches]:
        first.append([row(number) for number in batch])
    second = Store(tmp_path / "rows", SCHEMA, 10)  # the first was never closed
    assert second.missing.tolist() == [number for batch in every[batches:] for number in batch]
    for batch in every[batches:]:
        second.append([row(number) for number in batch])
    assert [one["run"] for one in written(second, tmp_path / "runs.parquet")] == list(range(10))


def test_a_line_that_was_cut_counts_as_missing(tmp_path: Path) -> None:
    """Leave out the last line at whatever byte the kill came, and the run is done again."""
    store = Store(tmp_path / "rows", SCHEMA, 3)
    store.append([row(0), row(1)])
    (journal,) = (tmp_path / "rows").glob("*.jsonl")
    whole = journal.read_bytes()
    first = whole.index(b"\n") + 1
    for end in range(first, len(whole)):
        journal.write_bytes(whole[:end])
        again = Store(tmp_path / "rows", SCHEMA, 3)
        assert again.missing.tolist() == [1, 2]
        again.close()


def test_a_journal_that_is_a_part_already_counts_once(tmp_path: Path) -> None:
    """Ignore the journal that a kill kept from being deleted, and a part that was not finished."""
    store = Store(tmp_path / "rows", SCHEMA, 6)
    store.append([row(number) for number in range(3)])
    (journal,) = (tmp_path / "rows").glob("*.jsonl")
    kept = journal.read_bytes()
    store.append([row(3)])
    journal.write_bytes(kept)
    (tmp_path / "rows" / "00000001.unfinished").write_bytes(b"PAR1")
    again = Store(tmp_path / "rows", SCHEMA, 6)
    assert again.missing.tolist() == [4, 5]
    again.append([row(4), row(5)])
    assert [one["run"] for one in written(again, tmp_path / "runs.parquet")] == list(range(6))


def test_a_row_that_is_there_is_not_kept_twice(tmp_path: Path) -> None:
    """Keep the first of two rows of the same run."""
    store = Store(tmp_path / "rows", SCHEMA, 2)
    store.append([row(0)])
    store.append([{**row(0), "mujoco.friction": 9.0}, row(1)])
    assert [one["mujoco.friction"] for one in written(store, tmp_path / "runs.parquet")] == [0.0, 0.1]


def test_rows_of_another_sweep_are_not_gone_on_with(tmp_path: Path) -> None:
    """Name what has changed; discard only where it is asked for."""
    folder = tmp_path / "rows"
    begun(folder, {"spec": {"seed": 0, "size": 4}}, anew=False)
    Store(folder, SCHEMA, 4).append([row(0)])
    begun(folder, {"spec": {"seed": 0, "size": 4}}, anew=True)
    assert Store(folder, SCHEMA, 4).missing.tolist() == [1, 2, 3]
    with pytest.raises(InputError, match=r"spec\.seed was 0 and is 1.*--force"):
        begun(folder, {"spec": {"seed": 1, "size": 4}}, anew=False)
    begun(folder, {"spec": {"seed": 1, "size": 4}}, anew=True)
    assert Store(folder, SCHEMA, 4).missing.tolist() == [0, 1, 2, 3]
