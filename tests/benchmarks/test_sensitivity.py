"""The sensitivity study: what is tried, and what its page counts."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks.calibration.rows import Row
from benchmarks.calibration.store import Store, sources_digest
from benchmarks.calibration.trials import Trial
from benchmarks.sensitivity import changed, chosen, main, page
from harness.identify.problem.settings import DEFAULT, Settings
from tests.benchmarks.made import named, row, trial

ROOT = Path(__file__).parents[2]


def of(setting: str, scale: float) -> Trial:
    """An effect-free trial with one setting changed."""
    return next(one for one in changed(trial("null", "none", 0)) if (one.setting, one.scale) == (setting, scale))


def test_a_trial_changes_one_setting_by_its_scale() -> None:
    """Leave all other settings as they are; a whole number stays whole and at least one."""
    for one in changed(trial("null", "none", 0)):
        differ = [name for name, *_ in Settings.described() if getattr(one.settings, name) != getattr(DEFAULT, name)]
        assert differ == [one.setting]
    assert of("keep", 0.5).settings.keep == 0.5 * DEFAULT.keep
    assert of("max_effects", 2.0).settings.max_effects == 2 * DEFAULT.max_effects
    assert trial("null", "none", 0).settings == DEFAULT


def test_every_setting_is_changed_both_ways_on_trials_of_every_kind() -> None:
    """Try each change on rigs without an effect, with one near the detection limit, with two, with an unlisted one."""
    names = [name for name, *_ in Settings.described()]
    assert {one.setting for one in changed(trial("null", "none", 0))} == set(names)
    trials = chosen()
    assert sum(not one.hidden and not one.unlisted for one in trials) == 2
    assert sorted(len(one.hidden) for one in trials) == [0, 0, 0, 1, 1, 2]
    assert sum(bool(one.unlisted) for one in trials) == 1


def rows_of(trials: list[Trial]) -> dict[str, Row]:
    """Nothing found anywhere, but an effect where `keep` is halved."""
    made = [
        row(one, *([named("level_error")] if (one.setting, one.scale) == ("keep", 0.5) else []))
        for each in trials
        for one in (each, *changed(each))
    ]
    return {one.trial.spec: one for one in made}


def test_the_page_counts_the_trials_that_end_otherwise() -> None:
    """Show a change of names as one, and a whole number that stays as it is as the same."""
    trials = [trial("null", "none", number) for number in range(3)]
    lines = page(trials, rows_of(trials)).splitlines()
    cells = {line.split("`")[1]: line.split(" | ")[-2:] for line in lines if line.startswith("| `")}
    assert list(cells) == [name for name, *_ in Settings.described()]
    assert cells["keep"] == ["3 of 3", "0 of 3 |"]
    assert cells["rival"] == ["0 of 3", "0 of 3 |"]
    assert sum(line == "- no effect, on virtual_rig, 40000 counts per turn: none" for line in lines) == 3


@pytest.mark.slow
def test_the_command_computes_nothing_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the page from rows that are there."""
    trials = [trial("null", "none", 0)]
    monkeypatch.setattr("benchmarks.sensitivity.chosen", lambda: trials)
    store = Store(tmp_path / "rows.jsonl", sources_digest())
    for one in rows_of(trials).values():
        store.append(Row(trial=one.trial, source=store.source, verdict=one.verdict, named=one.named))
    out = tmp_path / "settings.md"
    done = CliRunner().invoke(main, ["--rows", str(store.path), "--out", str(out), "--jobs", "1"])
    assert done.exit_code == 0, done.output
    assert "| 1 of 1 | 0 of 1 |" in out.read_text(encoding="utf-8")


def test_a_failure_is_no_sensitivity(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write no page where a trial failed, and say which and why."""
    trials = [trial("null", "none", 0)]
    monkeypatch.setattr("benchmarks.sensitivity.chosen", lambda: trials)
    monkeypatch.setattr("benchmarks.sensitivity.run_with_bar", lambda *_, **__: None)
    store = Store(tmp_path / "rows.jsonl", sources_digest())
    store.append(Row(trial=of("keep", 2.0), source=store.source, verdict="", error="ValueError: no"))
    out = tmp_path / "settings.md"
    done = CliRunner().invoke(main, ["--rows", str(store.path), "--out", str(out)])
    assert done.exit_code == 1
    assert "none with keep setting changed: ValueError: no" in done.output
    assert not out.exists()


def test_the_published_table_has_every_setting_as_it_is() -> None:
    """List name and default of every field, in order; `make sensitivity` writes the page anew."""
    lines = (ROOT / "docs" / "settings.md").read_text(encoding="utf-8").splitlines()
    rows = [line.split(" | ")[:2] for line in lines if line.startswith("| `")]
    assert rows == [[f"| `{name}`", f"{default:g}"] for name, default, *_ in Settings.described()]
