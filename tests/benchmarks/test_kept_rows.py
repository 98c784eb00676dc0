"""Rows that a run keeps, so that the next one goes on where it was."""

from __future__ import annotations

from pathlib import Path

from benchmarks.calibration.trials import Trial, plan
from benchmarks.kept_rows import KeptRows

FIRST, SECOND = plan(("null",), count=2)


class Counted:
    """Numbers of the trials, and which were computed."""

    def __init__(self) -> None:
        self.computed: list[int] = []

    def result(self, trial: Trial) -> int:
        """Of a trial: its number."""
        self.computed.append(trial.number)
        return trial.number


def told(trial: Trial, result: int) -> None:
    """Expect the trial's own result."""
    assert result == trial.number


def test_what_is_kept_is_not_computed_again(tmp_path: Path) -> None:
    """Compute a trial once, and give the results in the order asked for."""
    kept, number = KeptRows(tmp_path / "rows.jsonl", "a"), Counted()
    assert kept.of_trials([SECOND], number.result, told) == [1]
    assert kept.of_trials([FIRST, SECOND], number.result, told) == [0, 1]
    assert number.computed == [1, 0]


def test_rows_of_other_sources_do_not_count(tmp_path: Path) -> None:
    """Compute anew what changed sources would give, and count the old rows."""
    number = Counted()
    for source in ("a", "b"):
        KeptRows(tmp_path / "rows.jsonl", source).of_trials([FIRST], number.result, told)
    assert number.computed == [0, 0]
    assert KeptRows(tmp_path / "rows.jsonl", "b").sources() == {"a": 1, "b": 1}


def test_a_row_cut_short_is_computed_again(tmp_path: Path) -> None:
    """Lose one row to a run that was killed while it wrote, and none of those that follow."""
    kept, number = KeptRows(tmp_path / "rows.jsonl", "a"), Counted()
    kept.of_trials([FIRST], number.result, told)
    kept.path.write_bytes(kept.path.read_bytes()[:-9])
    assert kept.of_trials([FIRST, SECOND], number.result, told) == [0, 1]
    assert number.computed == [0, 0, 1]
    assert kept.of_trials([FIRST, SECOND], number.result, told) == [0, 1]
    assert number.computed == [0, 0, 1]
