"""MuJoCo: the ball on the edges of two boxes, or on one, on a hinge driven by its angular acceleration.

Semi-implicit Euler has its velocities at t − dt/2. A hinge of inertia 1e11 kg m² with the initial rate at −dt/2, driven
with the second difference of the recorded angle, follows the recorded angle to 3e-10 rad under any load.

The validated accuracy requires (each with a test in `tests/engines/test_mujoco.py`, numbers in mjcf/README.md): initial
velocities half a step early; a margin with which the soft contact carries the ball at its declared height; friction
that removes 1.8 times the slip per step or more, because the contact frame lags by half a step; and low friction across
the beam, so that the normal forces carry the load.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from mujoco.batch import Batch
from scipy.optimize import brentq

from analytic.geometry import channel_of, rails_of, to_beam
from analytic.motion import BallForce, FloatArray
from analytic.rig import Rig
from harness.engines.health import Failure
from harness.engines.leapfrog import Grid, Start, Track, spin_angle_of, track_of
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.engines.protocol import Engine, Task
from harness.engines.watch import Samples
from harness.errors import EngineFailure
from mjcf.scene import make_scene

CHUNK = 500  # steps between two checks for an early stop
FIRST_CHUNK = 10 * CHUNK  # the same where MuJoCo loops by itself, in chunks that double
_STATE, _TIME = mujoco.mjtState.mjSTATE_INTEGRATION, int(mujoco.mjtState.mjSTATE_TIME)
# Longest loss of contact that is tolerated if the ball touches before and after it [s]. The angular momentum about the
# contact line is the same in flight and in rolling, so the ball lands with the state of a rolling ball; at 3° the
# position is off by (1 − K) g sin α t²/2 = 8 µm in between.
FLIGHT = 0.01


class MuJoCo(Engine[MuJoCoParameters]):
    """The rig in MuJoCo."""

    name = "mujoco"
    parameters = MuJoCoParameters
    threads = True

    def version(self) -> str:
        """Version of the installed package."""
        return str(mujoco.__version__)

    def drive(self, task: Task[MuJoCoParameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""
        rig, grid = task.rig, task.grid
        with _quiet():
            model, lift = _scene(rig, task.settings)
            if lift is None:
                failure = Failure.LEFT_GROOVE
                text = f"the contacts are too soft to carry the ball; {failure.value}"
                raise EngineFailure(self.name, failure, float(grid.time[0]), text)
            data = _place(model, task.first, float(grid.angle[0]), lift)
            log = _drive(model, data, task)
        track = track_of(rig, grid, log.pose[:, 1:4], spin_angle_of(log.pose[:, 6], log.pose[:, 4]))
        samples = _samples(rig, grid, log)
        samples.extremes["warnings"] = _warnings(data)
        return track, samples


@dataclass(frozen=True)
class _Log:
    """States and contact forces of a run, one row per step, up to its end or early stop.

    Attributes:
        pose: α [rad], centre [m] and quaternion, shape (k + 1, 8).
        force: of each contact, normal first, shape (k, 6) [N]; (k, 3) on a flat rail.
        clock: MuJoCo's time since the run's begin, shape (k + 1,) [s].
        stopped: failure reported by the engine itself, if any.
    """

    pose: FloatArray
    force: FloatArray
    clock: FloatArray
    stopped: tuple[Failure, str] | None = None

    def late(self, begin: int, end: int, time_step: float) -> int | None:
        """The first of these steps in which MuJoCo's clock did not advance by a step."""
        late = np.flatnonzero(np.diff(self.clock[begin : end + 1]) < 0.5 * time_step)
        return begin + int(late[0]) if late.size else None


_warning = threading.Lock()  # guards the two below
_runs, _handler = 0, None  # runs of this process, in whatever thread, and what handled warnings before them


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps MuJoCo from printing warnings and writing MUJOCO_LOG.TXT; it also counts them in its data."""
    global _runs, _handler
    with _warning:
        if _runs == 0:
            _handler = mujoco.get_mju_user_warning()
            mujoco.set_mju_user_warning(lambda message: None)
        _runs += 1
    try:
        yield
    finally:
        with _warning:
            _runs -= 1
            if _runs == 0:
                mujoco.set_mju_user_warning(_handler)


@lru_cache(maxsize=8)  # a diagnosis runs one recording's windows one after another; no run changes a model
def _scene(rig: Rig, settings: MuJoCoParameters) -> tuple[mujoco.MjModel, float | None]:
    """The compiled scene, and what `_set_margin` returns."""
    model = _load(rig, settings)
    return model, _set_margin(model, rig, settings.margin)


def _load(rig: Rig, settings: MuJoCoParameters) -> mujoco.MjModel:
    channel = rails_of(rig)
    scene = make_scene(rig, channel=channel, option=settings.option(rig), pair=settings.pair(rig), driven=True)
    model = mujoco.MjModel.from_xml_string(scene)
    if not settings.refsafe:
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE
    return model


def _set_margin(model: mujoco.MjModel, rig: Rig, margin: float | None) -> float | None:
    """Sets the margin with which the contacts carry the ball at its declared height; returns the excess height [m].

    `None` where the contacts are too soft to carry it.

    Without a margin the ball sinks into its soft contacts, by 0.2 µm at dt = 1 ms with our defaults and by 0.3 mm with
    MuJoCo's: that changes r, and s by 14 µm and by 16 mm in 10 s. A margin equal to that depth compensates it.
    """
    data = mujoco.MjData(model)
    model.pair_margin[:] = 0.0
    level = float(data.qpos[3])

    def unbalanced(depth: float) -> float:
        data.qpos[3] = level - depth
        mujoco.mj_forward(model, data)
        return float(data.qacc[3])

    deepest, depth = 0.1 * rig.rolling_radius, 1e-12
    while unbalanced(depth) <= 0.0:
        depth *= 10.0
        if depth > deepest:
            return None
    unbalanced(brentq(unbalanced, 0.0, depth, xtol=1e-15))
    sunk = -float(data.contact.dist.min())
    model.pair_margin[:] = sunk if margin is None else margin
    return 0.0 if margin is None else (margin - sunk) * channel_of(rig).ball_radius / rig.rolling_radius


def _place(model: mujoco.MjModel, first: Start, angle: float, lift: float) -> mujoco.MjData:
    """Initial state: positions at t₀, velocities at t₀ − dt/2."""
    data = mujoco.MjData(model)
    up = np.array([np.sin(angle), 0.0, np.cos(angle)])
    data.qpos[0], data.qpos[1:4] = angle, np.array(first.centre) + lift * up
    data.qvel[0], data.qvel[1:4], data.qvel[5] = first.beam_rate, first.velocity, first.spin
    return data


def _drive(model: mujoco.MjModel, data: mujoco.MjData, task: Task[MuJoCoParameters]) -> _Log:
    """Steps through the grid; stops early if the run is invalid."""
    steps = task.grid.steps
    turns = np.diff(task.grid.rate, prepend=task.first.beam_rate) / task.grid.time_step
    log = _Log(np.empty((steps + 1, model.nq)), np.empty((steps, model.nsensordata)), np.zeros(steps + 1))
    log.pose[0] = data.qpos
    begin = 0 if task.force else _natively(model, data, task, turns, log)
    return _step_by_step(model, data, task, turns, log, begin)


def _natively(
    model: mujoco.MjModel, data: mujoco.MjData, task: Task[MuJoCoParameters], turns: FloatArray, log: _Log
) -> int:
    """Fill `log` by MuJoCo's own loop, bit for bit as steps from Python fill it; returns the step that it got to.

    That loop repeats a state that MuJoCo reset or warned about, without saying why: it ends with `data` at the begin of
    such a chunk, for `_step_by_step` to find out. It also ends after a chunk that leads out of bounds. Chunks double:
    what is done between two of them, 0.15 ms, was 0.7 % of a run of a minute in even ones, and no run that ends early
    steps on for longer than it had already run, or for the first chunk.
    """
    state = np.empty(mujoco.mj_stateSize(model, _STATE))
    mujoco.mj_getState(model, data, state, _STATE)
    batch = Batch(model, 1, 1)
    batch.state[0] = state
    begin, steps = 0, task.grid.steps
    while begin < steps:
        end = min(begin + max(begin, FIRST_CHUNK), steps)
        state[:] = batch.state[0]
        rows = slice(begin + 1, end + 1)
        record: dict[str | int, FloatArray] = {"qpos": log.pose[None, rows], "sensordata": log.force[None, begin:end]}
        record[_TIME] = log.clock[None, rows, None]
        batch.rollout(end - begin, turns[None, begin:end, None], record=tuple(record), out=record)
        late = batch.warning.any() or log.late(begin, end, task.grid.time_step) is not None
        if late or _out_of_bounds(task, log, end):
            mujoco.mj_setState(model, data, state, _STATE)
            return begin
        begin = end
    return steps


def _step_by_step(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    task: Task[MuJoCoParameters],
    turns: FloatArray,
    log: _Log,
    first: int,
) -> _Log:
    """The log with the steps from `first` on, which begin at the state of `data`; up to an early stop."""
    if first == task.grid.steps:
        return log
    poses, forces, clock, controls = log.pose, log.force, log.clock, turns.tolist()
    pose, control, sensors, step = data.qpos, data.ctrl, data.sensordata, mujoco.mj_step
    push = None if task.force is None else _pusher(task.force, task.grid, task.first, data)
    for begin in range(first, task.grid.steps, CHUNK):
        end = min(begin + CHUNK, task.grid.steps)
        for n in range(begin, end):
            control[0] = controls[n]
            if push is not None:
                push(n)
            step(model, data)
            poses[n + 1] = pose
            forces[n] = sensors
            clock[n + 1] = data.time
        late = log.late(begin, end, task.grid.time_step)
        if late is not None:
            n, reset = late, clock[late + 1] < clock[late]
            why = (Failure.RESET, "MuJoCo reset its state") if reset else (Failure.FROZEN, "MuJoCo's clock stood still")
            return _Log(poses[: n + 1], forces[: max(n, 1)], clock[: n + 1], why)
        if _out_of_bounds(task, log, end):
            return _Log(poses[: end + 1], forces[:end], clock[: end + 1])
    return log


def _out_of_bounds(task: Task[MuJoCoParameters], log: _Log, n: int) -> bool:
    """Whether the ball has left the rails at t_n."""
    x, y, z = log.pose[n, 1:4].tolist()
    along, across, normal = to_beam(x, y, z, float(task.grid.angle[n]))
    return task.limits.exceeded(along, across, normal - task.rig.eccentricity - task.rig.rolling_radius)


def _pusher(force: BallForce, grid: Grid, first: Start, data: mujoco.MjData) -> Callable[[int], None]:
    """A function that sets the force F(s, ṡ, α, t) of the step that begins at t_n, given n.

    ṡ at t_n is extrapolated from the engine's last two half-step velocities.
    """
    dt, backwards = grid.time_step, 1.0 / grid.time_step
    time, angle = grid.time.tolist(), grid.angle.tolist()
    cosines, sines = np.cos(grid.angle).tolist(), np.sin(grid.angle).tolist()
    where, applied = data.qpos.item, data.qfrc_applied
    speed_before = first.velocity_along - dt * first.acceleration_along
    before = where(1) * cosines[0] - where(3) * sines[0] - dt * first.velocity_along

    def push(n: int) -> None:
        nonlocal before, speed_before
        cos, sin = cosines[n], sines[n]
        along = where(1) * cos - where(3) * sin
        speed = (along - before) * backwards
        size = force(along, 1.5 * speed - 0.5 * speed_before, angle[n], time[n])
        applied[1], applied[3] = size * cos, -size * sin
        before, speed_before = along, speed

    return push


def _samples(rig: Rig, grid: Grid, log: _Log) -> Samples:
    """Samples with the maxima of every interval `FLIGHT`, and fewest contacts and smallest load of all steps."""
    touching, load = np.zeros(len(log.force), np.int64), np.zeros(len(log.force))
    for normal in log.force.T[::3]:  # one contact after the other: sums over short rows take ten times as long
        touching += normal > 0.0
        load += normal
    load *= rig.rolling_radius / channel_of(rig).ball_radius
    error = np.abs(log.pose[:, 0] - grid.angle[: len(log.pose)])
    every = max(1, round(FLIGHT / grid.time_step))
    samples = Samples(extremes={"contacts_min": int(touching.min()), "normal_force_min": float(load.min())})
    if log.stopped is not None:
        samples.stopped = len(log.pose) - 1, *log.stopped
    begins = np.arange(max(1, len(touching) // every)) * every  # the last window includes the remainder
    samples.step.frombytes(begins.tobytes())
    samples.contacts.frombytes(np.maximum.reduceat(touching, begins).tobytes())
    samples.normal_force.frombytes(np.maximum.reduceat(load, begins).tobytes())
    samples.angle_error.frombytes(np.maximum.reduceat(error, begins).tobytes())
    return samples


def _warnings(data: mujoco.MjData) -> tuple[str, ...]:
    """MuJoCo's warnings with their counts."""
    kinds = [kind for kind in mujoco.mjtWarning.__members__.values() if kind != mujoco.mjtWarning.mjNWARNING]
    counts = [(kind.name.removeprefix("mjWARN_"), data.warning[int(kind)].number) for kind in kinds]
    return tuple(f"{name} × {count}" for name, count in counts if count)
