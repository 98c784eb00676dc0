"""Commands survive signals, full disks and failing parts, and what was tried is counted."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import numpy as np
import pytest

from benchmarks.faults.__main__ import section
from benchmarks.faults.scene import MINE, Scene
from benchmarks.faults.trials import COMMANDS, Trial, disk, signals


@pytest.mark.slow
def test_a_dozen_faults_are_survived(tmp_path: Path) -> None:
    """Lose nothing and mix nothing at a signal to each command, and a disk that is full once for each that writes."""
    scene, generator = Scene.of(tmp_path), np.random.default_rng(7)
    trials = list(chain(signals(scene, len(COMMANDS), generator), disk(scene, 1, generator)))
    assert len(trials) == len(COMMANDS) + len(COMMANDS) - 1  # replay writes nothing
    assert [one for one in trials if one.wrong] == []


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
    text = section(trials, seed=0)
    assert "| SIGINT | `run` | 2 | 1: 1, 130: 1 | 1 |" in text
    assert "- SIGINT, `run`, 1.50 of 2.00 s: exit code 1 instead of 130" in text
