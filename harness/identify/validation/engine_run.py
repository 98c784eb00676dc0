"""Free runs of an engine through the windows of one recording, with the identified terms injected."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.effects import SensorLaw, rig_with
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from analytic.slots import DRY_MINUS, DRY_PLUS, LEVEL
from harness.engines.catalogue import parameters_of
from harness.engines.health import Failure, largest_of_each
from harness.engines.injection import engine_settings, force_of, motion_for_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.failures import Failed, Part, caught
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered_ahead
from harness.identify.estimate.own_values import own_of
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.problem.windows import predicted_spans
from harness.metrics.score import WHOLE

InjectedLaw = Callable[[FloatArray, float], None]
Squares = list[tuple[str, FloatArray]]

# Time step of a rolling ball [s]: against steps of 0.5 ms no RMS error, over windows or whole recordings, changes by
# more than 8 µm on five measured rigs and 21 µm in six simulated cases; in steps of 10 ms, by up to 135 µm. For a
# sliding ball, where MuJoCo converges with first order only, the engines' default step is used.
_ROLLING_STEP = 4e-3


@dataclass(frozen=True)
class Ran:
    """Runs of an engine over one recording: squared errors [m²] by horizon, what the engine warns of, and how a run
    failed by the horizons that have no errors for that."""

    squares: Squares
    warnings: tuple[str, ...] = ()
    failed: Mapping[str, Failed] = field(default_factory=dict)

    @property
    def to_blame(self) -> tuple[Failed, ...]:
        """Failures of the engine.

        Shorter windows tile a recording. Where its engine runs through all of them, a run of the whole recording fails
        because its ball is where the recorded one never was, as that of every model may be.
        """
        return () if self.squares and set(self.failed) == {WHOLE} else tuple(self.failed.values())


def run_over(
    problem: Problem, found: Fit, recording: PreparedRecording, engine: Engine, settings: Mapping[str, Any]
) -> Ran | Failed:
    """What an engine makes of every window of a recording, or how it failed."""
    name = f"{engine.name} on {recording.name}"

    def ran() -> Ran:
        scene = _Scene(problem, found, recording, engine, settings)
        squares, failed = scene.squares(name)
        return Ran(squares, largest_of_each(scene.warnings), failed)

    return caught(Part.ENGINE, name, ran)


class _Scene:
    """One recording in one engine, with the identified terms injected."""

    def __init__(
        self,
        problem: Problem,
        found: Fit,
        recording: PreparedRecording,
        engine: Engine,
        given: Mapping[str, Any] = MappingProxyType({}),
    ) -> None:
        self.problem, self.found, self.recording = problem, found, recording
        own = own_of(problem, found, recording, recording.reading)
        self.effects = (*problem.declared, *found.terms.effects_in(own))
        self.rig: Rig = rig_with(problem.rig, self.effects)
        self.origin = float(found.terms.sensor_in(problem).position(np.array(recording.origin)))
        spline = found.terms.spline
        self.law = None if spline is None else law_of(spline, own.phase, problem.rig.gravity)
        self.phase = own.phase
        self.motion: BeamMotion = motion_for_engine(self.effects, recording.drive.gentle, recording.drive.time)
        self.sensor = found.terms.sensor_in(problem)
        self.engine = engine
        settings = {**given, **engine_settings(self.effects, engine.name)}
        # A ball that is thrown about far out on the beam may lose its contacts in steps that are wide.
        tried: list[dict[str, Any]] = [settings] if settings else [{"time_step": _ROLLING_STEP}, {}]
        if engine.scene_file:  # has less to set; what is left is the user's own
            tried = [{name: one[name] for name in one if name in engine.parameters.model_fields} for one in tried]
        self.parameters: list[EngineParameters] = [parameters_of(engine, one) for one in tried]
        self.warnings: list[str] = []

    def squares(self, name: str) -> tuple[Squares, dict[str, Failed]]:
        """Squared errors [m²] of every window with readings to compare, by horizon, and the failures of this `name` of
        other horizons.

        Windows that begin at the same stamp share one run, since their initial states are equal, unless it fails.
        """
        recording = self.recording
        time = recording.time - recording.time[0]
        known = np.isfinite(recording.reading)
        spans = [
            (horizon, slice(use.start, use.start + int(np.flatnonzero(known[use])[-1]) + 1))
            for horizon, use in predicted_spans(time, known, fewest=2)
        ]
        ends: dict[int, set[int]] = {}
        for _, use in spans:
            ends.setdefault(use.start, set()).add(use.stop)
        # With a delay, the filter's state at stamp t is that of the ball at t − delay.
        ball_time = recording.time - self.sensor.delay
        inside = (ball_time >= recording.time[0]) & (ball_time <= recording.time[-1])
        firsts = [begin + int(np.argmax(inside[begin : max(each)])) for begin, each in ends.items()]
        runs = filtered_ahead(
            self.problem,
            self.found,
            recording,
            [slice(begin, first + 1) for begin, first in zip(ends, firsts, strict=True)],
        )[1]
        errors: dict[int, FloatArray] = {}
        failures: dict[tuple[int, int], Failed] = {}
        for (begin, each), run in zip(ends.items(), runs, strict=True):
            for end in sorted(each, reverse=True):
                made = self._first_run(name, run.state[-1], ball_time[begin:end], inside[begin:end])
                if not isinstance(made, Failed):
                    errors[begin] = made - recording.reading[begin:end]
                    break
                failures[begin, end] = made
        failed = {horizon: failures[use.start, use.stop] for horizon, use in spans if (use.start, use.stop) in failures}
        squares = [
            (horizon, errors[use.start][: use.stop - use.start] ** 2) for horizon, use in spans if horizon not in failed
        ]
        return [(horizon, values[np.isfinite(values)]) for horizon, values in squares], failed

    def _first_run(
        self, name: str, state: FloatArray, ball_time: FloatArray, inside: NDArray[np.bool_]
    ) -> FloatArray | Failed:
        """The run with the first parameters that it does not fail with; a ball that lifts off does so with all.

        Args:
            name: of a failure.
            state, ball_time, inside: as for `_run`.
        """
        for parameters in self.parameters:
            made = caught(Part.ENGINE, name, partial(self._run, parameters, state, ball_time, inside))
            if not isinstance(made, Failed) or made.of_the_rig:
                break
        return made

    def _run(
        self, parameters: EngineParameters, state: FloatArray, ball_time: FloatArray, inside: NDArray[np.bool_]
    ) -> FloatArray:
        """Sensor output of a free run [m]; NaN where a delay would need the beam motion outside the recording.

        Args:
            parameters: of the engine.
            state: of the filter at the first time inside, as in `FilterOutput`, shape (4,).
            ball_time: times at which the ball is where the stamps record it, shape (m,) [s].
            inside: mask of those within the recording, shape (m,).
        """
        at = ball_time[inside]
        s, v, _, lagging = state
        force = force_of(
            self.effects,
            self.rig,
            self.motion,
            at,
            parameters.time_step,
            origin=self.origin,
            phase=self.phase,
            law=self.law,
        )
        run = self.engine.run(
            self.rig,
            self.motion,
            State(s, v),
            at,
            parameters=parameters,
            force=force,
            base=self.problem.rig,
        )
        self.warnings += run.health.warnings
        if not np.isfinite(run.trajectory.position).all():
            bad = float(at[np.argmin(np.isfinite(run.trajectory.position))])
            raise EngineFailure(self.engine.name, Failure.NOT_FINITE, bad, Failure.NOT_FINITE.value)
        position, lag = run.trajectory.position, self.sensor.lag
        if lag > 0.0:  # which begins as the filter has estimated it
            position = SensorLaw(lag=lag).recorded(at, position, behind=s - lagging)
        recorded = self.sensor.curve(position)
        result = np.full(len(ball_time), np.nan)
        result[inside] = recorded
        return result


def law_of(spline: SplineTerm, phase: float, gravity: float) -> InjectedLaw:
    """A function that writes a spline term into the kernel's vector, one of time before every step; an error of the
    sensor writes nothing."""
    original: dict[int, float] = {}
    written: list[FloatArray] = []

    def law(p: FloatArray, time: float) -> None:
        if spline.depends is not Regressor.TIME:
            if not written or written[0] is not p:  # it stays in the vector of a run
                spline.write(p, phase)
                written[:] = [p]
            return
        now = spline.at_one(time)
        for slot, value in ((DRY_PLUS, now), (DRY_MINUS, now)) if spline.friction else ((LEVEL, now / gravity),):
            p[slot] = original.setdefault(slot, float(p[slot])) + value

    return law
