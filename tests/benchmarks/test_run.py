"""Running trials: nothing twice, nothing lost, everything by the same door as a user's data."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks.calibration import run as running
from benchmarks.calibration.__main__ import main
from benchmarks.calibration.rows import Row
from benchmarks.calibration.store import Store, sources_digest
from benchmarks.calibration.trials import Trial, plan
from harness.jobs import Local, OneProcess
from tests.benchmarks.made import SOURCE, named, row, trial

ROWS = [
    row(trial("confusion", "viscous_damping", 0), named("viscous_damping", 1.1, rivals=["quadratic_drag"])),
    row(trial("null", "none", 0)),
]


def refuse(*_: object, **__: object) -> None:
    """In place of what must not be called."""
    raise AssertionError("computed what is there already")


def test_rows_come_back(tmp_path: Path) -> None:
    """Read from disk what was written to it."""
    store = Store(tmp_path / "rows.jsonl", SOURCE)
    for one in ROWS:
        store.append(one)
    assert list(store.rows().values()) == ROWS


def test_nothing_is_computed_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute nothing for trials that have a row."""
    store = Store(tmp_path / "rows.jsonl", SOURCE)
    for one in ROWS:
        store.append(one)
    monkeypatch.setattr(running, "diagnosed", refuse)
    running.run([one.trial for one in ROWS], store, executor=OneProcess(), told=refuse)
    with pytest.raises(AssertionError, match="computed"):
        running.run([trial("null", "none", 1)], store, executor=OneProcess())


def test_what_failed_or_is_stale_is_computed_anew(tmp_path: Path) -> None:
    """Try again what ended with an error, and what other sources made; a line cut short is as if it were not there."""
    path = tmp_path / "rows.jsonl"
    store = Store(path, SOURCE)
    right, broken = (trial("null", "none", number) for number in (0, 1))
    store.append(row(right))
    store.append(Row(trial=broken, source=SOURCE, verdict="", error="ValueError: no"))
    assert store.missing([right, broken]) == [broken]
    assert Store(path, "another").missing([right, broken]) == [right, broken]
    text = path.read_text(encoding="utf-8")
    path.write_text(text[: text.index("\n") // 2], encoding="utf-8")
    assert store.missing([right, broken]) == [right, broken]
    store.append(row(right))
    assert store.missing([right, broken]) == [broken]


def test_rows_of_other_sources_may_have_other_fields(tmp_path: Path) -> None:
    """Count what former sources wrote, and read what these wrote beside it."""
    store = Store(tmp_path / "rows.jsonl", SOURCE)
    store.path.write_text('{"source": "former", "trial": {"effect": "level_error"}}\n', encoding="utf-8")
    store.append(ROWS[0])
    assert list(store.rows().values()) == ROWS[:1]
    assert store.sources() == {"former": 1, SOURCE: 1}


def test_a_failure_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the text of what went wrong, so that no study hides it."""

    def fail(*_: object) -> None:
        raise ValueError("the ball is gone")

    monkeypatch.setattr(running, "pose", fail)
    found = running.diagnosed(trial("null", "none", 0), SOURCE)
    assert found.error is not None
    assert found.error.startswith("ValueError: the ball is gone (test_run.py, line ")


def test_tables_without_rows_are_refused(tmp_path: Path) -> None:
    """Name the sources of which there are rows when there is none of those asked for."""
    store = Store(tmp_path / "rows.jsonl", SOURCE)
    store.append(ROWS[0])
    arguments = ["--tables-only", "--rows", str(store.path), "--docs", str(tmp_path / "docs")]
    refused = CliRunner().invoke(main, [*arguments, "--source", "another"])
    assert refused.exit_code == 2
    assert f"{SOURCE} (1)" in refused.output
    assert CliRunner().invoke(main, [*arguments, "--source", SOURCE]).exit_code == 0
    assert (tmp_path / "docs" / "calibration.md").exists()


def test_tables_of_several_sources_count_a_trial_once(tmp_path: Path) -> None:
    """Take a trial's row of the first source that has one, and name all sources on the page."""
    path = tmp_path / "rows.jsonl"
    for source, rows in (("newer", ROWS[:1]), ("older", ROWS)):
        for one in rows:
            Store(path, source).append(replace(one, source=source))
    arguments = ["--tables-only", "--rows", str(path), "--docs", str(tmp_path / "docs")]
    done = CliRunner().invoke(main, [*arguments, "--source", "newer", "--source", "older"])
    assert done.exit_code == 0
    page = (tmp_path / "docs" / "calibration.md").read_text(encoding="utf-8")
    assert "`newer, older`" in page
    assert f"{len(ROWS)} blind trials" in page


def of_plant(plant: str) -> Trial:
    """A large level error on this plant."""
    found = plan(["confusion"], only=["level_error"])
    return next(one for one in found if one.size == "large" and one.plant == plant)


@pytest.mark.slow
@pytest.mark.parametrize("plant", ["virtual_rig", "mujoco", "pybullet"])
def test_a_blind_trial_names_what_was_hidden(tmp_path: Path, plant: str) -> None:
    """Find a large level error from the case on disk, in a process of its own, whatever moved the ball."""
    store = Store(tmp_path / "rows.jsonl", sources_digest())
    one = of_plant(plant)
    running.run([one], store, executor=Local(1))
    found = store.rows()[one.spec]
    assert found.error is None
    assert [each.name for each in found.named] == ["level_error"]
    ((value, low, high),) = found.named[0].values.values()
    assert low < value < high
    # 10 mrad is found to far better than a tenth, or the trial was not the one that the row tells of
    assert value == pytest.approx(one.hidden["level_error"]["angle"], rel=0.1)
    assert store.missing([one]) == []
