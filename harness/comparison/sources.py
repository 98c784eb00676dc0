"""Runs every model and engine with one drive, on every horizon."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.effects import rig_with, sensor_with
from analytic.kernel import Grid, integrate_windows
from analytic.lift_off import first_lift_off
from analytic.models import CAM, Model
from analytic.motion import FloatArray, State, beam_states
from analytic.rig import Rig
from harness.comparison.horizons import Horizon
from harness.comparison.setting import Setting
from harness.engines.health import Failure, Health
from harness.engines.injection import force_of, motion_for_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.progress import Progress, silent

_INSTANT = 1e-3  # between two instants at which the normal force is looked at: the engines' time step [s]


@dataclass(frozen=True)
class SourceRuns:
    """The runs of one source (model or engine) on one horizon.

    Attributes:
        source: `cam`, `mujoco` …
        horizon: begin and end of the runs.
        position, velocity: at `horizon.stamps`, shape (k,), NaN where the engine failed [m], [m/s].
        health: of the successful engine runs.
        failures: of the failed engine runs.
        lifted_off: when the ball lifts off the beam for the first time, in each run in which it does [s].
    """

    source: str
    horizon: Horizon
    position: FloatArray
    velocity: FloatArray
    health: tuple[Health, ...] = ()
    failures: tuple[EngineFailure, ...] = ()
    lifted_off: tuple[float, ...] = ()


def run_models(
    setting: Setting, models: Sequence[Model], horizon: Horizon, *, rig: Rig | None = None
) -> list[SourceRuns]:
    """Runs `models` on one horizon in one call of the kernel, with `rig` or by default the setting's rig."""
    grid = Grid.over(setting.time)
    table = grid.tabulate(setting.motion)
    count = len(horizon.first)
    starts = setting.starts(horizon)
    vectors = np.array([setting.vector(model, rig) for model in models])
    runs = integrate_windows(
        grid,
        table,
        np.repeat(vectors, count, axis=0),
        np.tile(starts, (len(models), 1)),
        np.tile(horizon.first, len(models)),
        np.tile(horizon.last, len(models)),
    )
    position, velocity = (one.reshape(len(models), -1) for one in runs)
    lifted: tuple[float, ...] = ()
    if CAM in models:  # holds for all of them: it is the ball that lifts off
        cam = models.index(CAM)
        lifted = tuple(_lifted_off(setting, horizon, position[cam], velocity[cam], rig or setting.rig))
    for one in position:
        _apply_sensor(setting, horizon, one)
    return [SourceRuns(m.name, horizon, position[i], velocity[i], lifted_off=lifted) for i, m in enumerate(models)]


def _lifted_off(
    setting: Setting, horizon: Horizon, position: FloatArray, velocity: FloatArray, rig: Rig
) -> Iterator[float]:
    """When the normal force of CAM falls below zero for the first time, in each run in which it does [s].

    Args:
        setting: drive and declared effects.
        horizon: of the runs.
        position, velocity: of CAM's runs, shape (k,) [m], [m/s].
        rig: on which they were made.
    """
    altered = rig_with(rig, setting.acting)
    for where, s, v in zip(horizon.slices(), horizon.pieces(position), horizon.pieces(velocity), strict=True):
        stamps = setting.time[where]
        path = CubicHermiteSpline(stamps, s, v)
        fine = np.append(np.arange(stamps[0], stamps[-1], _INSTANT), stamps[-1])
        found = first_lift_off(path(fine), path(fine, 1), beam_states(setting.motion, fine), altered)
        if found is not None:
            yield float(fine[found])


def _apply_sensor(setting: Setting, horizon: Horizon, position: FloatArray) -> None:
    """Applies declared sensor effects to the positions of a source, shape (k,), in place."""
    sensor = sensor_with(setting.acting)
    for run, where in zip(horizon.pieces(position), horizon.slices(), strict=True):
        if np.isfinite(run).any():
            run[:] = sensor.recorded(setting.time[where], run)


def run_engine(setting: Setting, engine: Engine, parameters: EngineParameters, horizon: Horizon) -> SourceRuns:
    """Runs one engine on one horizon; a failed run is recorded in `failures` and its trajectory is NaN."""
    position, velocity = np.full((2, len(horizon.stamps)), np.nan)
    positions, velocities = horizon.pieces(position), horizon.pieces(velocity)
    health: list[Health] = []
    failures: list[EngineFailure] = []
    lifted: list[float] = []
    rig = rig_with(setting.rig, setting.acting)
    motion = motion_for_engine(setting.acting, setting.drive, setting.time)
    for i, (where, start) in enumerate(zip(horizon.slices(), setting.starts(horizon), strict=True)):
        stamps = setting.time[where]
        force = force_of(setting.acting, rig, motion, stamps, parameters.time_step, origin=setting.origin)
        try:
            run = engine.run(rig, motion, State(*start), stamps, parameters=parameters, force=force, base=setting.rig)
        except EngineFailure as failure:
            failures.append(failure)
            lifted += [failure.time] if failure.failure is Failure.LIFTED_OFF else []
            continue
        positions[i][:], velocities[i][:] = run.trajectory.position, run.trajectory.velocity
        health.append(run.health)
        lifted += [] if run.health.lifted_off is None else [run.health.lifted_off]
    _apply_sensor(setting, horizon, position)
    return SourceRuns(engine.name, horizon, position, velocity, tuple(health), tuple(failures), tuple(lifted))


def run_all(
    setting: Setting,
    models: Sequence[Model],
    engines: Iterable[tuple[Engine, EngineParameters]],
    progress: Progress = silent,
) -> list[SourceRuns]:
    """Runs every source on every horizon, models first."""
    engines = list(engines)
    runs: list[SourceRuns] = []
    for horizon in setting.horizons:
        progress(f"models, {horizon.name}")
        runs += run_models(setting, models, horizon)
    for engine, parameters in engines:
        for horizon in setting.horizons:
            progress(f"{engine.name}, {horizon.name}")
            runs.append(run_engine(setting, engine, parameters, horizon))
    return runs
