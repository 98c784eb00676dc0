"""Engines beside bare loops: the same scene, prepared alike, stepped with the same drive and nothing but a log."""

from __future__ import annotations

import cProfile
import pstats
import time
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np
import pybullet
from mujoco import rollout

from analytic.geometry import RAIL_REACH
from analytic.motion import BallForce, FloatArray, State
from analytic.rig import Rig
from benchmarks.performance.pairs import Pair, pairs_of
from harness.engines import mujoco as of_mujoco
from harness.engines import pybullet as of_pybullet
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.leapfrog import grid_of, start_of
from harness.engines.many import Variant, run_many
from harness.engines.protocol import Engine, Task
from harness.engines.watch import limits_of

_DT = 1e-3  # [s]
_VISCOUS = 0.02  # [N s/m]
_THREADS = 2
_LISTED = 6  # functions of a profile


@dataclass(frozen=True)
class Swing:
    """α = a cos ω t: a ball that starts at rest stays within a few centimetres for minutes."""

    size: float = 0.01
    omega: float = 1.7

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return self.size * np.cos(self.omega * time)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        if order == 1:
            return -self.size * self.omega * np.sin(self.omega * time)
        return -self.size * self.omega**2 * np.cos(self.omega * time)


_START = State(0.36, 0.0)


def _task(engine: Engine[Any], seconds: float, force: BallForce | None = None) -> Task[Any]:
    """What `Engine.run` gives to its engine."""
    rig, settings = Rig(), parameters_of(engine, {"time_step": _DT})
    grid = grid_of(Swing(), np.arange(0.0, seconds, 0.01), _DT)
    limits = limits_of(rig, reach=RAIL_REACH, slip=settings.slip_limit)
    return Task(rig, settings, grid, start_of(rig, Swing(), grid, _START, force), force, limits)


def _ours(engine: Engine[Any], seconds: float, force: BallForce | None = None) -> None:
    stamps = np.arange(0.0, seconds, 0.01)
    of_mujoco._scene.cache_clear()  # a run from the making of the scene on, as the loops are
    engine.run(Rig(), Swing(), _START, stamps, parameters=parameters_of(engine, {"time_step": _DT}), force=force)


def _mujoco_scene(task: Task[Any]) -> tuple[Any, Any, FloatArray]:
    """Model, data at the start, and the beam's angular accelerations, shape (steps,) [rad/s²]."""
    model, lift = of_mujoco._scene.__wrapped__(task.rig, task.settings)
    assert lift is not None
    data = of_mujoco._place(model, task.first, float(task.grid.angle[0]), lift)
    return model, data, np.diff(task.grid.rate, prepend=task.first.beam_rate) / _DT


def mujoco_loop(seconds: float) -> FloatArray:
    """Ball positions at every step, shape (steps, 3) [m], by a loop in Python with a position log."""
    task = _task(engine_of("mujoco"), seconds)
    model, data, turns = _mujoco_scene(task)
    log, control, pose, step = np.empty((len(turns), 3)), data.ctrl, data.qpos[1:4], mujoco.mj_step
    for n, turn in enumerate(turns.tolist()):
        control[0] = turn
        step(model, data)
        log[n] = pose
    return log


def mujoco_loop_with_force(seconds: float, force: BallForce) -> FloatArray:
    """The same with a force along the beam, evaluated and applied at every step."""
    task = _task(engine_of("mujoco"), seconds, force)
    model, data, turns = _mujoco_scene(task)
    log, control, pose, step = np.empty((len(turns), 3)), data.ctrl, data.qpos[1:4], mujoco.mj_step
    where, speed, applied = data.qpos, data.qvel, data.qfrc_applied
    cosines, sines = np.cos(task.grid.angle).tolist(), np.sin(task.grid.angle).tolist()
    angles, times = task.grid.angle.tolist(), task.grid.time.tolist()
    for n, turn in enumerate(turns.tolist()):
        cos, sin = cosines[n], sines[n]
        s, v = where[1] * cos - where[3] * sin, speed[1] * cos - speed[3] * sin
        push = force(s, v, angles[n], times[n])
        applied[1], applied[3] = push * cos, -push * sin
        control[0] = turn
        step(model, data)
        log[n] = pose
    return log


def mujoco_rollout(seconds: float) -> FloatArray:
    """Full states at every step by `mujoco.rollout`, shape (steps, states)."""
    task = _task(engine_of("mujoco"), seconds)
    model, data, turns = _mujoco_scene(task)
    first = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, first, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states, _ = rollout.rollout(model, data, first, turns[:, None])
    return np.asarray(states[0])


def pybullet_loop(seconds: float) -> FloatArray:
    """Ball positions at every step, shape (steps, 3) [m], by a loop in Python with a drive and a position log."""
    task = _task(engine_of("pybullet"), seconds)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        scene = of_pybullet._load(task.rig, task.settings, client)
        scene.place(task.first)
        set_joints, simulate, where = (
            pybullet.resetJointStatesMultiDof,
            pybullet.stepSimulation,
            pybullet.getBasePositionAndOrientation,
        )
        beam, ball, joints, log = scene.beam, scene.ball, scene.joints, np.empty((task.grid.steps, 3))
        turned, turning, still = [0.0], [0.0], [0.0]
        # The joints that slide get off what gravity adds in a step.
        values, rates = [turned, still, still], [turning, [-scene.sag[0]], [-scene.sag[1]]]
        for n, (angle, rate) in enumerate(zip(task.grid.angle.tolist(), task.grid.rate.tolist(), strict=False)):
            turned[0], turning[0] = angle, rate
            set_joints(beam, joints, values, rates, client)
            simulate(client)
            log[n] = where(ball, client)[0]
        return log
    finally:
        pybullet.disconnect(client)


def _viscous(s: float, v: float, angle: float, time: float) -> float:
    return -_VISCOUS * v


def profile(name: str, seconds: float) -> str:
    """Where the time of an engine's run goes by a profile: its largest functions with their shares, in words."""
    engine, told = engine_of(name), cProfile.Profile()
    _ours(engine, seconds)
    told.runcall(_ours, engine, seconds)
    entries = pstats.Stats(told).get_stats_profile()
    largest = sorted(entries.func_profiles.items(), key=lambda one: -one[1].tottime)[:_LISTED]
    shares = (f"`{_bare(title)}` {100.0 * one.tottime / entries.total_tt:.1f} %" for title, one in largest)
    return ", ".join(shares)


def _bare(title: str) -> str:
    """`mujoco._batch.rollout` of a profile's `<built-in method mujoco._batch.rollout>`."""
    return title.strip("{}<>").removeprefix("built-in method ").replace("method ", "").replace("'", "")


def against_loop(pairs: int, seconds: float = 60.0) -> list[Pair]:
    """MuJoCo's engine against a loop in Python."""
    return pairs_of(partial(_ours, engine_of("mujoco"), seconds), partial(mujoco_loop, seconds), pairs)


def against_loop_with_force(pairs: int, seconds: float = 30.0) -> list[Pair]:
    """The same with a viscous force along the beam."""
    ours = partial(_ours, engine_of("mujoco"), seconds, _viscous)
    return pairs_of(ours, partial(mujoco_loop_with_force, seconds, _viscous), pairs)


def against_rollout(pairs: int, seconds: float = 60.0) -> list[Pair]:
    """MuJoCo's engine against `mujoco.rollout`."""
    return pairs_of(partial(_ours, engine_of("mujoco"), seconds), partial(mujoco_rollout, seconds), pairs)


def pybullet_against_loop(pairs: int, seconds: float = 20.0) -> list[Pair]:
    """PyBullet's engine against a loop in Python."""
    return pairs_of(partial(_ours, engine_of("pybullet"), seconds), partial(pybullet_loop, seconds), pairs)


def many_against_rollout(pairs: int, variants: int = 64, seconds: float = 10.0) -> list[Pair]:
    """Variants of MuJoCo's friction on two cores, against `mujoco.rollout` of as many models in two threads.

    Time on the wall, models made from their MJCF in both.
    """
    engine, stamps = engine_of("mujoco"), np.arange(0.0, seconds, 0.01)
    settings = [parameters_of(engine, {"friction": x, "time_step": _DT}) for x in np.linspace(0.3, 1.0, variants)]
    tasks = [Variant(Rig(), Swing(), _START, stamps, one) for one in settings]

    def ours() -> None:
        run_many(engine, tasks, workers=_THREADS)

    def theirs() -> None:
        task = _task(engine, seconds)
        models = [of_mujoco._load(Rig(), one) for one in settings]  # type: ignore[arg-type]
        _, data, turns = _mujoco_scene(task)
        first = np.empty(mujoco.mj_stateSize(models[0], mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(models[0], data, first, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        workers = [mujoco.MjData(models[0]) for _ in range(_THREADS)]
        rollout.rollout(models, workers, np.tile(first, (variants, 1)), np.tile(turns[:, None], (variants, 1, 1)))

    return pairs_of(ours, theirs, pairs, time.monotonic)
