"""Runs every model and engine with one drive, on every horizon."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from analytic.effects import rig_with, sensor_with
from analytic.kernel import Grid, integrate
from analytic.models import Model
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from harness.comparison.horizons import Horizon
from harness.comparison.setting import Setting
from harness.engines.health import Health
from harness.engines.injection import force_of, motion_for_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.progress import Progress, silent


@dataclass(frozen=True)
class SourceRuns:
    """The runs of one source (model or engine) on one horizon.

    Attributes:
        source: `cam`, `mujoco` …
        horizon: begin and end of the runs.
        position, velocity: shape (runs, n), NaN outside a run and if the engine failed [m], [m/s].
        health: of the successful engine runs.
        failures: of the failed engine runs.
    """

    source: str
    horizon: Horizon
    position: FloatArray
    velocity: FloatArray
    health: tuple[Health, ...] = ()
    failures: tuple[EngineFailure, ...] = ()


def run_models(
    setting: Setting, models: Sequence[Model], horizon: Horizon, *, rig: Rig | None = None
) -> list[SourceRuns]:
    """Runs `models` on one horizon in one call of the kernel, with `rig` or by default the setting's rig."""
    grid = Grid.over(setting.time)
    table = grid.tabulate(setting.motion)
    count = len(horizon.first)
    starts = setting.starts(horizon)
    vectors = np.array([setting.vector(model, rig) for model in models])
    runs = integrate(
        grid,
        table,
        np.repeat(vectors, count, axis=0),
        np.tile(starts, (len(models), 1)),
        first=np.tile(horizon.first, len(models)),
        last=np.tile(horizon.last, len(models)),
    )
    shape = (len(models), count, len(setting.time))
    position, velocity = runs.position.reshape(shape), runs.velocity.reshape(shape)
    for one in position:
        _apply_sensor(setting, horizon, one)
    return [SourceRuns(m.name, horizon, position[i], velocity[i]) for i, m in enumerate(models)]


def _apply_sensor(setting: Setting, horizon: Horizon, position: FloatArray) -> None:
    """Applies declared sensor effects to the positions of a source, shape (runs, n), in place."""
    sensor = sensor_with(setting.acting)
    for run, where in zip(position, horizon.slices(), strict=True):
        if np.isfinite(run[where]).any():
            run[where] = sensor.recorded(setting.time[where], run[where])


def run_engine(setting: Setting, engine: Engine, parameters: EngineParameters, horizon: Horizon) -> SourceRuns:
    """Runs one engine on one horizon; a failed run is recorded in `failures` and its trajectory is NaN."""
    shape = (len(horizon.first), len(setting.time))
    position, velocity = np.full(shape, np.nan), np.full(shape, np.nan)
    health: list[Health] = []
    failures: list[EngineFailure] = []
    rig = rig_with(setting.rig, setting.acting)
    motion = motion_for_engine(setting.acting, setting.drive, setting.time)
    for i, (where, start) in enumerate(zip(horizon.slices(), setting.starts(horizon), strict=True)):
        stamps = setting.time[where]
        force = force_of(setting.acting, rig, motion, stamps, parameters.time_step, origin=setting.origin)
        try:
            run = engine.run(rig, motion, State(*start), stamps, parameters=parameters, force=force)
        except EngineFailure as failure:
            failures.append(failure)
            continue
        position[i, where], velocity[i, where] = run.trajectory.position, run.trajectory.velocity
        health.append(run.health)
    _apply_sensor(setting, horizon, position)
    return SourceRuns(engine.name, horizon, position, velocity, tuple(health), tuple(failures))


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
