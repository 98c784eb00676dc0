"""`harness doctor`, shell completion, colours and --quiet, as a user meets them."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from harness.api import doctor
from harness.api.doctor import Doctor, Finding
from harness.cli.completion import SHELLS
from harness.cli.main import main
from harness.errors import InputError
from harness.viewing import offscreen
from harness.viewing.offscreen import try_contexts
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case


@pytest.mark.slow
def test_this_machine_is_examined(harness: Harness) -> None:
    """Load and run the engines, list versions, and end with 0 where the tests themselves run."""
    done = harness("doctor", "--json")
    assert done.code == 0, done.out
    found = {one["name"]: one for one in json.loads(done.out)["findings"]}
    for name in ("engine mujoco", "engine pybullet"):
        assert found[name]["ok"], found[name]
        assert "loads and runs" in found[name]["text"]
    assert {"python", "numpy", "OpenGL", "cores", "memory", "cache of kernels", "temporary folder"} <= set(found)
    assert found["video encoder"]["ok"], found["video encoder"]
    kind = try_contexts().kind
    assert found["offscreen rendering"]["ok"] == bool(kind)
    assert found["offscreen rendering"]["text"].endswith(kind)


@pytest.mark.slow
def test_an_engine_that_does_not_load_is_told(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    """End with 1, name the engine and say what to do."""
    failed = Finding("engine mujoco", False, "cannot be loaded", "run `make setup`")
    monkeypatch.setattr(doctor, "_engine", lambda name: failed)
    done = harness("doctor")
    assert done.code == 1
    assert "not ok  engine mujoco" in done.out
    assert "make setup" in done.out


@pytest.mark.slow
def test_where_nothing_can_be_drawn_doctor_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Name the kind of context that failed, and stay fit: only videos need one."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("MUJOCO_GL", "glfw")  # which needs a display
    rendering, _ = doctor._videos()
    assert not rendering.ok
    assert "glfw" in rendering.text
    assert "libegl1" in rendering.remedy
    assert Doctor((rendering,)).fit


def test_a_driver_that_crashes_ends_only_its_own_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Go on to the next kind, and tell how each process ended."""
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(offscreen, "_TRIAL", "import os; os.abort()  # {kind}")
    tried = try_contexts()
    assert tried.kind == ""
    assert dict(tried.faults) == dict.fromkeys(offscreen.KINDS, f"ended with -{signal.SIGABRT.value}")


def test_a_job_that_crashes_is_a_finding() -> None:
    """Say so, and what to do, where the process that was to examine something is gone."""
    failed = Finding("drawing", False, "drew nothing", "do something", needed=False)
    found = doctor._tried(failed, lambda _: Finding("drawing", True, "draws"), 60.0, os.abort)
    assert found == replace(failed, text="crashed the process that ran it")


def test_what_is_optional_does_not_fail() -> None:
    """Stay fit when only something optional is missing, and name it."""
    made = Doctor((Finding("engine dart", False, "no libGL", "install it", needed=False),))
    assert made.fit
    assert "engine dart" in made.sentence


@pytest.mark.slow
def test_a_variable_that_keeps_mujoco_out_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Say what to do about MUJOCO_GL, and not to install what is installed."""
    monkeypatch.setenv("MUJOCO_GL", "bogus")
    for found in (doctor._engine("mujoco"), *doctor._videos()):
        assert not found.ok
        assert "MUJOCO_GL=bogus" in found.text
        assert "unset this variable" in found.text
        assert found.remedy == ""


def test_every_extra_is_listed_as_installed_or_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Name a package that is not installed with its extra, and stay fit without it."""
    extras = set(metadata("ball-beam-harness").get_all("Provides-Extra") or [])
    assert set(doctor.EXTRAS) == extras - {"dart", "dev", "sysid", "test"}

    def without_h5py(name: str) -> str:
        if name == "h5py":
            raise PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr(doctor, "version", without_h5py)
    found = {one.name: one for one in doctor._extras()}
    assert {"openpyxl [files]", "mat-io [matlab]", "rosbags [ros]", "distributed [dask]"} <= set(found)
    missing = found["h5py [files]"]
    assert not missing.ok
    assert "pip install 'ball-beam-harness[files]'" in missing.remedy
    assert Doctor((missing,)).fit
    assert "h5py [files]" in Doctor((missing,)).sentence


def test_a_missing_choice_is_told_in_one_line(harness: Harness) -> None:
    """List what there is to choose from as text, not with escaped line breaks."""
    done = harness("completion")
    assert done.code == 2
    assert "Choose from: bash, zsh, fish" in done.err


def test_an_unknown_engine_raises() -> None:
    """Raise what the engine's loader says rather than pass."""
    with pytest.raises(InputError, match="no engine"):
        doctor.run_steps("bullet9")


@pytest.mark.parametrize("shell", SHELLS)
def test_completion_scripts_are_printed(shell: str, harness: Harness) -> None:
    """Print a script that asks `harness` itself, valid in the shell where that is installed."""
    done = harness("completion", shell)
    assert done.code == 0
    assert "_HARNESS_COMPLETE" in done.out
    if shutil.which(shell):
        checked = subprocess.run([shell, "-n"], input=done.out, text=True, capture_output=True, check=False)
        assert checked.returncode == 0, checked.stderr


def completed(*words: str) -> list[tuple[str, str]]:
    """What a shell offers for the last of these words: kind and text of each."""
    *before, last = words
    made = ShellComplete(main, {}, "harness", "_HARNESS_COMPLETE").get_completions(list(before), last)
    return [(one.type, one.value) for one in made]


def test_commands_options_and_cases_complete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Offer commands, options and bundled cases beside what begins so here; leave other paths to the shell."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "open_loop").mkdir()
    (tmp_path / "opened.csv").touch()
    (tmp_path / ".open").touch()
    assert ("plain", "diagnose") in completed("diag")
    assert ("plain", "--quiet") in completed("diagnose", "--qu")
    offered = [("plain", name) for name in ("open_ball_beam", "open_loop/", "opened.csv")]
    assert completed("check", "open") == offered
    assert completed("check", "open_loop/re")[0][0] == "file"
    assert completed("predict", "reports/my")[0][0] == "file"


@pytest.mark.parametrize(
    ("word", "offered"), [("paper", "paper_protocol"), ("o", "open_ball_beam our_rig/"), ("our_rig/", "")]
)
def test_bash_offers_what_it_is_given(tmp_path: Path, word: str, offered: str) -> None:
    """Complete a word in bash by the script itself; an empty offer is one that bash makes of paths."""
    (tmp_path / "our_rig").mkdir()
    (tmp_path / "bin").mkdir()
    command = tmp_path / "bin/harness"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m harness "$@"\n', encoding="utf-8")
    command.chmod(0o755)
    # compopt is for bash alone while it completes; here it only would say that this is no completion.
    script = (
        f'compopt() {{ :; }}; eval "$(harness completion bash)"; COMP_WORDS=(harness check {word}); COMP_CWORD=2; '
        '_harness_completion harness; echo "${COMPREPLY[*]}"'
    )
    path = f"{command.parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=tmp_path,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip().splitlines() == ([offered] if offered else [])


def test_no_colour_where_it_is_not_wanted(tmp_path: Path) -> None:
    """Draw progress in colour on a terminal, and without any under NO_COLOR."""
    script = (
        "import io, re; from rich.console import Console; from harness.api.progress import _bar\n"
        "out = io.StringIO(); console = Console(file=out, force_terminal=True, width=80)\n"
        "with _bar(console) as bar: bar.update(bar.add_task('x', total=1.0), completed=0.5, refresh=True)\n"
        "print(len(re.findall(r'\\x1b\\[[0-9;]*3[0-9][0-9;]*m', out.getvalue())))"
    )
    plain = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    plain |= {"TERM": "xterm-256color"}
    counts = [
        int(subprocess.run([sys.executable, "-c", script], env=env, capture_output=True, text=True, check=True).stdout)
        for env in (plain, plain | {"NO_COLOR": "1"})
    ]
    assert counts[0] > 0
    assert counts[1] == 0


@pytest.mark.parametrize("name", sorted(set(main.commands) - {"completion", "doctor"}))
def test_every_command_that_makes_something_can_be_quiet(name: str) -> None:
    """Take --quiet, so that a script can give it to all of them."""
    assert any("--quiet" in one.opts for one in main.commands[name].params)


@pytest.mark.slow
def test_a_quiet_run_prints_the_answer_and_the_report(harness: Harness, tmp_path: Path) -> None:
    """Print two lines and no progress, and write the same files."""
    case = write_short_case(tmp_path / "case")
    done = harness("run", case, "--quiet", "--engine", "mujoco", "--out", tmp_path / "out")
    assert done.code == 0, done.err
    assert done.err == ""
    answer, report = done.out.splitlines()
    assert answer
    assert report == f"report: {tmp_path / 'out' / 'report.html'}"
    assert (tmp_path / "out" / "metrics.csv").is_file()
