"""A playback of a made-up run, and where a picture shows what."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from analytic.motion import FloatArray
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from harness.errors import InputError
from harness.viewing.offscreen import kind_of_context
from harness.viewing.playback import Playback
from harness.viewing.runs import ShownRun

TIME = np.linspace(0.0, 1.0, 11)
ANGLE = 0.05  # of the beam [rad]


def made(*, lifted_off: float | None = None, rolls_until: float = 1.0, reading: FloatArray | None = None) -> Playback:
    """A ball that rolls from 0.1 m by 0.3 m/s, and a recorded one that comes from 0.5 m towards it."""
    beam = QuinticMotion(np.array([0.0, 1.0]), np.array([[ANGLE, 0.0, 0.0]] * 2))
    time = TIME[rolls_until + 1e-9 >= TIME]
    rolled = 0.3 * time / Rig().rolling_radius
    run = ShownRun("made up", (), Rig(), beam, time, 0.1 + 0.3 * time, rolled, lifted_off)
    read = 0.5 - 0.3 * TIME if reading is None else reading
    known = np.isfinite(read)
    return Playback("mujoco", (run,), TIME[known], read[known], 0.0, 1.0, True)


def column_of(
    centre: tuple[float, float, float], camera: mujoco.MjvCamera, fovy: float, width: int, height: int
) -> float:
    """Column in which a pinhole camera sees a point of the world [m]."""
    azimuth, elevation = math.radians(camera.azimuth), math.radians(camera.elevation)
    across = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    forward = np.array(
        [math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)]
    )
    away = np.array(centre) - (camera.lookat - camera.distance * forward)
    focal = 0.5 * height / math.tan(math.radians(0.5 * fovy))
    return 0.5 * width - 0.5 + focal * float(away @ across) / float(away @ forward)


def middle_of(mask: NDArray[np.bool_]) -> float:
    """Middle between the leftmost and the rightmost column of a mask in which it holds three times."""
    columns = np.flatnonzero(mask.sum(axis=0) >= 3)
    assert len(columns), "nothing of this colour"
    return 0.5 * float(columns[0] + columns[-1])


def orange(picture: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Where a picture, shape (h, w, 3), has the colour of the engine's ball, which nothing else has."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    return (red - blue > 25) & (red - green > 15)


def blue(picture: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Where a picture has the colour of the ghost; the stand is less blue."""
    red, _, blue = np.moveaxis(picture.astype(int), -1, 0)
    return blue - red > 60


def need_opengl() -> None:
    """Skip the test where no OpenGL can draw without a window, and say why."""
    try:
        kind_of_context()
    except InputError as error:
        pytest.skip(str(error))
