"""A screen without a monitor (Xvfb), on which windows are opened, seen, typed into and closed."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import ImageGrab

T = TypeVar("T")
PATIENCE = 90.0  # for what takes a second on an idle machine [s]
_CLIENT_MESSAGE = 33  # of the X protocol


def within_patience(look: Callable[[], T | None], what: str) -> T:
    """What `look` gives as soon as it gives anything but `None`."""
    end = time.monotonic() + PATIENCE
    while (found := look()) is None:
        assert time.monotonic() < end, f"{what} did not happen within {PATIENCE:.0f} s"
        time.sleep(0.2)
    return found


class Screen:
    """One screen.

    Attributes:
        name: of the display, as in `DISPLAY`.
        environment: for programs that are to open their windows on it.
    """

    def __init__(self, name: str) -> None:
        """Take the name of a display that is there."""
        self.name = name
        self.environment = {key: value for key, value in os.environ.items() if key != "WAYLAND_DISPLAY"}
        self.environment["DISPLAY"] = name

    def window(self) -> str | None:
        """Number of the window that is open; `None` without one."""
        found = self._xdotool("search", "--onlyvisible", "--name", ".", check=False).split()
        assert len(found) < 2, "one window at a time"
        return found[0] if found else None

    def picture(self, window: str) -> NDArray[np.uint8]:
        """What a window shows, shape (height, width, 3)."""
        lines = self._xdotool("getwindowgeometry", "--shell", window).splitlines()
        place = {key: int(value) for key, value in (line.split("=") for line in lines)}
        left, top = place["X"], place["Y"]
        box = (left, top, left + place["WIDTH"], top + place["HEIGHT"])
        return np.asarray(ImageGrab.grab(bbox=box, xdisplay=self.name).convert("RGB"))

    def press(self, window: str, key: str) -> None:
        """Press and release a key in a window."""
        self._xdotool("windowfocus", "--sync", window)
        self._xdotool("key", key)

    def close(self, window: str) -> None:
        """Do what a window manager does when the button that closes a window is clicked.

        It asks a window that takes such a request, and ends the connection of the others.
        """
        name = ctypes.util.find_library("X11")
        assert name is not None
        x11 = ctypes.CDLL(name)
        x11.XOpenDisplay.restype, x11.XInternAtom.restype = ctypes.c_void_p, ctypes.c_ulong
        display = ctypes.c_void_p(x11.XOpenDisplay(self.name.encode()))
        assert display
        if not self._asked_to_close(x11, display, window):
            x11.XKillClient(display, ctypes.c_ulong(int(window)))
            x11.XCloseDisplay(display)
            return
        atoms = [x11.XInternAtom(display, atom, False) for atom in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW")]
        message = _Message(_CLIENT_MESSAGE, 0, True, display, int(window), atoms[0], 32, (atoms[1], 0, 0, 0, 0))
        assert x11.XSendEvent(display, ctypes.c_ulong(int(window)), False, ctypes.c_long(0), ctypes.byref(message))
        x11.XCloseDisplay(display)

    @staticmethod
    def _asked_to_close(x11: ctypes.CDLL, display: ctypes.c_void_p, window: str) -> bool:
        """Whether a window wants to be asked to close."""
        atoms, count = ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_int()
        delete = x11.XInternAtom(display, b"WM_DELETE_WINDOW", False)
        number = ctypes.c_ulong(int(window))
        if not x11.XGetWMProtocols(display, number, ctypes.byref(atoms), ctypes.byref(count)):
            return False
        return delete in atoms[: count.value]

    def _xdotool(self, *arguments: str, check: bool = True) -> str:
        done = subprocess.run(
            ["xdotool", *arguments], env=self.environment, capture_output=True, text=True, check=check, timeout=PATIENCE
        )
        return done.stdout


class _Message(ctypes.Structure):
    """`XClientMessageEvent`, as large as an `XEvent`."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * 12),
    )


@contextmanager
def screen(width: int, height: int) -> Iterator[Screen]:
    """A screen of so many pixels; the test is skipped where there is no Xvfb or no xdotool."""
    missing = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
    if missing:
        pytest.skip(f"{' and '.join(missing)} not installed (Debian: xvfb, xdotool)")
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()  # a free one, told when the screen is there
        assert number, "Xvfb did not start"
        yield Screen(f":{number}")
    finally:
        server.terminate()
        server.wait(PATIENCE)
