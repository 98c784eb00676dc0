"""Whole commands in processes of their own: a first run beside a later one, a diagnosis beside a fit."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from statistics import median

from benchmarks.growth.measure import Time, diagnosis_time, run
from benchmarks.performance.pairs import Pair

_STEP = re.compile(r"^\[ *([0-9.]+) s\] (.*)$", re.MULTILINE)
# Which part of a diagnosis begins with a line of its progress; what matches none goes on with the part before.
_PARTS = (
    ("search", r"fit|screening|spline"),
    ("held-out errors", r"prediction errors|.* held out"),
    ("next experiment", r"design"),
    ("baselines", r"baselines"),
    ("engines", r"mujoco|pybullet"),
    ("report", r"report"),
)
_START = "start and reading"


def first_against_later(pairs: int, folder: Path) -> list[Pair]:
    """Processor time of `harness run` with caches as `make setup` leaves them, and of the run after it.

    Machine code and Python's bytecode come from folders of their own, which `harness compile` fills once; each first
    run has a fresh copy.
    """
    command = [sys.executable, "-m", "harness", "run", "--force", "--out", str(folder / "report")]
    run([sys.executable, "-m", "harness", "compile"], _caches(folder / "set_up"))
    made = []
    for _ in range(pairs):
        copy = folder / "copy"
        shutil.copytree(folder / "set_up", copy)
        first = run(command, _caches(copy))
        later = run(command, _caches(copy))
        made.append(Pair(first.cpu, later.cpu))
        shutil.rmtree(copy)
    return made


def _caches(folder: Path) -> dict[str, str]:
    return {"NUMBA_CACHE_DIR": str(folder / "kernels"), "PYTHONPYCACHEPREFIX": str(folder / "bytecode")}


def diagnosis_against_fit(pairs: int, case: Path, folder: Path) -> tuple[list[Pair], str]:
    """Processor time of `harness diagnose` and of one fit of four parameters by `mujoco.sysid`, and what took it."""
    made, ours = [], []
    for _ in range(pairs):
        ours.append(diagnosis_time(case, folder / "diagnosed"))
        theirs = run([sys.executable, "-m", "benchmarks.growth.by_sysid", str(case)])
        made.append(Pair(ours[-1].cpu, theirs.cpu))
    return made, parts_of(ours)


def diagnoses(count: int, case: Path, folder: Path) -> tuple[list[float], str]:
    """Processor times of `harness diagnose` [s], and what took them."""
    times = [diagnosis_time(case, folder / "diagnosed") for _ in range(count)]
    return [one.cpu for one in times], parts_of(times)


def parts_of(times: Iterable[Time]) -> str:
    """Shares of the parts of a diagnosis in its time on the wall, largest first, from what it told meanwhile."""
    shares: dict[str, list[float]] = {}
    for one in times:
        for part, seconds in _seconds(one).items():
            shares.setdefault(part, []).append(seconds / one.wall)
    parts = sorted(((median(values), part) for part, values in shares.items()), reverse=True)
    return ", ".join(f"{part} {100.0 * share:.0f} %" for share, part in parts)


def functions_of(case: Path, folder: Path) -> str:
    """Shares of functions in the processor time of `harness diagnose`, in words, from a run of its own."""
    command = [sys.executable, "-m", "benchmarks.performance.sampled", str(case), str(folder / "sampled")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    text: str = json.loads(done.stdout.splitlines()[-1])
    return text


def _seconds(taken: Time) -> dict[str, float]:
    """Of each part [s]; progress is told some time after the process began: that is part of the start."""
    lines = [(float(at), text) for at, text in _STEP.findall(taken.told)]
    if not lines:
        return {_START: taken.wall}
    # The last line is the report's; a process ends as soon as that is written.
    ends = [at for at, _ in lines[1:]]
    late = taken.wall - lines[-1][0]
    seconds, part = {_START: 0.0}, _START
    for (at, text), end in zip(lines, [*ends, lines[-1][0]], strict=True):
        part = next((name for name, start in _PARTS if re.match(start, text)), part)
        seconds[part] = seconds.get(part, 0.0) + end - at
    # Of what no line is about, the imports before the first and the report after the last, no more is known.
    seconds["imports and report"] = late + seconds.pop("report", 0.0)
    return seconds
