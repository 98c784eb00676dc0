"""A compiled kernel that integrates many runs at once: any models, start states, windows and beam motions.

Between two stamps of a recording the steps are equal and no longer than a given one, so that every run starts and ends
exactly at stamps, however uneven these are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic import slots
from analytic.borrowed import borrowed
from analytic.compiled import fixed, njit
from analytic.lean import damped_run, dry_run, smooth_run, tilts
from analytic.lean_step import DAMPED_DRY, DRY, GENERAL, SMOOTH, path_of
from analytic.models import Model, coefficients
from analytic.motion import BeamMotion, FloatArray, State, Trajectory, beam_states
from analytic.rig import Rig
from analytic.step import advance


@njit(cache=True)
def _integrate(
    steps: FloatArray,
    marks: NDArray[np.int64],
    tables: FloatArray,
    table_of: NDArray[np.int64],
    parameters: FloatArray,
    starts: FloatArray,
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    out: FloatArray,
) -> None:
    """Fill `out`, s [m] and ṡ [m/s] at the stamps of one run after the other, shape (Σ (last − first + 1), 2)."""
    tables, parameters, starts, out = borrowed(tables), borrowed(parameters), borrowed(starts), borrowed(out)
    tilted = np.empty(tables.shape[1])  # sin(α + α₀), filled from row `low` to `high`
    low, high, motion, level, linear = 0, -1, -1, 0.0, 0.0  # what it was filled for
    at = 0  # row of `out` for the first stamp of a run
    for run in range(starts.shape[0]):
        p = parameters[run]
        table = tables[table_of[run]]
        s, v, w = starts[run, 0], starts[run, 1], 0.0
        filled = out[at : at + last[run] - first[run] + 1]
        filled[0, 0], filled[0, 1] = s, v
        at += len(filled)
        path = path_of(p)
        if path != GENERAL:
            begin, end = 2 * marks[first[run]], 2 * marks[last[run]]
            same = table_of[run] == motion and p[slots.LEVEL] == level and p[slots.LINEAR] == linear
            if not same or begin < low or end > high:
                tilts(table, begin, end, p, tilted)
                low, high, motion, level, linear = begin, end, table_of[run], p[slots.LEVEL], p[slots.LINEAR]
            if path == SMOOTH:
                smooth_run(steps, marks, table, tilted, p, first[run], last[run], filled)
            elif path == DRY:
                dry_run(steps, marks, table, tilted, p, first[run], last[run], filled)
            else:
                damped_run(steps, marks, table, tilted, p, first[run], last[run], filled, path == DAMPED_DRY)
            continue
        for stamp in range(first[run], last[run]):
            for j in range(marks[stamp], marks[stamp + 1]):
                s, v, w = advance(s, v, w, steps[j], table, 2 * j, p)
            filled[stamp + 1 - first[run], 0], filled[stamp + 1 - first[run], 1] = s, v


@dataclass(frozen=True)
class Grid:
    """Stamps and the integration steps between them.

    Attributes:
        time: stamps, shape (n,) [s].
        steps: step sizes, shape (m,) [s].
        marks: index of the step that begins at each stamp, shape (n,).
    """

    time: FloatArray
    steps: FloatArray
    marks: NDArray[np.int64]

    @classmethod
    def over(cls, time: FloatArray, longest_step: float = 2.5e-3) -> Grid:
        """Equal steps no longer than `longest_step` [s] between the stamps `time`, shape (n,), strictly increasing [s].

        With the default, a beam that moves by 3° at 2 Hz leaves an error below 1e-9 m after 10 s; the error grows
        with the fourth power of frequency and step (tests/analytic/test_kernel.py).

        Raises:
            ValueError: no stamps, or stamps that do not increase.
        """
        time = np.asarray(time, float)
        gaps = np.diff(time)
        if time.ndim != 1 or not len(time) or not np.all(gaps > 0.0):
            raise ValueError("stamps must be one strictly increasing row of times")
        count = np.maximum(np.ceil(gaps / longest_step - 1e-9).astype(np.int64), 1)
        steps = np.repeat(gaps / count, count)
        return cls(time, steps, np.concatenate(([0], np.cumsum(count))))

    @cached_property
    def edges(self) -> FloatArray:
        """Start, middle and end of every step, shape (2 m + 1,) [s]."""
        edges = np.empty(2 * len(self.steps) + 1)
        # Summed from each stamp anew, so that rounding does not accumulate over a long recording.
        begin = np.repeat(self.time[:-1], np.diff(self.marks))
        within = np.arange(len(self.steps)) - np.repeat(self.marks[:-1], np.diff(self.marks))
        edges[1::2] = begin + (within + 0.5) * self.steps
        edges[2::2] = begin + (within + 1.0) * self.steps
        # The stamps themselves, not rounded sums: a motion is not evaluated beyond the recording's last stamp.
        edges[2 * self.marks] = self.time
        return edges

    def tabulate(self, motion: BeamMotion) -> FloatArray:
        """α [rad], α̇ [rad/s], α̈ [rad/s²] at the start, middle and end of every step, shape (2 m + 1, 3)."""
        table = beam_states(motion, self.edges)
        # With this α̈ Simpson's rule gives the change of α̇ over a step exactly, also where α̇ jumps (backlash).
        change = np.diff(table[::2, 1]) / self.steps
        table[1::2, 2] = 0.25 * (6.0 * change - table[:-2:2, 2] - table[2::2, 2])
        return table


@dataclass(frozen=True)
class Runs:
    """Results of many runs over one grid: `position` [m] and `velocity` [m/s], shape (runs, n)."""

    time: FloatArray
    position: FloatArray
    velocity: FloatArray


def integrate(
    grid: Grid,
    tables: FloatArray,
    parameters: FloatArray,
    starts: FloatArray,
    *,
    table_of: NDArray[np.int64] | None = None,
) -> Runs:
    """Integrate many runs over the whole grid at once.

    Args:
        grid: stamps and steps, n stamps.
        tables: beam motions from `Grid.tabulate`, shape (2 m + 1, 3) or (motions, 2 m + 1, 3).
        parameters: from `models.coefficients`, shape (SLOTS,) or (runs, SLOTS); longer where force laws follow.
        starts: s [m] and ṡ [m/s] at the first stamp, shape (runs, 2).
        table_of: index of each run's motion, shape (runs,); the first one by default.

    Raises:
        ValueError: arrays that do not fit the grid or each other; compiled code would read past their ends.
    """
    starts = np.atleast_2d(np.array(starts, float, order="C"))
    n = len(grid.time)
    first, last = np.zeros(len(starts), np.int64), np.full(len(starts), n - 1)
    position, velocity = integrate_windows(grid, tables, parameters, starts, first, last, table_of=table_of)
    return Runs(grid.time, position.reshape(-1, n), velocity.reshape(-1, n))


def integrate_windows(
    grid: Grid,
    tables: FloatArray,
    parameters: FloatArray,
    starts: FloatArray,
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    *,
    table_of: NDArray[np.int64] | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Integrate many runs at once, each over its own window of the grid.

    Args:
        grid, tables, parameters, table_of: as of `integrate`.
        starts: s [m] and ṡ [m/s] at each run's first stamp, shape (runs, 2).
        first, last: indices of the first and last stamp of each run, shape (runs,).

    Returns:
        s [m] and ṡ [m/s] at the stamps of one run after the other, shape (Σ (last − first + 1),) each.

    Raises:
        ValueError: arrays that do not fit the grid or each other; compiled code would read past their ends.
    """
    starts = np.atleast_2d(np.array(starts, float, order="C"))
    count = len(starts)
    tables = tables[None] if tables.ndim == 2 else tables
    # Copied: a broadcast array is read-only, for which numba would compile the kernel again.
    parameters = np.array(np.broadcast_to(parameters, (count, parameters.shape[-1])), float, order="C")
    table_of = np.zeros(count, np.int64) if table_of is None else np.asarray(table_of, np.int64)
    first, last = np.asarray(first, np.int64), np.asarray(last, np.int64)
    if tables.shape[1:] != (2 * len(grid.steps) + 1, 3):
        raise ValueError(f"tables have shape {tables.shape}; the grid asks for (…, {2 * len(grid.steps) + 1}, 3)")
    laws, rest = divmod(parameters.shape[1] - slots.SLOTS, slots.LAW_SLOTS)
    if laws < 0 or rest or starts.shape[1] != 2 or not len(table_of) == len(first) == len(last) == count:
        raise ValueError(f"{count} runs need as many starts (s, ṡ), motions, windows and {slots.SLOTS} parameters")
    if np.any((table_of < 0) | (table_of >= len(tables))):
        raise ValueError(f"table_of must lie within 0 … {len(tables) - 1}")
    if np.any((first < 0) | (first > last) | (last >= len(grid.time))):
        raise ValueError(f"windows must satisfy 0 <= first <= last <= {len(grid.time) - 1}")
    out = np.empty((int(np.sum(last - first + 1)), 2))
    chosen, begins, ends = fixed(table_of), fixed(first), fixed(last)
    _integrate(grid.steps, grid.marks, np.ascontiguousarray(tables), chosen, parameters, starts, begins, ends, out)
    return out[:, 0], out[:, 1]


def simulate(models: Sequence[Model], rig: Rig, motion: BeamMotion, start: State, time: FloatArray) -> list[Trajectory]:
    """Simulate several models from one start state.

    Args:
        models: any members of the family.
        rig: the rig of all of them.
        motion: of the beam, evaluated within `time[0]` … `time[-1]` only.
        start: the ball at `time[0]`.
        time: stamps at which the ball is wanted, shape (n,), strictly increasing [s].

    Returns:
        One trajectory for each model, in their order, named after it.

    Raises:
        ValueError: no stamps, or stamps that do not increase.
    """
    grid = Grid.over(time)
    vectors = np.array([coefficients(model, rig) for model in models])
    starts = np.tile((start.position, start.velocity), (len(models), 1))
    runs = integrate(grid, grid.tabulate(motion), vectors, starts)
    return [Trajectory(m.name, grid.time, runs.position[i], runs.velocity[i]) for i, m in enumerate(models)]
