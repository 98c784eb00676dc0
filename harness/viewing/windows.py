"""Windows in which a playback is shown: MuJoCo's own viewer and PyBullet's."""

from __future__ import annotations

import os
import sys
import time
import warnings
from collections.abc import Callable

from harness.errors import InputError
from harness.viewing.drawing import ENGINE_COLOUR, GHOST_COLOUR
from harness.viewing.film import lines_of
from harness.viewing.playback import Instant, Playback
from harness.viewing.player import Player

FRAME = 1.0 / 60.0  # [s]
Window = Callable[[Playback, Player], str]
"""Shows a playback until it is closed; why it ended otherwise, if it did."""


def check_display() -> None:
    """Try whether a window can be opened.

    Raises:
        InputError: there is no display, or no window opens on it.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("there is no display here: give --video out.mp4")
    import glfw

    # A viewer that cannot open its window would wait for it for ever, in a thread of its own.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what GLFW says of a display is a warning
        opens = bool(glfw.init())
        if opens:
            glfw.window_hint(glfw.VISIBLE, glfw.FALSE)
            window = glfw.create_window(64, 64, "", None, None)
            opens = bool(window)
            if window:
                glfw.destroy_window(window)
            glfw.terminate()
    if not opens:
        raise InputError("no window with OpenGL opens on this display: give --video out.mp4")


def window_of(engine: str) -> Window:
    """The window for an engine's runs, in a process of its own.

    On macOS MuJoCo's is in this one, which has to be `mjpython`.
    """
    if sys.platform == "darwin" and engine != "pybullet":
        from harness.viewing.mujoco_window import show
    else:
        from harness.viewing.window_process import show
    return show


class Clock:
    """Seconds that the user's clock has gone on, frame by frame."""

    def __init__(self) -> None:
        """Start now."""
        self._last = time.monotonic()

    def tick(self) -> float:
        """Wait for the next frame; the time since the last one [s]."""
        time.sleep(max(0.0, self._last + FRAME - time.monotonic()))
        now = time.monotonic()
        passed, self._last = now - self._last, now
        return passed


def plain_lines(playback: Playback, player: Player, now: Instant) -> list[str]:
    """What is written into a window, line by line, in letters and colours' names that every viewer has."""
    names = {ENGINE_COLOUR: " (orange)", GHOST_COLOUR: " (blue)", None: ""}
    lines = lines_of(playback, player.run, now, player.speed)
    return [text.replace("°", " deg").replace("×", "x") + names[colour] for text, colour in lines]
