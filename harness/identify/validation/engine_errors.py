"""Engine errors before and after: free runs of an engine without and with the identified terms."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.effects import SensorLaw, rig_with
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from analytic.slots import DRY_MINUS, DRY_PLUS, LEVEL
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of, parameters_of
from harness.engines.health import Failure, largest_of_each
from harness.engines.injection import engine_settings, force_of, motion_for_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.failures import Failed, Failures, Part, caught
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.forecast import filtered_ahead
from harness.identify.estimate.own_values import own_of
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.problem.windows import WHOLE, predicted_spans
from harness.identify.validation.held_out import HeldOut
from harness.numerics import evenly_chosen
from harness.parallel import meanwhile
from harness.progress import Progress, silent
from harness.scene import Scene

InjectedLaw = Callable[[FloatArray, float], None]
Squares = list[tuple[str, FloatArray]]
EngineSettings = Mapping[str, Mapping[str, Any]]
"""Settings of engines by name."""
RunKey = tuple[str, int | None, int]
"""Name of the engine, and identities of fit and recording."""
NO_SETTINGS: EngineSettings = MappingProxyType({})

# Time step of a rolling ball [s]: against steps of 0.5 ms no RMS error, over windows or whole recordings, changes by
# more than 8 µm on five measured rigs and 21 µm in six simulated cases; in steps of 10 ms, by up to 135 µm. For a
# sliding ball, where MuJoCo converges with first order only, the engines' default step is used.
_ROLLING_STEP = 4e-3
_MOST = 6  # recordings that the engines run: two fits to each, held out and not, take PyBullet seconds


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


def engine_errors(
    main: HeldOut,
    held: Sequence[HeldOut] = (),
    progress: Progress = silent,
    *,
    jobs: int = 1,
    failures: Failures | None = None,
    settings: EngineSettings = NO_SETTINGS,
    scene: Scene | None = None,
) -> dict[str, dict[str, Any]]:
    """RMS errors [m] of each engine by horizon, before and after; horizons as in `held_out.errors`.

    Every window is a free run of the engine from the filtered state at its beginning.

    Args:
        main: the fits, and the recordings with which they are compared.
        held: the same for held-out recordings, if any.
        jobs: processes for the runs (`harness.parallel`); 1 runs them in this process.
        failures: collects the engines' failures; whatever an engine raises is one.
        settings: of the engines by their names, such as tuned ones; those of effects found win.
        scene: of the user's own.

    Returns:
        By engine "before" and "after", each with "rms_m" by horizon, and "heldout" with both again. Where a run failed
        there is also "failed", its message, and no error of its horizon. "recordings" names those that the engine ran:
        of many, six from first to last.
        "warnings" says what the engine warns of in any of these runs, each warning with its largest number.
    """
    running = engines_running(main, held, progress, jobs=jobs, failures=failures, settings=settings, scene=scene)
    with running as errors:
        return errors()


@contextmanager
def engines_running(
    main: HeldOut,
    held: Sequence[HeldOut] = (),
    progress: Progress = silent,
    *,
    jobs: int = 1,
    failures: Failures | None = None,
    settings: EngineSettings = NO_SETTINGS,
    scene: Scene | None = None,
) -> Iterator[Callable[[], dict[str, dict[str, Any]]]]:
    """As `engine_errors`, but the engines run while the block does; the function that it is given awaits the errors."""
    loaded = {name: caught(Part.ENGINE, name, partial(_engine, name, scene)) for name in DEFAULT_ENGINES}
    engines = {name: engine for name, engine in loaded.items() if not isinstance(engine, Failed)}
    main, *held = [_of_few(split, main.compared) for split in (main, *held)]
    ran = [recording.name for recording in main.compared]
    runs: dict[RunKey, Callable[[], Ran | Failed]] = {}
    for engine in reversed(engines.values()):  # PyBullet is slowest: with the long jobs first, all cores end together
        for split in (main, *held):
            for fit, recording in itertools.product((split.base, split.found), split.compared):
                runs[_key(engine, fit, recording)] = partial(
                    _run_of, split.problem, fit, recording, engine, settings.get(engine.name, {})
                )
    title = f"{' and '.join(engines)} on {', '.join(ran)}"

    def before_after(
        engine: Engine | Failed, splits: Sequence[HeldOut], results: Mapping[RunKey, Ran | Failed]
    ) -> dict[str, Any]:
        def of(split: HeldOut, fit: Fit, recording: PreparedRecording) -> Ran | Failed:
            return engine if isinstance(engine, Failed) else results[_key(engine, fit, recording)]

        return {
            when: _errors([of(split, fit(split), recording) for split in splits for recording in split.compared])
            for when, fit in (("before", attrgetter("base")), ("after", attrgetter("found")))
        }

    def warnings(engine: Engine | Failed, results: Mapping[RunKey, Ran | Failed]) -> tuple[str, ...]:
        if isinstance(engine, Failed):
            return ()
        own = [one for (name, *_), one in results.items() if name == engine.name and isinstance(one, Ran)]
        return largest_of_each(text for one in own for text in one.warnings)

    def report(count: int) -> None:
        progress(f"{title}: run {count} of {len(runs)}", share=count / len(runs))

    with meanwhile(list(runs.values()), jobs, report) as wait:

        def errors() -> dict[str, dict[str, Any]]:
            progress(title, share=0.0)
            ended = caught(Part.ENGINE, " and ".join(engines), wait)  # a process may end with its engine
            results = dict.fromkeys(runs, ended) if isinstance(ended, Failed) else dict(zip(runs, ended, strict=True))
            for each in (*loaded.values(), *results.values()):
                to_blame = each.to_blame if isinstance(each, Ran) else (each,) if isinstance(each, Failed) else ()
                for failed in to_blame:
                    # A ball that lifts off stands in the table of the engines; it is no failure of one.
                    if failures is not None and not failed.of_the_rig:
                        failures.add(failed)
            return {
                name: before_after(engine, [main], results)
                | ({"heldout": before_after(engine, held, results)} if held else {})
                | {"recordings": ran, "warnings": warnings(engine, results)}
                for name, engine in loaded.items()
            }

        yield errors


def _engine(name: str, scene: Scene | None) -> Engine:
    """The engine; one without a scene of the user's is asked for by its name alone."""
    return engine_of(name) if scene is None else engine_of(name, scene)


def _of_few(split: HeldOut, recordings: Sequence[PreparedRecording]) -> HeldOut:
    """`split` with what it compares of `recordings`, evenly taken where they are many."""
    if len(recordings) <= _MOST:
        return split
    few = evenly_chosen(recordings, _MOST)
    return replace(split, compared=tuple(one for one in split.compared if any(one is other for other in few)))


def _key(engine: Engine, fit: Fit, recording: PreparedRecording) -> RunKey:
    """Identity of a run; without terms it does not depend on the fit."""
    nothing = not fit.hypothesis.names and fit.hypothesis.spline is None
    return engine.name, None if nothing else id(fit), id(recording)


def entries(fit: Fit) -> dict[str, str]:
    """How each identified term is injected into the engines, in words, by its name."""
    places = {term.effect.name: term.effect.enters for term in fit.terms.effects}
    if fit.terms.spline is not None:
        spline = fit.terms.spline
        onto = "friction on the ball" if spline.friction else "force on the ball"
        places["spline term"] = "sensor side: what is recorded of the position" if spline.sensor else onto
    return places


def _errors(runs: Sequence[Ran | Failed]) -> dict[str, Any]:
    squares: dict[str, list[FloatArray]] = {}
    failed: dict[str, Failed] = {}
    for run in runs:
        if isinstance(run, Failed):
            return {"rms_m": {}, "failed": str(run)}
        failed = {**run.failed, **failed}
        for horizon, values in run.squares:
            squares.setdefault(horizon, []).append(values)
    rms = {horizon: float(np.sqrt(np.mean(np.concatenate(each)))) for horizon, each in squares.items()}
    told = {"failed": str(next(iter(failed.values())))} if failed else {}
    return {"rms_m": {horizon: value for horizon, value in rms.items() if horizon not in failed}} | told


def _run_of(
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
        """The run with the first parameters that it does not fail with; other arguments as for `_run`."""
        for parameters in self.parameters:
            made = caught(Part.ENGINE, name, partial(self._run, parameters, state, ball_time, inside))
            if not isinstance(made, Failed):
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
