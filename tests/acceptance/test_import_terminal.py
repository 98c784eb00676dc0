"""`harness import` on a terminal: what it asks, what an answer is worth, and the command that asks nothing."""

from __future__ import annotations

import json
import os
import pty
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.recording import load_case
from tests.acceptance.test_import import call
from tests.importing import made

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("name", "answers", "asked_for", "typed"),
    [
        ("free.txt", "1\n", "1: --angle 'theta'  (it is the beam's angle)", "--angle 'theta'"),
        (
            "rigol.csv",
            "1\n1\nCH1:0.05 rad/V\nCH2:0.125 m/V-0.1\n",
            "1: --position 'CH2'",
            "--position 'CH2:0.125 m/V-0.1'",
        ),
    ],
)
def test_a_terminal_is_asked(tmp_path: Path, name: str, answers: str, asked_for: str, typed: str) -> None:
    """Ask on a terminal, take numbers and calibrations for answers, and tell the options that stand for them."""
    file = made.FILES[name][0](tmp_path / name)
    code, asked, shown = on_a_terminal(answers, file, "--out", tmp_path / "case")
    assert code == 0
    assert asked_for in asked
    assert typed in next(line for line in shown.splitlines() if "without questions" in line)
    assert typed in json.loads((tmp_path / "case" / "import.json").read_text())["command"]
    assert load_case(tmp_path / "case").recordings


def on_a_terminal(answers: str, *words: object) -> tuple[int, str, str]:
    """Exit code, what was asked and what was printed by a command with these answers typed into its terminal."""
    parent, child = pty.openpty()
    command = [sys.executable, "-m", "harness", "import", *map(str, words)]
    with subprocess.Popen(command, stdin=child, stdout=subprocess.PIPE, stderr=child, text=True) as process:
        os.close(child)
        os.write(parent, answers.encode())
        try:
            shown, _ = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:  # it asks for more than is answered
            process.kill()
            raise
    asked = os.read(parent, 16384).decode()
    os.close(parent)
    return process.returncode, asked, shown


def test_a_mistyped_answer_is_asked_for_again(tmp_path: Path) -> None:
    """Show what is wrong with it, and keep the answers before it."""
    file = made.rigol(tmp_path / "rigol.csv")
    answers = "1\n1\n0.05 rad/V\nCH1:0.05 furlong/V\nCH1:0.05 rad/V\nCH2:0.125 m/V-0.1\n"
    code, asked, shown = on_a_terminal(answers, file, "--out", tmp_path / "case")
    assert code == 0, asked
    assert "there is no column '0.05 rad/V'" in asked
    assert "'furlong' is no unit of the angle" in asked
    assert "add: --angle 'CH1:0.05 rad/V' --position 'CH2:0.125 m/V-0.1'" in shown


def test_an_answer_holds_for_its_file(tmp_path: Path) -> None:
    """Ask for each file, and print for each what it needs."""
    files = []
    for number, sign in enumerate((-1.0, 1.0, -1.0), start=1):
        time, angle, position = made.truth()
        files.append(tmp_path / f"{number}.csv")
        rows = np.column_stack((time, sign * angle, position))
        np.savetxt(files[-1], rows, delimiter=",", header="time_s,angle_rad,x_m", comments="", fmt="%.9f")
    code, _, shown = on_a_terminal("1\n2\n", *files, "--out", tmp_path / "case")
    assert code == 0
    lines = shown.splitlines()
    assert "rec_01.csv: to import 1.csv again without questions, in a command of its own, add: --flip-angle" in lines
    assert "rec_03.csv: to import 3.csv again without questions, in a command of its own, add: --flip-position" in lines
    recordings = load_case(tmp_path / "case").recordings
    for name, sign in (("rec_01.csv", 1.0), ("rec_02.csv", 1.0), ("rec_03.csv", -1.0)):
        np.testing.assert_allclose(recordings[name].angle, sign * made.truth()[1], atol=1e-8)


def test_the_command_to_repeat_is_valid(tmp_path: Path) -> None:
    """Leave out a flip that an answer took back."""
    file = made.labview(tmp_path / "log.lvm")
    code, _, shown = on_a_terminal("1\n", file, "--flip-angle", "--out", tmp_path / "case")
    assert code == 0
    assert "to import it again without questions, leave out: --flip-angle" in shown
    command = json.loads((tmp_path / "case" / "import.json").read_text())["command"]
    assert "flip" not in command
    assert call(*shlex.split(command)[2:], "--force").exit_code == 0


def test_the_end_of_the_input_is_no_answer(tmp_path: Path) -> None:
    """End with 2 and the options to give, and write nothing."""
    code, asked, _ = on_a_terminal("\x04", made.free_text(tmp_path / "free.txt"), "--out", tmp_path / "case")
    assert code == 2
    assert "error: " in asked
    assert "Give --angle 'theta'" in asked
    assert not (tmp_path / "case").exists()
