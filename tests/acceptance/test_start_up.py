"""What need not wait does not: help and the answer to a bad input come before anything heavy is imported."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.acceptance.short import write_short_case

ENGINES_AND_PICTURES = {"mujoco", "pybullet", "dartpy", "matplotlib"}
NOT_FOR_READING = {"numba", "pandas", "scipy.interpolate", "scipy.optimize", "scipy.signal", "scipy.stats"}
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


@pytest.mark.parametrize("command", [("--help",), ("run", "nothing"), ("diagnose", "nothing"), ("predict", "no", "no")])
def test_help_and_missing_files_are_answered_without_the_heavy_half(tmp_path: Path, command: tuple[str, ...]) -> None:
    """Import no engine, no plots, no compiler and no optimiser to say that there is no such file."""
    found = modules(tmp_path, *command, code=0 if command == ("--help",) else 2)
    assert not found & (ENGINES_AND_PICTURES | NOT_FOR_READING)


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
