"""A command that is interrupted, terminated or killed: its exit code, and what is left."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

from harness.cli.termination import terminable
from harness.errors import Terminated
from tests.acceptance.short import write_short_case

ROOT = Path(__file__).parents[2]
SCRIPT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]["harness"]
AT_WORK = "fit"  # in the progress of a search


def begun(case: Path, out: Path) -> subprocess.Popen[str]:
    """A diagnosis whose search has begun."""
    command = [sys.executable, "-m", "harness", "diagnose", str(case), "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    assert process.stderr is not None
    for line in process.stderr:
        if AT_WORK in line:
            break
    return process


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code", "said"), [("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "terminated")])
def test_an_interrupt_leaves_nothing(tmp_path: Path, number: str, code: int, said: str) -> None:
    """End with the exit code of the signal and one message, and leave neither files nor folders."""
    process = begun(write_short_case(tmp_path / "case"), tmp_path / "out")
    process.send_signal(signal.Signals[number])
    _, errors = process.communicate(timeout=60)
    assert process.returncode == code
    assert [line for line in errors.splitlines() if not line.startswith("[")] == [f"error: {said}"]
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_what_a_kill_leaves_is_removed_by_the_next_command(tmp_path: Path) -> None:
    """Leave only a hidden folder behind a kill, which the next command that writes there removes."""
    case = write_short_case(tmp_path / "case")
    process = begun(case, tmp_path / "out")
    process.kill()
    process.communicate(timeout=60)
    (left,) = (tmp_path / "out").iterdir()
    assert left.name.startswith(".unfinished-")
    process = begun(case, tmp_path / "out")
    assert not left.exists()
    process.terminate()
    process.communicate(timeout=60)
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.slow
def test_no_process_outlives_its_killed_parent(tmp_path: Path) -> None:
    """End the processes of the engines with the command that is killed."""
    script = (
        "import os, sys, time\nfrom harness.parallel import side_by_side\n"
        "def job():\n    os.write(1, b'%d\\n' % os.getpid())\n    time.sleep(60)\n"
        "side_by_side([job, job], 2)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, "-c", script], env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    children = [int(process.stdout.readline()) for _ in range(2)]
    process.kill()
    process.wait()
    deadline = time.monotonic() + 30.0
    while any(Path(f"/proc/{child}").exists() for child in children) and time.monotonic() < deadline:
        time.sleep(0.05)
    states = [Path(f"/proc/{child}/stat") for child in children]
    assert all(not one.exists() or ") Z " in one.read_text() for one in states)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_process_that_hangs_does_not_keep_the_command_from_ending(number: str, code: int) -> None:
    """End at the first signal although an engine never returns, and end the engine's process, too."""
    script = (
        "import click, os, time\nfrom harness.cli.main import Friendly\nfrom harness.parallel import side_by_side\n"
        "def hang():\n    os.write(1, b'%d\\n' % os.getpid())\n    time.sleep(3600)\n"
        "group = Friendly('harness')\n"
        "@group.command()\ndef wait():\n    side_by_side([hang, hang], 2)\n"
        "group(['wait'])\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, "-c", script], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    children = [int(process.stdout.readline()) for _ in range(2)]
    process.send_signal(signal.Signals[number])
    try:
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == code
    assert len(errors.splitlines()) == 1
    assert not any(Path(f"/proc/{child}").exists() for child in children)


def test_an_interrupt_while_the_command_is_imported_is_told_as_any() -> None:
    """End with 130 and one message, without a traceback, before a command has begun."""
    script = (
        "import os, signal, sys\n"
        "class Interrupts:\n    def find_spec(self, name, path, target=None):\n"
        "        if name == 'click':\n            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Interrupts())\n"
        "from importlib.metadata import EntryPoint\n"
        f"EntryPoint('harness', {SCRIPT!r}, 'console_scripts').load()()\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


@pytest.mark.parametrize(("number", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_signal_that_becomes_another_error_is_told_as_the_signal(number: str, code: int) -> None:
    """End with the signal's code where a compiled module turns it into an ImportError."""
    script = (
        "import os, signal\nfrom harness.cli.main import Friendly\n"
        "group = Friendly('harness')\n"
        "@group.command()\ndef load():\n"
        f"    try:\n        os.kill(os.getpid(), signal.{number})\n"
        "    except BaseException as error:\n        raise ImportError('initialization failed') from error\n"
        "group(['load'])\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(("number", "raised"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)])
def test_a_signal_during_a_finaliser_is_not_lost(
    number: signal.Signals, raised: type[BaseException], capfd: pytest.CaptureFixture[str]
) -> None:
    """End the command, without a traceback, though Python drops what is raised while an object is finalised."""

    class Finalised:
        def __del__(self) -> None:
            signal.raise_signal(number)

    def work() -> None:
        with terminable():
            Finalised()
            time.sleep(5.0)

    with pytest.raises(raised):
        work()
    assert capfd.readouterr().err == ""
