"""Commands survive signals, full disks and failing parts, and what was tried is counted."""

from __future__ import annotations

import math
from itertools import chain
from pathlib import Path

import pytest

from benchmarks.faults.__main__ import section
from benchmarks.faults.scene import MINE, Scene
from benchmarks.faults.trials import COMMANDS, Trial, carried_out, disk, parts, signals


@pytest.mark.slow
def test_a_dozen_faults_are_survived(tmp_path: Path) -> None:
    """Lose nothing and mix nothing at a signal to each command, and a disk that is full once for each that writes."""
    planned = sorted(chain(signals(len(COMMANDS), seed=7), disk(1, seed=7)), key=lambda one: one.command)
    trials = [trial for _, trial, _ in carried_out(Scene.of(tmp_path), planned, {}, math.inf)]
    assert len(trials) == len(COMMANDS) + len(COMMANDS) - 1  # replay writes nothing
    assert [one for one in trials if one.wrong] == []


def test_trials_that_are_kept_are_not_made_again(tmp_path: Path) -> None:
    """Give kept outcomes back, and begin no trial after the time; every planned one has a name of its own."""
    planned = [*signals(20, seed=7), *disk(2, seed=7), *parts()]
    assert len({one.spec for one in planned}) == len(planned)
    kept = {planned[3].spec: Trial("SIGINT", "sweep", "1.00 of 2.00 s", 130, ended=False, wrong="")}
    made = list(carried_out(Scene(tmp_path), planned, kept, until=-math.inf))
    assert made == [(planned[3], kept[planned[3].spec], False)]


def test_a_mixture_and_a_loss_are_told(tmp_path: Path) -> None:
    """Call a folder wrong that holds one file of an earlier result and one of a new one, or lost the user's."""
    scene = Scene(tmp_path, {"run": [{"a": "1", "b": "1"}, {"a": "2", "b": "2"}]})
    scene.out.mkdir()
    (scene.out / MINE).write_text("mine", encoding="utf-8")
    assert scene.wrong("run", {}) == ""
    (scene.out / "a").write_text("half", encoding="utf-8")
    assert scene.wrong("run", {}) == "neither the earlier result nor a new one: a"
    assert scene.wrong("run", scene.content()) == ""
    (scene.out / MINE).unlink()
    assert scene.wrong("run", {}) == "a file of the user's is lost"


def test_what_was_not_survived_is_written() -> None:
    """Count exit codes and what was survived, and list what was not, in the page's own section."""
    trials = [
        Trial("SIGINT", "run", "1.00 of 2.00 s", 130, ended=False, wrong=""),
        Trial("SIGINT", "run", "1.50 of 2.00 s", 1, ended=False, wrong="exit code 1 instead of 130"),
    ]
    text = section(trials, seed=0, planned=5, source="0123456789ab")
    assert "| SIGINT | `run` | 2 | 1: 1, 130: 1 | 1 |" in text
    assert "- SIGINT, `run`, 1.50 of 2.00 s: exit code 1 instead of 130" in text
    assert "1 of 2 were survived. 3 more were planned and not made." in text
