"""`python -m benchmarks.faults.inside FAULT FOLDER ARGUMENT…`: the command `harness` with a fault inside its process.

Faults: `none`; `count`, which writes the number of file operations in FOLDER to stderr; `signal:NUMBER:AT`, a signal at
the file operation AT, counted from 1; `full:AT`, no space left from that operation on; `limit:BYTES`, the largest size
of a file; and `engine:KIND`, a MuJoCo that throws, returns NaN or hangs.

The file FOLDER.begun says that Python has started and the command begins. A file operation is the opening of a file to
write it, and the making, renaming or removing of a file or folder.
"""

from __future__ import annotations

import errno
import os
import resource
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_CHANGES = ("os.mkdir", "os.rename", "os.remove", "os.rmdir", "shutil.rmtree", "tempfile.mkdtemp")
_NEEDS_SPACE = ("open", "os.mkdir", "os.rename")


@dataclass
class Hook:
    """Counts the file operations of this process in a folder, and does something at one of them."""

    fault: str
    folder: str
    process: int
    count: int = 0

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        """As `sys.addaudithook` calls it."""
        if event not in _CHANGES and not (event == "open" and _writes(arguments)):
            return
        if os.getpid() != self.process or not isinstance(arguments[0], str | bytes | os.PathLike):
            return
        if not os.path.abspath(os.fsdecode(arguments[0])).startswith(self.folder):
            return
        self.count += 1
        kind, *numbers = self.fault.split(":")
        if kind == "signal" and self.count == int(numbers[1]):
            os.kill(self.process, int(numbers[0]))
        if kind == "full" and self.count >= int(numbers[0]) and event in _NEEDS_SPACE:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(arguments[0]))


def _writes(arguments: tuple[Any, ...]) -> bool:
    return bool(arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)) if isinstance(arguments[2], int) else False


def _break_engine(kind: str) -> None:
    from dataclasses import replace

    import numpy as np

    from harness.engines.mujoco import MuJoCo
    from harness.engines.protocol import Task

    original = MuJoCo.drive

    def drive(engine: MuJoCo, task: Task[Any]) -> Any:
        if kind == "throws":
            raise RuntimeError("the engine threw")
        if kind == "hangs":
            time.sleep(3600.0)
        track, samples = original(engine, task)
        return replace(track, along=np.full_like(track.along, np.nan)), samples

    MuJoCo.drive = drive  # type: ignore[assignment,method-assign]


def main() -> None:
    """Run the command."""
    fault, folder, *rest = sys.argv[1:]
    Path(f"{folder}.begun").touch()
    sys.argv = ["harness", *rest]
    kind, _, detail = fault.partition(":")
    if kind == "engine":
        _break_engine(detail)
    if kind == "limit":
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(detail), int(detail)))
    hook = Hook(fault, folder, os.getpid())
    if kind in ("count", "signal", "full"):
        sys.addaudithook(hook)
    from harness.__main__ import main as command

    try:
        command()
    finally:
        if kind == "count":
            print(f"operations: {hook.count}", file=sys.stderr)


if __name__ == "__main__":
    main()
