"""An engine's window in a process of its own, whose end is not the command's.

Where a window manager closes PyBullet's window, Xlib ends the process that it is in; and MuJoCo 4.0 may crash where its
window is closed while a run is played.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import traceback
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.motion import SplineMotion
from harness.errors import InputError
from harness.viewing.playback import Playback
from harness.viewing.player import Player
from harness.viewing.runs import ShownRun

_CLOSED, _CLOSED_BY_WINDOW_MANAGER, _NOT_OPENED, _RAISED = 0, 1, 4, 5  # exit codes; the second one is Xlib's own
_OPENED = "window opened"  # a line on standard error
_PYBULLETS, _MUJOCOS = "harness.viewing.pybullet_window", "harness.viewing.mujoco_window"  # modules
_NAMES = {_PYBULLETS: "PyBullet's window", _MUJOCOS: "MuJoCo's viewer"}
_STEP = 0.005  # between angles of the beam that is drawn [s]


def show(playback: Playback, player: Player) -> str:
    """Show a playback until the window is closed.

    Returns:
        Why the window ended if its process crashed once it was open; else nothing.

    Raises:
        InputError: the window does not open here, or cannot show this.
    """
    name = _NAMES[_module_of(playback)]
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
        return ""
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    if done.returncode == _NOT_OPENED:
        raise InputError(f"{name} does not open here{_because(lines)}: give --video out.mp4")
    if done.returncode < 0 and _OPENED in lines:
        why = signal.strsignal(-done.returncode) or f"signal {-done.returncode}"
        return f"{name} crashed ({why}), as it may where it is closed while a run is played"
    raise InputError(f"{name} failed{_because(lines) or f' (exit code {done.returncode})'}: give --video out.mp4")


def _module_of(playback: Playback) -> str:
    """PyBullet's window is for its own runs, MuJoCo's for all others."""
    return _PYBULLETS if playback.engine == "pybullet" else _MUJOCOS


def _because(lines: list[str]) -> str:
    """What a process said last, in brackets; nothing if it said nothing."""
    said = [line for line in lines if line != _OPENED]
    return f" ({said[-1]})" if said else ""


def _plain(playback: Playback) -> Playback:
    """The same with motions of the beam that another process can read, also if a user's effect made them."""

    def plain(run: ShownRun) -> ShownRun:
        count = max(int((playback.end - playback.begin) / _STEP), 3)
        time = np.linspace(playback.begin, playback.end, count + 1)
        return replace(run, motion=SplineMotion(CubicSpline(time, run.motion.evaluate(time))))

    return replace(playback, runs=tuple(map(plain, playback.runs)))


def _main() -> int:
    """Show what is given on standard input; an exit code."""
    playback, player = pickle.load(sys.stdin.buffer)
    play = import_module(_module_of(playback)).play
    try:
        play(playback, player, opened=lambda: print(_OPENED, file=sys.stderr, flush=True))
    except InputError as error:
        print(error, file=sys.stderr)
        return _NOT_OPENED
    except KeyboardInterrupt:  # the command, too, gets it and ends
        return _CLOSED
    except Exception:
        traceback.print_exc()
        return _RAISED
    return _CLOSED


if __name__ == "__main__":
    sys.exit(_main())
