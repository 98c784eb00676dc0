"""What need not wait does not: help and the answer to a bad input come before anything heavy is imported."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.acceptance.short import write_short_case

ENGINES_AND_PICTURES = {"mujoco", "pybullet", "dartpy", "matplotlib"}
NOT_FOR_READING = {"numba", "pandas", "scipy"}
# Modules in memory when the first line is written, and the processor time that they take: half a second, of which twice
# as much is measured where other processes share caches and clock. Wall time would tell of these processes instead.
MOST_MODULES = 700
MOST_SECONDS = 2.0
SCRIPT = """
import json, sys
from harness.cli.main import main
sys.argv[0] = "harness"
try:
    main()
finally:
    print(json.dumps(sorted(sys.modules)), file=sys.__stdout__)
"""


def modules(folder: Path, *arguments: object, code: int) -> set[str]:
    """Modules that a command has imported when it ends."""
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == code, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


def processor_time_of_children() -> float:
    """Processor time of all processes that have been started and awaited [s]."""
    times = os.times()
    return times.children_user + times.children_system


@pytest.mark.slow
@pytest.mark.parametrize("command", [("--help",), ("run", "nothing"), ("diagnose", "nothing"), ("predict", "no", "no")])
def test_help_and_missing_files_are_answered_without_the_heavy_half(tmp_path: Path, command: tuple[str, ...]) -> None:
    """Import no engine, no plots, no compiler and no optimiser to say that there is no such file."""
    found = modules(tmp_path, *command, code=0 if command == ("--help",) else 2)
    assert not found & (ENGINES_AND_PICTURES | NOT_FOR_READING)


FIRST_LINE = """
import os, sys
class First:
    encoding, errors = "utf-8", "strict"
    def isatty(self): return False
    def fileno(self): return 2
    def flush(self): pass
    def write(self, text):
        print(len(sys.modules), text, file=sys.__stdout__, flush=True)
        os._exit(0)
sys.stderr = First()
from harness.cli.main import main
main(prog_name="harness")
"""


@pytest.mark.parametrize("command", ["run", "diagnose"])
def test_the_first_line_comes_before_the_heavy_half(tmp_path: Path, command: str) -> None:
    """Tell the first step with a few hundred modules imported, before the engines and the compiler."""
    case = write_short_case(tmp_path / "case")
    call = [sys.executable, "-c", FIRST_LINE, command, str(case), "--out", str(tmp_path / "out")]
    before = processor_time_of_children()
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    assert processor_time_of_children() - before < MOST_SECONDS
    count, _, text = done.stdout.partition(" ")
    assert text.startswith("[")
    assert int(count) < MOST_MODULES


@pytest.mark.slow
@pytest.mark.parametrize("command", ["run", "diagnose"])
def test_a_bad_recording_is_answered_without_the_heavy_half(tmp_path: Path, command: str) -> None:
    """Read every recording of a case before anything that would work on them is imported."""
    case = write_short_case(tmp_path / "case")
    file = case / "rec_01.csv"
    lines = file.read_text().splitlines()
    lines[41] = lines[41].replace(",", ",x", 1)
    file.write_text("\n".join(lines))
    found = modules(tmp_path, command, case, code=2)
    assert not found & (ENGINES_AND_PICTURES | NOT_FOR_READING)
