"""The diagnosis: identify missing physics, validate it, compare it with baselines, propose the next experiment."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeVar

from harness.failures import Failed, Failures, Part, attempt
from harness.identify.design.choose import choose_to_detect, choose_to_discriminate, pairs_of
from harness.identify.design.proposal import Proposal
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.selection.candidates import hidden_by
from harness.identify.selection.criterion import Criterion
from harness.identify.validation.baseline_comparison import FORECASTS, BaselineComparison, compare_with_baselines
from harness.identify.validation.engine_errors import NO_SETTINGS, EngineSettings, engine_errors, engines_running
from harness.identify.validation.forecast_parameters import fitted_to_forecasts
from harness.identify.validation.held_out import (
    UNKNOWN,
    BeforeAfter,
    HeldOut,
    fit_folds,
    on_another,
    on_held_out,
    on_identify,
)
from harness.identify.verdict import Identification, Verdict, identify
from harness.progress import Progress, Stage, silent
from harness.scene import Scene

T = TypeVar("T")

# Begin and end of each stage as shares of the whole time, and its usual number of progress texts: measured for a rig
# with one hidden effect and two recordings of 8 s, on two cores.
_SEARCH = (0.1, 0.5, 30.0)
_VALIDATION = (0.5, 0.7, 5.0)
_ENGINES = (0.7, 0.95, 10.0)


@dataclass(frozen=True)
class Another:
    """Errors before and after on a recording that nothing was fitted to, of the model and of the engines."""

    errors: BeforeAfter
    engines: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Diagnosis(Identification):
    """The identification with its validation.

    Attributes:
        identify, heldout: errors before and after, on the recordings fitted to and on held-out ones.
        engines: the same for the engines, as in diagnosis.json.
        also: the same on further recordings, by name.
        next_experiment: the proposed experiment; `None` if no motion of the library would add to the result.
        baselines: comparison with the baselines; `None` if the recordings are too short.
        forecasting: fit to forecasts, whose parameters predictions use; `None` if they use those found.
        hidden: effects that cannot be separated from unknown rig quantities.
        failures: parts that failed, without which the diagnosis was made.
    """

    identify: BeforeAfter
    heldout: BeforeAfter
    engines: Mapping[str, Mapping[str, Any]]
    also: Mapping[str, Another] = field(default_factory=dict)
    next_experiment: Proposal | None = None
    baselines: BaselineComparison | None = None
    forecasting: Fit | None = None
    hidden: tuple[str, ...] = ()
    failures: tuple[Failed, ...] = ()


def diagnose(
    problem: Problem,
    progress: Progress = silent,
    *,
    also: Sequence[PreparedRecording] = (),
    length: float | None = None,
    jobs: int = 1,
    settings: EngineSettings = NO_SETTINGS,
    scene: Scene | None = None,
) -> Diagnosis:
    """Identify, validate, compare with the baselines and propose the next experiment.

    A part that raises is left out and named in `failures`; only the rig's base fit has to succeed.

    Args:
        progress: receives the progress texts.
        also: further recordings, used for validation only.
        length: of the beam, where it is known [m]; the next experiment may use all of it.
        jobs: processes for the engines' runs and the search by held-out errors (`harness.parallel`); 1 runs all here.
        settings: of the engines by their names; their defaults without.
        scene: of the user's own, which engines run in place of the built-in one.
    """
    failures = Failures()
    identified = identify(problem, Stage(progress, *_SEARCH), failures, jobs=jobs)
    return validate(identified, failures, progress, also=also, length=length, jobs=jobs, settings=settings, scene=scene)


def validate(
    identified: Identification,
    failures: Failures,
    progress: Progress = silent,
    *,
    also: Sequence[PreparedRecording] = (),
    length: float | None = None,
    engines: bool = True,
    jobs: int = 1,
    settings: EngineSettings = NO_SETTINGS,
    scene: Scene | None = None,
) -> Diagnosis:
    """Validate an identification, compare it with the baselines and propose the next experiment.

    Args:
        failures: of the identification; collects further ones.
        progress, also, length, jobs, settings, scene: as of `diagnose`.
        engines: whether the engines run, too.
    """
    validating, running = (Stage(progress, *stage) for stage in (_VALIDATION, _ENGINES))
    problem, base, found = identified.problem, identified.base, identified.found

    def validated(name: str, job: Callable[[], T], otherwise: T) -> T:
        return attempt(failures, Part.VALIDATION, name, job, otherwise)

    held: tuple[HeldOut, ...] = validated(
        "fits without a recording", lambda: fit_folds(problem, base, found, validating), ()
    )
    others = {
        one.name: Another(
            validated(f"on {one.name}", partial(on_another, problem, base, found, one, validating), UNKNOWN),
            engine_errors(
                HeldOut(problem, base, found, (one,)),
                progress=validating,
                jobs=jobs,
                failures=failures,
                settings=settings,
                scene=scene,
            )
            if engines
            else {},
        )
        for one in (each.rougher(problem.roughness) for each in also)
    }
    in_sample = HeldOut(problem, base, found, problem.recordings)
    run = (
        engines_running(in_sample, held, running, jobs=jobs, failures=failures, settings=settings, scene=scene)
        if engines
        else nullcontext(dict)
    )
    with run as errors_of_engines:
        forecasting = attempt(
            failures,
            Part.BASELINES,
            "fit to forecasts",
            lambda: fitted_to_forecasts(problem, found, validating),
            None,
        )
        baselines = attempt(
            failures,
            Part.BASELINES,
            "",
            lambda: compare_with_baselines(problem, base, found, forecasting, validating),
            None,
        )
        made = Diagnosis(
            **vars(identified),
            identify=validated(
                "on the recordings fitted to", lambda: on_identify(problem, base, found, validating), UNKNOWN
            ),
            heldout=validated("on held-out recordings", lambda: on_held_out(held), UNKNOWN) if held else UNKNOWN,
            also=others,
            next_experiment=attempt(
                failures,
                Part.NEXT_EXPERIMENT,
                "",
                lambda: _next_experiment(identified, length, validating),
                None,
            ),
            baselines=baselines,
            forecasting=forecasting if baselines is not None and baselines.predicting == FORECASTS else None,
            hidden=hidden_by(problem.unknown),
            engines=errors_of_engines(),
        )
    return replace(made, failures=failures.all)


def _next_experiment(identified: Identification, length: float | None, progress: Progress) -> Proposal | None:
    """The motion that best discriminates the fit from its rivals; without a finding, that detects most `unseen`."""
    progress("design of the next experiment")
    problem, found = identified.problem, identified.found
    if identified.verdict in (Verdict.EFFECT, Verdict.UNLISTED):
        rivals = {effect.name: effect.rivals for effect in identified.effects}
        pairs = pairs_of(found, identified.ledger, rivals, Criterion(problem.settings))
        return choose_to_discriminate(problem, found, pairs, length=length) if pairs else None
    return choose_to_detect(problem, found, identified.unseen, length=length) if identified.unseen else None
