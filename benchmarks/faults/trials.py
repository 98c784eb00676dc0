"""Faults, one at a time, and what came out."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
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


@dataclass(frozen=True)
class Planned:
    """A fault that is to be put into a command.

    Attributes:
        spec: tells it apart from all others of one seed.
        command: that it is put into.
        carry_out: puts it in; takes the scene, and the time [s] and the file operations that the command takes.
    """

    spec: str
    command: str
    carry_out: Callable[[Scene, float, int], Trial]


def carried_out(
    scene: Scene, planned: Iterable[Planned], kept: Mapping[str, Trial], until: float
) -> Iterator[tuple[Planned, Trial, bool]]:
    """Every planned trial with its outcome, and whether it is new; those that are kept are not tried again.

    Args:
        scene: that it is done in; a command is prepared where a trial of it is missing.
        planned: the trials of one command after each other.
        kept: outcomes by `Planned.spec`.
        until: no trial is begun after this time (`time.monotonic`) [s].
    """
    ready, took, operations = "", 0.0, 0
    for one in planned:
        if one.spec in kept:
            yield one, kept[one.spec], False
        elif time.monotonic() < until:
            if one.command != ready:
                (took, operations), ready = scene.prepare(one.command), one.command
            yield one, one.carry_out(scene, took, operations), True


def signals(instants: int, seed: int) -> Iterator[Planned]:
    """Signals at random times and at random file operations, half of each, spread over commands and signals."""
    for number, command in enumerate(COMMANDS):
        count = instants // len(COMMANDS) + (number < instants % len(COMMANDS))
        for turn in range(count):
            sent = SIGNALS[(turn + number) % len(SIGNALS)]
            share = float(np.random.default_rng([seed, 0, number, turn]).uniform())
            yield Planned(
                f"{sent.name} {command} {turn} of seed {seed}", command, partial(_signal, command, turn, sent, share)
            )


def _signal(
    command: str, turn: int, sent: signal.Signals, share: float, scene: Scene, took: float, operations: int
) -> Trial:
    allowed = (128 + sent, ENDS.get(command, 0))
    again = turn % _LATER_CHECK == 0
    if turn % 2 and operations:
        at = 1 + int(share * operations)
        place, inside = f"file operation {at} of {operations}", f"signal:{sent.value}:{at}"
        return _trial(scene, sent.name, command, place, allowed, turn, inside, again=again)
    place, meddle = f"{share * took:.2f} of {took:.2f} s", _sends(sent, share * took)
    return _trial(scene, sent.name, command, place, allowed, turn, meddle=meddle, again=again)


def disk(each: int, seed: int) -> Iterator[Planned]:
    """A disk that is full from a random file operation on, and files that cannot grow beyond a random size."""
    for number, command in enumerate(COMMANDS):
        for turn in range(0 if command == "replay" else each):  # which writes nothing
            share = float(np.random.default_rng([seed, 1, number, turn]).uniform())
            yield Planned(f"disk full {command} {turn} of seed {seed}", command, partial(_full, command, turn, share))


def _full(command: str, turn: int, share: float, scene: Scene, took: float, operations: int) -> Trial:
    if turn % 2 == 0:
        at = 1 + int(share * operations)
        place, inside = f"file operation {at} of {operations}", f"full:{at}"
        allowed: tuple[int, ...] = (2, ENDS.get(command, 0))  # 0: nothing more was to be written after that operation
    else:
        size = 1 + int(share * (scene.sizes[command] - 1))
        place, inside, allowed = f"after {size} bytes", f"limit:{size}", (2,)
    return _trial(scene, "disk full", command, place, allowed, turn, inside, again=turn < 2)


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


def parts() -> Iterator[Planned]:
    """A killed worker, and engines that fail."""
    yield Planned("worker killed diagnose", "diagnose", _worker)
    for command in ("run", "diagnose"):
        for kind in ENGINES:
            for sent in (signal.SIGINT, signal.SIGTERM) if kind == "hangs" else (None,):
                spec = " ".join(["engine", kind, command, *([sent.name] if sent else [])])
                yield Planned(spec, command, partial(_engine, command, kind, sent))


def _worker(scene: Scene, took: float, operations: int) -> Trial:
    place = "as soon as it is there"
    return _trial(scene, "worker killed", "diagnose", place, (3,), 0, meddle=_kills_a_worker, again=True)


def _engine(command: str, kind: str, sent: signal.Signals | None, scene: Scene, took: float, operations: int) -> Trial:
    fault, inside = f"engine {kind}", f"engine:{kind}"
    if sent is None:
        return _trial(scene, fault, command, "each run", (3,), 0, inside, again=False)
    # Twice the time of the whole command: it is in the engine by then, on a slower machine, too.
    after = 2.0 * took + 5.0
    place = f"{sent.name} after {after:.0f} s"
    return _trial(scene, fault, command, place, (128 + sent,), 0, inside, _sends(sent, after), again=False)
