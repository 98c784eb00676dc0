"""Engine errors before and after: free runs of an engine without and with the identified terms."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from operator import attrgetter
from types import MappingProxyType
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of
from harness.engines.health import largest_of_each
from harness.engines.protocol import Engine
from harness.failures import Failed, Failures, Part, caught
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import PreparedRecording
from harness.identify.validation.engine_run import Ran, run_over
from harness.identify.validation.held_out import HeldOut
from harness.numerics import evenly_chosen
from harness.parallel import meanwhile
from harness.progress import Progress, silent
from harness.scene import Scene

EngineSettings = Mapping[str, Mapping[str, Any]]
"""Settings of engines by name."""
RunKey = tuple[str, int | None, int]
"""Name of the engine, and identities of fit and recording."""
NO_SETTINGS: EngineSettings = MappingProxyType({})

_MOST = 6  # recordings that the engines run: two fits to each, held out and not, take PyBullet seconds


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
                    run_over, split.problem, fit, recording, engine, settings.get(engine.name, {})
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
            to_blame = [each for each in (*loaded.values(), *results.values()) if isinstance(each, Failed)]
            to_blame += [failed for each in results.values() if isinstance(each, Ran) for failed in each.to_blame]
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
