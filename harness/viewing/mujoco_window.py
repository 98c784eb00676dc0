"""A playback in MuJoCo's own viewer."""

from __future__ import annotations

import queue
import sys

import glfw

from harness.errors import InputError
from harness.viewing.drawing import Drawing
from harness.viewing.film import lines_of
from harness.viewing.playback import Playback
from harness.viewing.player import Player, keys_told
from harness.viewing.windows import Clock

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
_ASPECT = 16 / 9  # of the window, which the user may change


def show(playback: Playback, player: Player) -> None:
    """Show a playback until the window is closed.

    Raises:
        InputError: MuJoCo's viewer does not open here.
    """
    import mujoco.viewer

    drawing, pressed = Drawing(playback), queue.SimpleQueue[str]()
    drawing.place(player.run, player.time)
    try:
        viewer = mujoco.viewer.launch_passive(
            drawing.model,
            drawing.data,
            key_callback=lambda key: pressed.put(_KEYS.get(key, "")),
            show_left_ui=False,
            show_right_ui=False,
        )
    except RuntimeError as error:
        how = "run `mjpython -m harness view …`" if sys.platform == "darwin" else "give --video out.mp4"
        raise InputError(f"MuJoCo's viewer does not open ({error}); {how}") from error
    with viewer:
        with viewer.lock():
            drawing.aim(viewer.cam, _ASPECT)
        clock = Clock()
        while viewer.is_running():
            while not pressed.empty():
                player.press(pressed.get())
            player.advance(clock.tick())
            with viewer.lock():
                now = drawing.place(player.run, player.time)
                viewer.user_scn.ngeom = 0
                drawing.add_ghost(viewer.user_scn)
            told = [text for text, _ in lines_of(playback, player.run, now, player.speed)]
            keys = keys_told(len(playback.runs))
            small, top, bottom = (
                mujoco.mjtFontScale.mjFONTSCALE_150,
                mujoco.mjtGridPos.mjGRID_TOPLEFT,
                mujoco.mjtGridPos.mjGRID_BOTTOMLEFT,
            )
            viewer.set_texts(
                [
                    (small, top, "\n".join(told).replace("°", " deg").replace("×", "x"), ""),
                    (small, bottom, "\n".join(key for key, _ in keys), "\n".join(does for _, does in keys)),
                ]
            )
            viewer.sync()
