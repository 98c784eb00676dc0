"""Faults, one at a time, and what came out."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.faults.scene import ENDS, Scene

COMMANDS = ("sweep", "tune", "check", "export", "import", "simulate", "predict", "run", "replay", "diagnose")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
ENGINES = ("throws", "returns NaN", "hangs")
_LATER_CHECK = 4  # every so many instants the command is repeated to its end


@dataclass(frozen=True)
class Trial:
    """A fault and what came of it.

    Attributes:
        fault: its kind.
        command: that it was put into.
        place: where in the command.
        code: exit code, as a shell gives it.
        ended: whether the command had come to its end before.
        wrong: what was not as it has to be, in words; empty if all was.
    """

    fault: str
    command: str
    place: str
    code: int
    ended: bool
    wrong: str


def _code(returned: int) -> int:
    """As a shell gives it: 128 + n for a process that a signal ended."""
    return returned if returned >= 0 else 128 - returned


def _judge(scene: Scene, command: str, done: subprocess.CompletedProcess[str], allowed: tuple[int, ...]) -> str:
    """What is wrong with the exit code or the messages; empty if nothing is."""
    code = _code(done.returncode)
    if code not in allowed:
        return f"exit code {code} instead of {' or '.join(map(str, allowed))}: {done.stderr[-500:]}"
    if "Traceback" in done.stderr:
        return f"a traceback: {done.stderr[-1500:]}"
    return ""


def _trial(
    scene: Scene,
    fault: str,
    command: str,
    place: str,
    allowed: tuple[int, ...],
    turn: int,
    inside: str = "none",
    meddle: Callable[[subprocess.Popen[str]], None] = lambda process: None,
    *,
    again: bool,
) -> Trial:
    arguments = scene.arguments(command, turn)
    before, read, hidden = scene.content(), scene.read(), set(scene.hidden())  # a kill before may have left something
    done = scene.run(arguments, inside, meddle)
    code = _code(done.returncode)
    whole = ENDS.get(command, 0)
    killed = code == 128 + signal.SIGKILL
    wrong = _judge(scene, command, done, allowed)
    stays = sorted(set(scene.hidden()) - hidden)
    if inside.startswith("full:"):  # where no file can be moved, none can be moved back: the next command moves them
        stays = [name for name in stays if not name.startswith(".finished-")]
    if not wrong and not killed and stays:
        wrong = f"{', '.join(stays)} is left"
    if not wrong and (alive := scene.processes()):
        wrong = f"{len(alive)} processes go on: {alive[0][:200]}"
    wrong = wrong or scene.wrong(command, before)
    if not wrong and scene.read() != read:
        wrong = "an input has been changed"
    if not wrong and again:
        # A sweep goes on where it was stopped.
        repeated = scene.run(arguments if command == "sweep" else scene.arguments(command, turn + 1))
        wrong = _judge(scene, command, repeated, (whole,)) or scene.wrong(command, {})
        if not wrong and (left := scene.hidden()):
            wrong = f"{', '.join(left)} is left by the next command"
        wrong = wrong and f"the next command: {wrong}"
    return Trial(fault, command, place, code, code == whole, wrong)


def _sends(number: int, after: float) -> Callable[[subprocess.Popen[str]], None]:
    def send(process: subprocess.Popen[str]) -> None:
        try:
            process.wait(after)
        except subprocess.TimeoutExpired:
            process.send_signal(number)

    return send


def signals(scene: Scene, instants: int, generator: np.random.Generator) -> Iterator[Trial]:
    """Signals at random times and at random file operations, half of each, spread over commands and signals."""
    for number, command in enumerate(COMMANDS):
        count = instants // len(COMMANDS) + (number < instants % len(COMMANDS))
        if not count:
            continue
        took, operations = scene.prepare(command)
        for turn in range(count):
            sent = SIGNALS[(turn + number) % len(SIGNALS)]
            again = turn % _LATER_CHECK == 0
            allowed = (128 + sent, ENDS.get(command, 0))
            if turn % 2 and operations:
                at = int(generator.integers(1, operations + 1))
                inside = f"signal:{sent.value}:{at}"
                yield _trial(
                    scene,
                    sent.name,
                    command,
                    f"file operation {at} of {operations}",
                    allowed,
                    turn,
                    inside,
                    again=again,
                )
            else:
                after = float(generator.uniform(0.0, took))
                yield _trial(
                    scene,
                    sent.name,
                    command,
                    f"{after:.2f} of {took:.2f} s",
                    allowed,
                    turn,
                    meddle=_sends(sent, after),
                    again=again,
                )


def disk(scene: Scene, each: int, generator: np.random.Generator) -> Iterator[Trial]:
    """A disk that is full from a random file operation on, and files that cannot grow beyond a random size."""
    for command in COMMANDS:
        if command == "replay":  # writes nothing
            continue
        _, operations = scene.prepare(command)
        largest = max(one.stat().st_size for one in scene.out.iterdir() if one.is_file())
        for turn in range(each):
            if turn % 2 == 0:
                at = int(generator.integers(1, operations + 1))
                # 0: nothing more was to be written after that operation
                yield _trial(
                    scene,
                    "disk full",
                    command,
                    f"file operation {at} of {operations}",
                    (2, ENDS.get(command, 0)),
                    turn,
                    f"full:{at}",
                    again=turn == 0,
                )
            else:
                size = int(generator.integers(1, largest))
                yield _trial(
                    scene, "disk full", command, f"after {size} bytes", (2,), turn, f"limit:{size}", again=turn == 1
                )


def _kills_a_worker(process: subprocess.Popen[str]) -> None:
    """Kill a process that the command has forked, as soon as there is one."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None:
        try:
            found = children.read_text(encoding="utf-8").split()
        except OSError:
            return
        for child in found:
            name = Path(f"/proc/{child}/cmdline")
            if name.exists() and b"benchmarks.faults.inside" in name.read_bytes():
                time.sleep(0.05)
                subprocess.run(["kill", "-9", child], check=False, capture_output=True)
                return
        time.sleep(0.005)


def parts(scene: Scene) -> Iterator[Trial]:
    """A killed worker, and engines that fail."""
    scene.prepare("diagnose")
    yield _trial(
        scene, "worker killed", "diagnose", "as soon as it is there", (3,), 0, meddle=_kills_a_worker, again=True
    )
    for command in ("run", "diagnose"):
        scene.prepare(command)
        for kind in ENGINES:
            fault = f"engine {kind}"
            inside = f"engine:{kind}"
            if kind == "hangs":
                for sent, after in ((signal.SIGINT, 20.0), (signal.SIGTERM, 20.0)):
                    place = f"{sent.name} after {after:.0f} s"
                    yield _trial(
                        scene, fault, command, place, (128 + sent,), 0, inside, _sends(sent, after), again=False
                    )
            else:
                yield _trial(scene, fault, command, "each run", (3,), 0, inside, again=False)
