"""Simulated cases of growing size: the first of many recordings, or the first seconds of a long one."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path

from harness.simulator import Experiment, write_case

HIDDEN = {"viscous_damping": {"coefficient": 0.03}}
"""What the harness has to find: the effect of the shared case `viscous`, at its size."""
LENGTH = 16.0
"""Of each of many recordings [s]."""
_SEED = 20
_HEAD = 1  # lines of a CSV before its readings


@dataclass(frozen=True)
class Size:
    """Of a case: how many recordings of which length [s] there are to identify from."""

    recordings: int
    length: float

    @property
    def title(self) -> str:
        """In words."""
        return f"{self.recordings} × {self.length:g} s"


def write_sizes(folder: Path, sizes: list[Size]) -> dict[Size, Path]:
    """A case of each size; those of one length share their first recordings, and single ones their first seconds."""
    many = max((size.recordings for size in sizes if size.recordings > 1), default=0)
    longest = max((size.length for size in sizes if size.recordings == 1), default=0.0)
    sources = {}
    if many:
        sources[True] = folder / "many"
        write_case(sources[True], Experiment(hidden=HIDDEN, duration=LENGTH, identify=many, predict=0, seed=_SEED))
    if longest:
        sources[False] = folder / "long"
        write_case(sources[False], Experiment(hidden=HIDDEN, duration=longest, identify=1, predict=0, seed=_SEED))
    return {
        size: _part(folder / f"{size.recordings}x{size.length:g}", sources[size.recordings > 1], size) for size in sizes
    }


def _part(folder: Path, source: Path, size: Size) -> Path:
    """The case with the first recordings of another, and of these the first seconds."""
    rig = (source / "rig.toml").read_text(encoding="utf-8")
    names = [one.name for one in sorted(source.glob("*.csv"))][: size.recordings]
    folder.mkdir()
    for name in names:
        lines = (source / name).read_text(encoding="utf-8").splitlines(keepends=True)
        first = float(lines[_HEAD].split(",")[0])
        kept = [line for line in lines[_HEAD:] if float(line.split(",")[0]) - first <= size.length]
        (folder / name).write_text("".join(lines[:_HEAD] + kept), encoding="utf-8", newline="\n")
    listed = re.sub(r"(?m)^identify = .*$", f"identify = {json.dumps(names)}", rig)
    (folder / "rig.toml").write_text(listed, encoding="utf-8", newline="\n")
    return folder
