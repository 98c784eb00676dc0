"""Runs the command as a user does, in a folder of its own."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner

from harness.cli.main import main


@dataclass(frozen=True)
class Outcome:
    """What a command came back with: exit code, stdout, stderr, and the folder it ran in."""

    code: int
    out: str
    err: str
    folder: Path

    @property
    def errors(self) -> list[str]:
        """Messages on stderr: lines that are no progress."""
        return [line for line in self.err.splitlines() if line and not line.startswith("[")]


Harness = Callable[..., Outcome]


def call(folder: Path, *arguments: object) -> Outcome:
    """Run `harness` with these arguments in `folder`."""
    script = Path(sys.executable).with_name("harness")
    command = [str(script)] if script.exists() else [sys.executable, "-m", "harness"]
    done = subprocess.run(
        [*command, *map(str, arguments)], cwd=folder, capture_output=True, text=True, encoding="utf-8", check=False
    )
    return Outcome(done.returncode, done.stdout, done.stderr, folder)


@pytest.fixture
def process(tmp_path: Path) -> Harness:
    """Runs the command in an empty folder, in a process of its own."""
    work = tmp_path / "work"
    work.mkdir()
    return lambda *arguments: call(work, *arguments)


@pytest.fixture
def harness(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Harness:
    """Runs the command in an empty folder, in this process: the same but for some seconds of imports."""
    work = tmp_path / "work"
    work.mkdir()

    def invoke(*arguments: object) -> Outcome:
        monkeypatch.chdir(work)
        words = [str(word) for word in arguments]
        monkeypatch.setattr(sys, "argv", ["harness", *words])
        done = CliRunner().invoke(main, words)
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            raise done.exception
        return Outcome(done.exit_code, done.stdout, done.stderr, work)

    return invoke


@pytest.fixture(scope="session")
def bundled_run(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """`harness run` without any argument."""
    return call(tmp_path_factory.mktemp("bundled"), "run")
