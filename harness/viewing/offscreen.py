"""Pictures without a window: an OpenGL context of EGL or OSMesa, whichever works here, and MuJoCo's renderer in it."""

from __future__ import annotations

import contextlib
import functools
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.viewing.drawing import Drawing

KINDS = ("egl", "osmesa", "glfw")
REMEDY = "install libegl1 and libgl1-mesa-dri, or libosmesa6 (Debian: apt-get install libegl1 libgl1-mesa-dri)"
_PATIENCE = 60.0  # for a context to be made on a busy machine [s]
# A library without a driver may end its process, so each kind is tried in one of its own, without its clean-up.
_TRIAL = (
    "import os, mujoco; from mujoco.{kind} import GLContext; context = GLContext(16, 16); context.make_current(); "
    "mujoco.MjrContext(mujoco.MjModel.from_xml_string('<mujoco/>'), 100); os._exit(0)"
)
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Tried:
    """Which kinds of OpenGL contexts were tried.

    Attributes:
        kind: the first that works; empty if none does.
        faults: why those before it do not.
    """

    kind: str
    faults: Mapping[str, str]

    def __str__(self) -> str:
        return "; ".join(f"{kind}: {fault}" for kind, fault in self.faults.items())


def try_contexts() -> Tried:
    """Make a context of each kind, or of `MUJOCO_GL` alone if that is one, in a process of its own until one works."""
    asked = os.environ.get("MUJOCO_GL", "").lower()
    kinds = (asked,) if asked in KINDS else KINDS
    faults: dict[str, str] = {}
    for kind in kinds:
        environment = {name: value for name, value in os.environ.items() if name != "PYOPENGL_PLATFORM"}
        command = [sys.executable, "-c", _TRIAL.format(kind=kind)]
        try:
            done = subprocess.run(
                command,
                env=environment | {"MUJOCO_GL": kind},
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=_PATIENCE,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            faults[kind] = type(error).__name__
            continue
        if done.returncode == 0:
            return Tried(kind, faults)
        faults[kind] = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
    return Tried("", faults)


@functools.cache
def kind_of_context() -> str:
    """The first kind of OpenGL context that works here, of those that `try_contexts` tries.

    Raises:
        InputError: none does.
    """
    tried = try_contexts()
    if not tried.kind:
        raise InputError(f"no OpenGL works here to draw without a window ({tried}); {REMEDY}")
    return tried.kind


@contextlib.contextmanager
def offscreen(drawing: Drawing, width: int, height: int) -> Iterator[Offscreen]:
    """A renderer of pictures of width × height pixels, as long as the context lasts.

    Raises:
        InputError: no OpenGL works here.
    """
    kind = kind_of_context()
    if kind != "glfw" and "OpenGL" not in sys.modules:
        os.environ["PYOPENGL_PLATFORM"] = kind
    try:
        # MuJoCo's own context is freed when Python ends, too, when the libraries that it calls are gone.
        made: Any = importlib.import_module(f"mujoco.{kind}").GLContext
        context = type("Context", (made,), {"__del__": lambda self: None})(width, height)
        context.make_current()
    except Exception as error:  # whatever a driver's bindings raise
        raise InputError(
            f"OpenGL by {kind} does not work in this process ({error}); set MUJOCO_GL to another"
        ) from error
    renderer = Offscreen(drawing, width, height)
    try:
        yield renderer
    finally:
        renderer.free()
        with contextlib.suppress(Exception):  # that of OSMesa fails with some versions of PyOpenGL
            context.free()


class Offscreen:
    """MuJoCo's renderer in the OpenGL context that is current."""

    def __init__(self, drawing: Drawing, width: int, height: int) -> None:
        """Prepare for pictures of width × height pixels of a drawing."""
        self.drawing = drawing
        self._shape = (height, width, 3)
        drawing.model.vis.global_.offwidth, drawing.model.vis.global_.offheight = width, height
        self._scene = mujoco.MjvScene(drawing.model, maxgeom=1000)
        self._context: Any = mujoco.MjrContext(drawing.model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._camera, self._option = mujoco.MjvCamera(), mujoco.MjvOption()
        drawing.aim(self._camera, width / height)

    def picture(self) -> Picture:
        """The drawing as it is placed now, shape (height, width, 3), 0 to 255."""
        model, data, everything = self.drawing.model, self.drawing.data, mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, self._option, None, self._camera, everything, self._scene)
        self.drawing.add_ghost(self._scene)
        height, width, _ = self._shape
        area = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(area, self._scene, self._context)
        pixels = np.empty(self._shape, dtype=np.uint8)
        mujoco.mjr_readPixels(pixels, None, area, self._context)
        return np.ascontiguousarray(pixels[::-1])

    def free(self) -> None:
        """Give back what the renderer holds of OpenGL."""
        self._context.free()
