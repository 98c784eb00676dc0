"""A playback in MuJoCo's own viewer."""

from __future__ import annotations

import math
import queue
import sys
import threading
from collections.abc import Callable
from typing import Any

import glfw
import mujoco
import mujoco.viewer

from harness.errors import InputError
from harness.viewing.drawing import Drawing
from harness.viewing.playback import Playback
from harness.viewing.player import Player, keys_told
from harness.viewing.windows import Clock, plain_lines

_KEYS = {
    glfw.KEY_SPACE: "space",
    glfw.KEY_LEFT: "left",
    glfw.KEY_RIGHT: "right",
    glfw.KEY_UP: "up",
    glfw.KEY_DOWN: "down",
    glfw.KEY_HOME: "home",
    glfw.KEY_ENTER: "enter",
    glfw.KEY_KP_ENTER: "enter",
}
_ASPECT = 1.3  # until that of the window is known
_TEXT_INTERVAL = 0.1  # between two changes of the text [s]
_PATIENCE = 5.0  # for the window to close [s]


def show(playback: Playback, player: Player) -> str:
    """`play` in this process; it ends only where the window is closed."""
    play(playback, player)
    return ""


def play(playback: Playback, player: Player, opened: Callable[[], None] = lambda: None) -> None:
    """Show a playback until the window is closed.

    Args:
        opened: is called once the window is there.

    Raises:
        InputError: MuJoCo's viewer does not open here.
    """
    drawing, pressed = Drawing(playback), queue.SimpleQueue[str]()
    drawing.place(player.run, player.time)
    others = set(threading.enumerate())
    try:
        viewer = mujoco.viewer.launch_passive(
            drawing.model,
            drawing.data,
            key_callback=lambda key: pressed.put(_KEYS.get(key, "")),
            show_left_ui=False,
            show_right_ui=False,
        )
    except RuntimeError as error:
        raise InputError(f"{error}; run `mjpython -m harness view …`" if sys.platform == "darwin" else error) from error
    opened()
    try:
        with viewer:
            _play(viewer, drawing, player, pressed)
    finally:  # the window is drawn by a thread, which must not be cut off in the middle of a frame
        for thread in set(threading.enumerate()) - others:
            thread.join(_PATIENCE)


def _play(viewer: Any, drawing: Drawing, player: Player, pressed: queue.SimpleQueue[str]) -> None:
    """Until the window is closed."""
    playback = drawing.playback
    keys = list(zip(*keys_told(len(playback.runs)), strict=True))
    font, top, bottom = (
        mujoco.mjtFontScale.mjFONTSCALE_150,
        mujoco.mjtGridPos.mjGRID_TOPLEFT,
        mujoco.mjtGridPos.mjGRID_BOTTOMLEFT,
    )
    with viewer.lock():
        drawing.aim(viewer.cam, _ASPECT)
    clock, aimed, since, written = Clock(), False, math.inf, ""
    while viewer.is_running():
        if not aimed and (aspect := _aspect(viewer)):
            with viewer.lock():
                drawing.aim(viewer.cam, aspect)
            aimed = True
        while not pressed.empty():
            player.press(pressed.get())
        passed = clock.tick()
        player.advance(passed)
        since += passed
        with viewer.lock():
            now = drawing.place(player.run, player.time)
            viewer.user_scn.ngeom = 0
            drawing.add_ghost(viewer.user_scn)
        told = "\n".join(plain_lines(playback, player, now))
        # MuJoCo (4.0) waits for the texts before to be drawn, and crashes where the window is closed meanwhile: so it
        # is given none that says the same, and others seldom.
        if told != written and since > _TEXT_INTERVAL and viewer.is_running():
            viewer.set_texts([(font, top, told, ""), (font, bottom, *map("\n".join, keys))])
            written, since = told, 0.0
        viewer.sync()


def _aspect(viewer: Any) -> float:
    """Width of the window over its height; 0 until it has been drawn for the first time, by another thread."""
    area = viewer.viewport
    return 0.0 if area is None or area.height <= 0 else area.width / area.height
