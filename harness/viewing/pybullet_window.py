"""A playback in PyBullet's own window."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path

from harness.engines.pybullet import pybullet
from harness.errors import InputError
from harness.viewing.drawing import ENGINE_COLOUR, GHOST_COLOUR, GHOST_OPACITY, GHOST_SIZE
from harness.viewing.playback import Playback, Vector, centre_of, turned_by
from harness.viewing.player import Player, keys_told
from harness.viewing.windows import Clock, plain_lines
from urdf.scene import PIVOT, beam_urdf

_KEYS = {
    ord(" "): "space",
    pybullet.B3G_LEFT_ARROW: "left",
    pybullet.B3G_RIGHT_ARROW: "right",
    pybullet.B3G_UP_ARROW: "up",
    pybullet.B3G_DOWN_ARROW: "down",
    pybullet.B3G_HOME: "home",
    pybullet.B3G_RETURN: "enter",
}
_YAW, _PITCH = 5.0, -12.0  # of the camera, almost across the beam [deg]
_DISTANCE = 0.52  # of the camera, in lengths of the beam
# Heights of texts above and below the edges, and of a line, in lengths of the beam.
_ABOVE, _BELOW, _LINE = 0.24, -0.064, 0.029
_NEAR = -0.08  # y of the lower texts, before the stand [m]
_STAND_OPACITY = 0.35  # the balls are seen through it
_TEXT_INTERVAL = 0.1  # between two changes of the text, which PyBullet draws anew each time [s]


def play(playback: Playback, player: Player, opened: Callable[[], None] = lambda: None) -> None:
    """Show a playback until the window is closed with Esc.

    Where a window manager closes the window, Xlib ends the process (`harness.viewing.window_process`).

    Args:
        opened: is called once the window is there.

    Raises:
        InputError: PyBullet's window does not open here.
    """
    client = pybullet.connect(pybullet.GUI)
    if client < 0:
        raise InputError("PyBullet found no display with OpenGL")
    opened()
    try:
        _play(_Window(playback, client), player)
    except pybullet.error:  # the window was closed within a frame
        if pybullet.isConnected(client):
            raise
    finally:
        if pybullet.isConnected(client):
            pybullet.disconnect(client)


def _play(window: _Window, player: Player) -> None:
    """Until the window is closed."""
    clock, since, client = Clock(), math.inf, window.client
    while pybullet.isConnected(client):
        for key, state in pybullet.getKeyboardEvents(physicsClientId=client).items():
            if state & pybullet.KEY_WAS_RELEASED:  # a key that is pressed briefly is never reported as pressed
                player.press(_KEYS.get(key, ""))
        passed = clock.tick()
        player.advance(passed)
        since += passed
        window.place(player, write=since > _TEXT_INTERVAL)
        since = 0.0 if since > _TEXT_INTERVAL else since


class _Window:
    """Beam, ball, ghost and texts in a window of PyBullet."""

    def __init__(self, playback: Playback, client: int) -> None:
        self.playback, self.client = playback, client
        rig, channel = playback.runs[0].rig, playback.channel
        pybullet.configureDebugVisualizer(pybullet.COV_ENABLE_GUI, 0, physicsClientId=client)
        pybullet.configureDebugVisualizer(pybullet.COV_ENABLE_KEYBOARD_SHORTCUTS, 0, physicsClientId=client)
        pybullet.resetDebugVisualizerCamera(
            _DISTANCE * channel.length, _YAW, _PITCH, (channel.centre, 0.0, channel.edge_height), client
        )
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "beam.urdf")
            file.write_text(beam_urdf(rig, channel), encoding="utf-8")
            self.beam = pybullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        self.pivot = next(
            joint
            for joint in range(pybullet.getNumJoints(self.beam, client))
            if pybullet.getJointInfo(self.beam, joint, client)[1].decode() == PIVOT
        )
        for _, link, *_, colour in pybullet.getVisualShapeData(self.beam, physicsClientId=client):
            if link < self.pivot:  # of the base, which does not turn
                faint = (*colour[:3], _STAND_OPACITY)
                pybullet.changeVisualShape(self.beam, link, rgbaColor=faint, physicsClientId=client)
        self.ball = self._sphere(channel.ball_radius, (*ENGINE_COLOUR, 1.0))
        self.ghost = self._sphere(GHOST_SIZE * channel.ball_radius, (*GHOST_COLOUR, GHOST_OPACITY))
        self.texts: dict[int, int] = {}
        for number, (key, does) in enumerate(keys_told(len(playback.runs)), 1):
            self._write(-number, f"{key}: {does}", channel.centre, _BELOW - _LINE * number, _NEAR)

    def place(self, player: Player, *, write: bool) -> None:
        """Put beam and balls where they are at the player's time; `write` renews the text, too."""
        now = self.playback.at(player.run, player.time)
        rig = self.playback.runs[player.run].rig
        pybullet.resetJointState(self.beam, self.pivot, now.angle, physicsClientId=self.client)
        w, x, y, z = turned_by(now.spin)
        for body, position, turn in ((self.ball, now.position, (x, y, z, w)), (self.ghost, now.recorded, (0, 0, 0, 1))):
            away = (0.0, 0.0, -100.0)  # of a ball that is not known
            centre = centre_of(rig, position, now.angle) if math.isfinite(position) else away
            pybullet.resetBasePositionAndOrientation(body, centre, turn, self.client)
        if write:
            for number, text in enumerate(plain_lines(self.playback, player, now)):
                self._write(number, text, self.playback.channel.x_from, _ABOVE - _LINE * number)

    def _sphere(self, radius: float, colour: tuple[float, ...]) -> int:
        """A body that is drawn and touches nothing."""
        shape = pybullet.createVisualShape(
            pybullet.GEOM_SPHERE, radius=radius, rgbaColor=colour, physicsClientId=self.client
        )
        return int(pybullet.createMultiBody(baseVisualShapeIndex=shape, physicsClientId=self.client))

    def _write(self, number: int, text: str, x: float, above: float, y: float = 0.0) -> None:
        """Write or replace one line that begins at x and y [m], at a height above the edges in lengths of the beam."""
        channel = self.playback.channel
        at: Vector = (x, y, channel.edge_height + above * channel.length)
        replaced = {"replaceItemUniqueId": self.texts[number]} if number in self.texts else {}
        self.texts[number] = pybullet.addUserDebugText(
            text, at, (0.1, 0.1, 0.2), textSize=1.1, physicsClientId=self.client, **replaced
        )
