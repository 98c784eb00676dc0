"""PyBullet's window in a process of its own: where a window manager closes it, Xlib ends the process that it is in."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import traceback
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.motion import SplineMotion
from harness.errors import InputError
from harness.viewing.playback import Playback
from harness.viewing.player import Player
from harness.viewing.runs import ShownRun

_CLOSED, _CLOSED_BY_WINDOW_MANAGER, _NOT_OPENED, _RAISED = 0, 1, 4, 5  # exit codes; the second one is Xlib's own
_STEP = 0.005  # between angles of the beam that is drawn [s]


def show(playback: Playback, player: Player) -> None:
    """Show a playback until the window is closed.

    Raises:
        InputError: PyBullet's window does not open here, or its process crashed.
    """
    path = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [sys.executable, "-m", __name__],
        input=pickle.dumps((_plain(playback), player)),
        stdout=subprocess.DEVNULL,  # where JSON may go, PyBullet writes what OpenGL it has found
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, path))},
        check=False,
    )
    if done.returncode in (_CLOSED, _CLOSED_BY_WINDOW_MANAGER):
        return
    if done.returncode == _NOT_OPENED:
        raise InputError("PyBullet's window does not open here: give --video out.mp4")
    said = (done.stderr.decode(errors="replace").strip().splitlines() or [f"it ended with {done.returncode}"])[-1]
    raise InputError(f"PyBullet's window failed ({said}): give --video out.mp4")


def _plain(playback: Playback) -> Playback:
    """The same with motions of the beam that another process can read, also if a user's effect made them."""

    def plain(run: ShownRun) -> ShownRun:
        count = max(int((playback.end - playback.begin) / _STEP), 3)
        time = np.linspace(playback.begin, playback.end, count + 1)
        return replace(run, motion=SplineMotion(CubicSpline(time, run.motion.evaluate(time))))

    return replace(playback, runs=tuple(map(plain, playback.runs)))


def _main() -> int:
    """Show what is given on standard input; an exit code."""
    from harness.viewing.pybullet_window import play

    playback, player = pickle.load(sys.stdin.buffer)
    try:
        return _CLOSED if play(playback, player) else _NOT_OPENED
    except KeyboardInterrupt:  # the command, too, gets it and ends
        return _CLOSED
    except Exception:
        traceback.print_exc()
        return _RAISED


if __name__ == "__main__":
    sys.exit(_main())
