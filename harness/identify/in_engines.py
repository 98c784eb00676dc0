"""Before and after in the engines: free runs of a scene without and with what was found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from analytic.effects import Acting, recorded_with, rig_with
from analytic.motion import BallForce, State
from analytic.rig import Rig
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of, parameters_of
from harness.engines.injection import force_of, motion_for_engine
from harness.errors import EngineFailure
from harness.identify.fit import Fit
from harness.identify.forecast import filtered
from harness.identify.problem import Problem, Record
from harness.identify.shape import Depends, Shape
from harness.identify.verify import KNOWN

# What makes a ball slide in an engine: its own friction, and limits that let it (see `harness run --help`).
_SLIPPERY: Mapping[str, Callable[[float], dict[str, Any]]] = {
    "mujoco": lambda mu: {"friction": mu, "slip_limit": 10.0, "friction_relaxation": 0.01},
    "pybullet": lambda mu: {"lateral_friction_ball": mu, "lateral_friction_rail": 1.0, "slip_limit": 10.0},
}


def engine_errors(
    problem: Problem, base: Fit, found: Fit, progress: Callable[[str], None] = lambda _: None
) -> dict[str, dict[str, Any]]:
    """RMS error [m] of each engine's free run after the first two seconds of each recording, without and with `found`.

    Where an engine fails, its message stands in place of the figure.
    """
    result: dict[str, dict[str, Any]] = {}
    for name in DEFAULT_ENGINES:
        progress(f"{name} with what was found")
        result[name] = {
            "before": {"rms_m": {"whole": _rms(problem, base, name)}},
            "after": {"rms_m": {"whole": _rms(problem, found, name)}},
        }
    return result


def _rms(problem: Problem, found: Fit, name: str) -> float | str:
    squares = []
    for record, phase in zip(problem.records, found.best.phases, strict=True):
        try:
            squares.append(_squares(problem, found, record, float(phase), name))
        except EngineFailure as failure:
            return str(failure)
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def _squares(problem: Problem, found: Fit, record: Record, phase: float, name: str) -> np.ndarray:
    time = record.time
    begin = int(np.searchsorted(time, time[0] + KNOWN))
    reading = np.where(np.arange(len(time)) < begin, record.reading, np.nan)
    out = filtered(problem, found, record, reading)
    effects = _phased((*problem.declared, *found.best.effects), phase)
    stamps = time[begin:]
    delay = sum(one.values["delay"] for one in effects if one.effect.name == "channel_delay")
    rig: Rig = rig_with(problem.rig, effects)
    motion = motion_for_engine(effects, record.drive, time)
    engine = engine_of(name)
    slip = [one.values["friction_coefficient"] for one in effects if one.effect.name == "contact_slip"]
    parameters = parameters_of(engine, _SLIPPERY[name](slip[0]) if slip else {})
    # The filter's state at t is that of t − delay, when the beam was where the ball then felt it.
    ball_time = stamps - delay
    inside = (ball_time >= time[0]) & (ball_time <= time[-1])
    shape = found.best.shape
    forces = [
        force_of(effects, rig, motion, ball_time[inside], parameters.time_step),
        None if shape is None else _curve(shape, rig, record.origin),
    ]
    start = State(float(out.state[begin, 0]), float(out.state[begin, 1]))
    run = engine.run(
        rig, motion, start, ball_time[inside], parameters=parameters, force=_sum([f for f in forces if f is not None])
    )
    # The delay is in the stamps already; gain and lag act on what is recorded.
    sensor = [one for one in effects if one.effect.name != "channel_delay"]
    recorded = recorded_with(stamps[inside], run.trajectory.position, sensor)
    error = recorded - record.reading[begin:][inside]
    squares: np.ndarray = error[np.isfinite(error)] ** 2
    return squares


def _phased(effects: Sequence[Acting], phase: float) -> list[Acting]:
    return [
        Acting(one.effect, {**one.values, "phase": phase}) if one.effect.name == "ball_imbalance" else one
        for one in effects
    ]


def _curve(shape: Shape, rig: Rig, origin: float) -> BallForce | None:
    """A force curve in an engine; a curve in the friction coefficient has none."""
    if shape.friction:
        return None

    def force(s: float, v: float, angle: float, time: float) -> float:
        at = {
            Depends.POSITION: s,
            Depends.VELOCITY: v,
            Depends.ANGLE: angle,
            Depends.ROLL_ANGLE: ((s - origin) / rig.rolling_radius) % (2.0 * np.pi),
            Depends.TIME: time,
        }[shape.depends]
        return rig.mass * float(np.interp(at, shape.places, shape.nodes))

    return force


def _sum(forces: Sequence[BallForce]) -> BallForce | None:
    if not forces:
        return None
    return lambda s, v, angle, time: sum(force(s, v, angle, time) for force in forces)
