"""The doors through which a user's input comes in, and what has to be true of whatever comes out of them.

A door opens, or refuses with one message and its exit code. Anything else is a `Broken`: another exception, several
messages or a traceback, more than `LONGEST` seconds, or a file of the user that is changed or gone.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any
from unittest.mock import patch

import numpy as np
from click.testing import CliRunner

from harness import provenance
from harness.api.case import load_case
from harness.api.effects import beside_catalogue
from harness.api.importing import import_recording
from harness.api.saved import load_diagnosis
from harness.api.scene import check_scene
from harness.cli.main import main
from harness.engines.catalogue import engine_of, parameters_of, read_settings
from harness.errors import HarnessError
from harness.identify.record import FILE
from harness.recording import load_recording
from harness.recording.rig_changes import with_rig_changes
from harness.sweeps import plan_of, read_spec
from harness.sweeps.carry_out import total_seconds

SEEDS = Path(__file__).parent / "seeds"
CSV, RIG, EFFECTS = "rec_01.csv", "rig.toml", "mine.py"
FOREIGN, SWEEP, SETTINGS, MJCF, URDF = "log.dat", "sweep.toml", "tuned.toml", "own.xml", "own.urdf"
LONGEST = 10.0  # a door may take [s]
CODES = {0: "result", 1: "no", 2: "refused", 3: "failed"}
# What `click` writes beside the one line that says what is wrong.
_USAGE = ("Usage: ", "Try ")


class Broken(AssertionError):
    """What came out of a door is neither a result nor one message."""


class TooSlow(BaseException):
    """A door took longer than it may; no handler of `Exception` catches it."""


@dataclass(frozen=True)
class Outcome:
    """What a door came back with: its exit code, and its message where it refused."""

    code: int
    message: str = ""

    @property
    def kind(self) -> str:
        """The exit code in a word: result, no, refused or failed."""
        return CODES[self.code]


def seed(name: str) -> bytes:
    """A good input."""
    return (SEEDS / name).read_bytes()


def through_csv(folder: Path) -> Outcome:
    """Read a folder with the recording alone, and the recording by itself."""
    read = load_recording(folder / CSV)
    if not (np.all(np.diff(read.time) > 0.0) and np.isfinite(read.angle).all()):
        raise Broken("the recording has stamps that do not increase, or angles that are not finite")
    load_case(folder / CSV)
    return Outcome(0)


def through_case(folder: Path) -> Outcome:
    """Read a folder with rig.toml and a recording."""
    load_case(folder).summary()
    return Outcome(0)


def through_diagnosis(folder: Path) -> Outcome:
    """Read a diagnosis, show it, predict with it."""
    kept = load_diagnosis(folder / FILE)
    kept.summary()
    table = kept.predict(folder / CSV)
    if not np.isfinite(table.to_numpy()).all():
        raise Broken("a prediction is not finite")
    return Outcome(0)


def through_effects(folder: Path) -> Outcome:
    """Take effects of the user's own into the catalogue, and out again."""
    with beside_catalogue([folder / EFFECTS]):
        return Outcome(0)


def through_import(folder: Path) -> Outcome:
    """Import a file, and read the case that came of it."""
    options: dict[str, Any] = {"angle": "CH1:0.05 rad/V", "position": "CH2:0.125 m/V-0.1"}
    volts = b"CH1" in (folder / FOREIGN).read_bytes()
    # The record's hash of all code takes seconds, and is always the same.
    with patch.object(provenance, "code_digest", _code_digest):
        import_recording(folder / FOREIGN, out=folder / "new", **(options if volts else {}))
    try:
        load_case(folder / "new")
    except HarnessError as error:
        raise Broken(f"what was imported cannot be read: {error}") from None
    return Outcome(0)


_whole_digest = provenance.code_digest


@cache
def _code_digest() -> str:
    return _whole_digest()


def through_sweep(folder: Path) -> Outcome:
    """Read a sweep.toml, and plan its runs."""
    plan = plan_of(read_spec(folder / SWEEP))
    if not total_seconds(plan) >= 0.0 or not len(plan):
        raise Broken("a sweep has no runs, or takes no time that can be told")
    plan.run(len(plan) - 1)
    return Outcome(0)


def through_settings(folder: Path) -> Outcome:
    """Read settings of engines and changes of the rig, and apply them to both."""
    for engine, settings in read_settings(folder / SETTINGS, ()).items():
        parameters_of(engine_of(engine), settings)
    with_rig_changes(load_case(folder / CSV), folder / SETTINGS)
    return Outcome(0)


def through_scene(folder: Path) -> Outcome:
    """Load and measure a scene, in a process of its own: what an engine does to it must not end the search."""
    file = next(one for one in (folder / MJCF, folder / URDF) if one.exists())
    return _in_a_child(lambda: Outcome(0 if (made := check_scene(file)).fit else 1, "" if made.fit else made.sentence))


def _in_a_child(work: Callable[[], Outcome]) -> Outcome:
    """What a forked process made of it.

    Raises:
        HarnessError: as the child did.
        Broken: the child raised something else, or a signal ended it.
    """
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        try:
            made: Outcome | str = work()
        except HarnessError as error:
            made = Outcome(error.exit_code, str(error))
        except BaseException as error:
            made = f"{type(error).__name__}: {error}"
        with os.fdopen(writer, "wb") as pipe:
            pickle.dump(made, pipe)
        os._exit(0)
    os.close(writer)
    try:
        # The timer of the processor's time counts this process alone.
        late = threading.Timer(3.0 * LONGEST, os.kill, (child, signal.SIGKILL))
        late.start()
        with os.fdopen(reader, "rb") as pipe:
            said = pipe.read()
    finally:
        _, status = os.waitpid(child, 0)
        late.cancel()
    if not said:
        raise Broken(f"the process ended by signal {os.WTERMSIG(status)}, or after {3.0 * LONGEST:g} s")
    result = pickle.loads(said)
    if isinstance(result, str):
        raise Broken(result)
    return Outcome(result.code, result.message)


def through_command(folder: Path, words: Sequence[str]) -> Outcome:
    """Run a command in the folder as a shell does."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        with patch.object(provenance, "code_digest", _code_digest):
            done = CliRunner().invoke(main, list(words))
    finally:
        os.chdir(before)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    if done.exit_code not in CODES:
        raise Broken(f"exit code {done.exit_code}: {done.stderr}")
    if done.exit_code == 0:
        return Outcome(0)
    said = [line for line in done.stderr.splitlines() if line and not line.startswith((*_USAGE, "[", "warning: "))]
    if len(said) != 1 and done.exit_code != 3:
        raise Broken(f"{len(said)} messages: {done.stderr!r}, {done.stdout!r}")
    return Outcome(done.exit_code, said[0] if said else done.stdout)


DOORS: dict[str, Callable[[Path], Outcome]] = {
    "csv": through_csv,
    "case": through_case,
    "diagnosis": through_diagnosis,
    "effects": through_effects,
    "import": through_import,
    "sweep": through_sweep,
    "settings": through_settings,
    "scene": through_scene,
}
"""Doors that take files; `through_command` takes words besides."""


def outcome(door: Callable[[Path], Outcome], files: Mapping[str, bytes], *, replaced: Sequence[str] = ()) -> Outcome:
    """What comes out of a door with these files in a folder of their own.

    Args:
        door: takes the folder.
        files: their bytes by name.
        replaced: names of files that the door is asked to replace.

    Raises:
        Broken: it is neither a result nor one message, or a file is not what it was.
    """
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name)
        for file, content in files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        try:
            with _time_limit():
                made = door(folder)
        except HarnessError as error:
            made = Outcome(error.exit_code, str(error))
        except Broken:
            raise
        except TooSlow:
            raise Broken(f"takes more than {LONGEST:g} s") from None
        except (Exception, SystemExit) as error:
            raise Broken(f"{type(error).__name__}: {error}") from error
        if made.code and not 0 < len(made.message.strip().splitlines()) <= 1:
            raise Broken(f"the message has no line or several: {made.message!r}")
        for file, content in files.items():
            path = folder / file
            if file not in replaced and not (path.is_file() and path.read_bytes() == content):
                raise Broken(f"{file} has been changed, or is gone")
        left = [one.name for one in folder.rglob("*") if one.name.startswith(".unfinished")]
        if left:
            raise Broken(f"leaves {', '.join(left)} behind")
        return Outcome(made.code, made.message.replace(str(folder), "…"))


def _stop(number: int, frame: FrameType | None) -> None:
    raise TooSlow


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    """`TooSlow` after `LONGEST` seconds of the processor, which another process does not take; in the main thread."""
    if threading.current_thread() is not threading.main_thread() or sys.platform == "win32":
        yield
        return
    before = signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)
