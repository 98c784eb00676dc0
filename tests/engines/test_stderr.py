"""An engine that is imported or run writes nothing that a user did not ask for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.engines.stderr import STDERR, without_lines

ROOT = Path(__file__).resolve().parents[2]
RUN = """
import numpy as np
from analytic.motion import State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of
from tests.motions import Sines
engine_of("pybullet").run(Rig(), Sines(), State(0.36, 0.0), np.linspace(0.0, 0.1, 11))
"""


def written_by(script: str, redirect: str = "") -> tuple[int, str]:
    """Exit code and all that a fresh interpreter writes, stdout and stderr."""
    command = ["sh", "-c", f'exec "$0" -c "$1" {redirect}', sys.executable, script]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(
        command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    return done.returncode, done.stdout


@pytest.mark.slow
def test_a_run_in_pybullet_is_silent() -> None:
    """Import PyBullet's greeting away and run, in a fresh interpreter: not one byte comes out."""
    assert written_by(RUN) == (0, "")


@pytest.mark.slow
def test_closed_stderr_is_no_obstacle() -> None:
    """Run where the standard error is closed, as under some service managers."""
    assert written_by(RUN, "2>&-") == (0, "")


@without_lines(b"greeting")
def greet_and_fail() -> None:
    """A library that greets, warns and fails."""
    os.write(STDERR, b"greeting of a library\nwarning of the library\n")
    raise ImportError


def test_only_the_named_lines_are_dropped(capfd: pytest.CaptureFixture[str]) -> None:
    """Keep what else is written meanwhile, also when the block raises, and everything written afterwards."""
    with pytest.raises(ImportError):
        greet_and_fail()
    os.write(STDERR, b"greeting again\n")
    assert capfd.readouterr().err == "warning of the library\ngreeting again\n"
