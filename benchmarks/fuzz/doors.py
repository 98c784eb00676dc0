"""The doors through which a user's input comes in, and what has to be true of whatever comes out of them.

A door opens, or refuses with one message and its exit code. Anything else is a `Broken`: another exception, several
messages or a traceback, more than `LONGEST` seconds, or a file of the user that is changed or gone.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np
from click.testing import CliRunner

from harness.api.case import load_case
from harness.api.effects import beside_catalogue
from harness.api.saved import load_diagnosis
from harness.cli.main import main
from harness.errors import HarnessError
from harness.identify.record import FILE
from harness.recording import load_recording

SEEDS = Path(__file__).parent / "seeds"
CSV, RIG, EFFECTS = "rec_01.csv", "rig.toml", "mine.py"
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


def through_command(folder: Path, words: Sequence[str]) -> Outcome:
    """Run a command in the folder as a shell does."""
    before = Path.cwd()
    os.chdir(folder)
    try:
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
