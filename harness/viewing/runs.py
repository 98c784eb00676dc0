"""Free runs of one engine over a whole recording, as they are shown: without and with the effects of a diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.effects import Acting, PositionError, SensorLaw, rig_with, sensor_with
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.comparison.setting import Setting
from harness.engines.catalogue import parameters_of
from harness.engines.injection import engine_settings, force_of, motion_for_engine
from harness.engines.protocol import Engine, EngineRun
from harness.errors import EngineFailure
from harness.identify.estimate.forecast import filtered_ahead
from harness.identify.estimate.own_values import own_of
from harness.identify.model_file import observed_for, prepared_for, read_model, with_noise_of
from harness.identify.problem.windows import KNOWN
from harness.identify.record import ModelRecord
from harness.identify.validation.engine_run import InjectedLaw, law_of
from harness.signals.ball_state import BallEstimate
from harness.signals.drive import Drive

FEWEST = 4  # stamps of a run that is worth showing, and that a cubic goes through


@dataclass(frozen=True)
class ShownRun:
    """An engine's free run, as the position sensor would record it.

    Attributes:
        name: what acts in it, in words.
        effects: names of the effects that act, declared ones included.
        rig: with what effects do to it.
        motion: of the beam, with what effects do to it.
        time: stamps, shape (n,) [s].
        position: of the ball along the beam, shape (n,) [m].
        rolled: rotation of the ball relative to the beam since the start, shape (n,) [rad].
        lifted_off: when the ball lifts off the beam, with which the run ends; `None` if it does not [s].
    """

    name: str
    effects: tuple[str, ...]
    rig: Rig
    motion: BeamMotion
    time: FloatArray
    position: FloatArray
    rolled: FloatArray
    lifted_off: float | None = None


@dataclass(frozen=True)
class _Acting:
    """What acts in a run: effects, the rig before them, the drive, how the ball lies at the start [rad], a further law
    of the ball, or an error of the position sensor.

    `state` gives s [m], ṡ [m/s] of the ball that is recorded at a stamp, by its number, and what a lagging sensor has
    of it [m]; without it they are those of the smoothed readings.
    """

    effects: tuple[Acting, ...]
    rig: Rig
    ball: BallEstimate
    drive: Drive
    phase: float = 0.0
    law: InjectedLaw | None = None
    error: PositionError | None = None
    state: Callable[[int], tuple[float, float, float]] | None = None


def run_without(setting: Setting, engine: Engine, given: Mapping[str, Any], *, beside: bool = False) -> ShownRun:
    """The run of `harness run`: the rig as it is known, with the effects that its file declares.

    Args:
        setting: the recording, its drive and start.
        engine: that runs.
        given: its settings.
        beside: begin where a run with the effects of a diagnosis begins, which it is shown beside.

    Raises:
        EngineFailure: the run is invalid.
        InputError: a setting is none of the engine's.
    """
    acting = _Acting(setting.acting, setting.rig, setting.ball, setting.drive)
    first = _after_run_in(setting) if beside else int(setting.horizons[0].first[0])
    scene = engine.scene_file  # decides all but the level angle and the declared effects
    told = f"as {scene} and rig.toml say" if scene else "as rig.toml says"
    return _run(told, setting, engine, given, acting, first)


def run_with(setting: Setting, engine: Engine, given: Mapping[str, Any], model: ModelRecord, origin: str) -> ShownRun:
    """The run with the effects that a diagnosis found.

    It begins two seconds after the first position, with the state that the filter of the model has by then, as the
    engines' runs of a diagnosis do.

    Args:
        setting, engine, given: as of `run_without`.
        model: of the diagnosis.
        origin: its file, for messages.

    Raises:
        EngineFailure: the run is invalid.
        InputError: the model cannot be used.
    """
    observed = observed_for(model, setting.recording, setting.case.sensors)
    prepared = prepared_for(model, observed)
    problem, found = read_model(with_noise_of(model, observed.used), prepared, origin)
    own = own_of(problem, found, prepared, prepared.reading)
    spline = found.terms.spline
    law = None if spline is None else law_of(spline, own.phase, problem.rig.gravity)
    effects = (*problem.declared, *found.terms.effects_in(own))
    names = [*model.effects, *([] if spline is None else ["a law that no catalogue lists"])]
    rig = f"as {engine.scene_file} says" if engine.scene_file else "with the diagnosed rig"
    told = f"with {', '.join(names)}" if names else f"{rig}; no effects were found"

    def state(stamp: int) -> tuple[float, float, float]:
        span = slice(min(first, stamp), stamp + 1)
        position, velocity, _, lagging = filtered_ahead(problem, found, prepared, [span])[1][0].state[-1].tolist()
        return position, velocity, lagging

    first = _after_run_in(setting)
    error = found.terms.sensor_in(problem).error
    acting = _Acting(effects, problem.rig, observed.ball, prepared.drive, own.phase, law, error, state)
    return _run(told, setting, engine, given, acting, first)


def _after_run_in(setting: Setting) -> int:
    """The stamp two seconds after the first position, or after a third of a short recording."""
    begin = float(setting.time[int(setting.horizons[0].first[0])])
    return int(np.searchsorted(setting.time, begin + min(KNOWN, (float(setting.time[-1]) - begin) / 3.0)))


def _run(
    name: str, setting: Setting, engine: Engine, given: Mapping[str, Any], acting: _Acting, first: int
) -> ShownRun:
    effects, ball = acting.effects, acting.ball
    rig, sensor = rig_with(acting.rig, effects), replace(sensor_with(effects), error=acting.error)
    motion = motion_for_engine(effects, acting.drive.gentle, setting.time)
    recorded_at, at = _stamps(setting.time, sensor, first)
    stamp = int(np.searchsorted(setting.time, recorded_at[0]))
    position, velocity, lagging = (acting.state or _smoothed(setting.time, ball, sensor))(stamp)
    parameters = parameters_of(engine, _applicable(engine, {**given, **engine_settings(effects, engine.name)}, given))
    origin = float(sensor.position(ball.position[setting.horizons[0].first[0]]))

    def free(at: FloatArray) -> EngineRun:
        dt, phase, law = parameters.time_step, acting.phase, acting.law
        force = force_of(effects, rig, motion, at, dt, origin=origin, phase=phase, law=law)
        return engine.run(
            rig, motion, State(position, velocity), at, parameters=parameters, force=force, base=acting.rig
        )

    run, lifted_off = _until_lift_off(free, at)
    at, recorded_at = at[: len(run.rolled_angle)], recorded_at[: len(run.rolled_angle)]
    recorded = sensor.curve(_lagging(at, run.trajectory.position, sensor, lagging))
    names = tuple(one.effect.name for one in effects)
    return ShownRun(name, names, rig, motion, recorded_at, recorded, run.rolled_angle, lifted_off)


def _until_lift_off(free: Callable[[FloatArray], EngineRun], at: FloatArray) -> tuple[EngineRun, float | None]:
    """A run over the stamps, shape (n,) [s], or over those before the ball lifts off, and when it does [s].

    Raises:
        EngineFailure: the run is invalid for another reason, or the ball lifts off at once.
    """
    try:
        return free(at), None
    except EngineFailure as failure:
        before = at[at < failure.time]
        if not failure.of_the_rig or len(before) < FEWEST:
            raise
        return free(before), failure.time


def _applicable(engine: Engine, settings: Mapping[str, Any], given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Settings without those of effects that an engine with a scene of the user's does not have."""
    fields = engine.parameters.model_fields
    return {name: value for name, value in settings.items() if name in fields or name in given}


def _stamps(time: FloatArray, sensor: SensorLaw, first: int) -> tuple[FloatArray, FloatArray]:
    """Stamps from the one of this number on, and when the ball is where they record it, both of shape (n,) [s]."""
    recorded = time[first:]
    at = recorded - sensor.delay
    inside = (at >= time[0]) & (at <= time[-1])  # a delay would need the angle outside the recording
    return recorded[inside], at[inside]


def _lagging(at: FloatArray, position: FloatArray, sensor: SensorLaw, begins: float) -> FloatArray:
    """What a lagging sensor has of a run, shape (n,) [m]; it does not begin settled, but with what it then had."""
    if not sensor.lag:
        return position
    return SensorLaw(lag=sensor.lag).recorded(at, position, behind=float(position[0]) - begins)


def _smoothed(time: FloatArray, ball: BallEstimate, sensor: SensorLaw) -> Callable[[int], tuple[float, float, float]]:
    """The ball's state by the smoothed readings; a lag shows a smooth motion later by its time constant."""

    def state(stamp: int) -> tuple[float, float, float]:
        shown = float(time[stamp]) + sensor.lag
        position = sensor.position(np.array(np.interp(shown, time, ball.position)))
        velocity = np.interp(shown, time, ball.velocity) / sensor.slope(position)
        return float(position), float(velocity), float(sensor.position(ball.position[stamp]))

    return state


def rms_and_largest(run: ShownRun, time: FloatArray, reading: FloatArray) -> tuple[float, float]:
    """RMS and largest difference of the run from the readings [m]; NaN without any.

    Args:
        run: the run.
        time, reading: stamps, and positions with NaN where they are not known or not trusted, shape (m,) [s], [m].
    """
    use = np.isfinite(reading) & (time >= run.time[0]) & (time <= run.time[-1])
    if not use.any():
        return float("nan"), float("nan")
    error = np.interp(time[use], run.time, run.position) - reading[use]
    return float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error)))
