"""The kernel beside the same method in C: many runs of one recording, with the same results."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic import slots
from analytic.effects import ROLLING_RESISTANCE, Acting, parameters_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import FloatArray
from analytic.rig import Rig
from benchmarks.performance.engines import Swing
from benchmarks.performance.pairs import Pair, pairs_of

FLAGS = ("-O3", "-march=native")
_SOURCE = Path(__file__).with_name("rk4.c")
_RUNS, _STAMPS = 200, 1600  # of 16 s at 100 Hz
_READ = (slots.GRAVITY, slots.CENTRIFUGAL, slots.ECCENTRIC, slots.LEVEL)
_NEAR = 1e-9  # [m], [m/s]: gcc fuses products and sums, which rounds otherwise


class CompilerMissing(RuntimeError):
    """There is no gcc."""


def library(folder: Path) -> ctypes.CDLL:
    """The C source, compiled into `folder`.

    Raises:
        CompilerMissing: there is no gcc.
    """
    if shutil.which("gcc") is None:
        raise CompilerMissing("gcc is not installed")
    out = folder / "rk4.so"
    subprocess.run(["gcc", *FLAGS, "-shared", "-fPIC", "-o", str(out), str(_SOURCE), "-lm"], check=True)
    return ctypes.CDLL(str(out))


class Work:
    """Runs from different starts on one recording's grid, by the kernel and by C."""

    def __init__(self, folder: Path, resistance: float = 0.0) -> None:
        """Prepare them; a resistance against rolling [1] brings the balls to rest now and then."""
        self._library = library(folder)
        motion = Swing(0.02 if resistance else 0.01)
        self._grid = Grid.over(np.arange(_STAMPS) / 100.0)
        self._table = self._grid.tabulate(motion)
        effects = [Acting(ROLLING_RESISTANCE, {"coefficient": resistance})] if resistance else []
        self._p = parameters_with(CAM, Rig(), effects)
        generator = np.random.default_rng(1)
        self._starts = np.column_stack([generator.uniform(0.2, 0.5, _RUNS), generator.uniform(-0.02, 0.02, _RUNS)])
        self._of_c = self._library.dry if resistance else self._library.smooth

    def kernel(self) -> FloatArray:
        """s [m] and ṡ [m/s], shape (runs, n, 2)."""
        runs = integrate(self._grid, self._table, self._p, self._starts)
        return np.stack((runs.position, runs.velocity), axis=-1)

    def timed_kernel(self) -> None:
        """The same without a copy."""
        integrate(self._grid, self._table, self._p, self._starts)

    def c(self) -> FloatArray:
        """As `kernel`."""
        p, table, steps, marks = self._p, self._table, self._grid.steps, self._grid.marks
        response = p[slots.RESPONSE]
        own = (response * p[slots.DRY_PLUS], response * p[slots.DRY_MINUS], p[slots.WEIGHT], p[slots.HEIGHT])
        model = np.array([*p[list(_READ)], *own])
        out, tilted = np.full((_RUNS, _STAMPS, 2), np.nan), np.empty(len(table))
        out[:, 0] = self._starts
        self._library.tilts(ctypes.c_long(len(table)), _at(table), ctypes.c_double(p[slots.LEVEL]), _at(tilted))
        shared = (ctypes.c_long(_STAMPS), _at(steps), _at(marks), _at(table), _at(tilted), _at(model))
        for run in out:
            self._of_c(*shared, _at(run))
        return out

    def check(self) -> int:
        """How many of all steps between stamps begin and end at rest.

        Raises:
            RuntimeError: kernel and C differ, so that their times say nothing.
        """
        ours, theirs = self.kernel(), self.c()
        if not np.allclose(ours, theirs, rtol=0.0, atol=_NEAR):
            raise RuntimeError(f"kernel and C differ by {np.nanmax(np.abs(ours - theirs)):.3g}")
        return int(np.sum(ours[..., 1] == 0.0))


def smooth_against_c(pairs: int, folder: Path) -> list[Pair]:
    """Smooth terms only."""
    return _pairs(Work(folder), pairs, lambda at_rest: at_rest == 0)


def sticking_against_c(pairs: int, folder: Path) -> list[Pair]:
    """With a resistance against rolling at which the ball comes to rest again and again."""
    return _pairs(Work(folder, resistance=0.016), pairs, lambda at_rest: at_rest > 0.05 * _RUNS * _STAMPS)


def _pairs(work: Work, pairs: int, expected: Callable[[int], bool]) -> list[Pair]:
    if not expected(work.check()):
        raise RuntimeError("the balls do not rest as they should in what is to be timed")
    return pairs_of(work.timed_kernel, work.c, pairs)


def _at(array: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
