"""Tuning: select and fit an engine's parameters, judge the result, and hold it against held-out readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from analytic.rig import Rig
from harness.engines.catalogue import parameters_of
from harness.engines.protocol import Engine
from harness.errors import EngineFailure, InputError
from harness.failures import Failed, Failures, Part, attempt
from harness.identify.problem.problem import Problem
from harness.jobs import Executor
from harness.numerics import rms
from harness.progress import Progress, Stage, silent
from harness.tuning.cam import level_of_cam
from harness.tuning.estimate.fit import run_through
from harness.tuning.estimate.free import LEVEL, Free, Named, free_of, level_of
from harness.tuning.estimate.runs import Model
from harness.tuning.estimate.selection import Selection, select
from harness.tuning.estimate.windows import Stretch, fitted_stretches
from harness.tuning.held_out import HeldOutErrors, held_out_errors
from harness.tuning.identifiability import Combination, combinations

_FITS, _ERRORS = (0.05, 0.6, 20.0), (0.6, 0.9, 6.0)  # begin and end as shares of the whole, number of texts


class Verdict(StrEnum):
    """Verdicts; names as in tuning.json."""

    TUNED = "tuned"
    NOTHING = "nothing_to_tune"
    PHYSICS = "physics_missing"


@dataclass(frozen=True)
class Rejected:
    """What pays on the readings that it was fitted to, and predicts held-out ones no better.

    Attributes:
        names: of the parameters.
        before, after: RMS errors on held-out blocks without and with them [m].
    """

    names: tuple[str, ...]
    before: float
    after: float


@dataclass(frozen=True)
class Tuned:
    """What tuning found.

    Attributes:
        model: the engine, with what was free.
        windows: that it was fitted to.
        selection: fits and decisions.
        combinations: what the recordings do not tell apart.
        held_out: errors on held-out blocks; `None` where there are none.
        rejected: what is not tuned although it pays in sample.
        left_out: failures of the engine with its settings, one of each window that it does not run through.
        failures: parts that failed.
    """

    model: Model
    windows: tuple[Stretch, ...]
    selection: Selection
    combinations: tuple[Combination, ...]
    held_out: HeldOutErrors | None
    rejected: Rejected | None = None
    left_out: tuple[EngineFailure, ...] = ()
    failures: tuple[Failed, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The answer."""
        if self.selection.pays:
            return Verdict.TUNED
        return Verdict.NOTHING if self.selection.found.complete else Verdict.PHYSICS

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the engine beside its defaults: what the user set, what was tuned and what that needs."""
        return self.model.engine_values(self._chosen) if self.selection.pays else dict(self.model.settings)

    @property
    def scene(self) -> dict[str, float]:
        """Tuned quantities of the scene, by their keys in rig.toml; with the level angle if anything was tuned."""
        return {name: value for name, value in self._chosen.items() if self.model.free[name].quantity}

    @property
    def _chosen(self) -> dict[str, float]:
        return dict(self.selection.found.values) if self.selection.pays else {}


def tune(
    problem: Problem,
    engine: Engine,
    settings: Mapping[str, Any],
    names: Sequence[str] | None = None,
    progress: Progress = silent,
    *,
    jobs: int = 1,
    executor: Executor | None = None,
) -> Tuned:
    """Tune an engine to the recordings of a problem.

    Args:
        problem: recordings, rig and declared effects.
        engine: to tune.
        settings: of it that stay as they are.
        names: of the parameters that may be tuned; `None` for the default set.
        progress: receives the progress texts.
        jobs: processes of this machine for the runs.
        executor: that the fits of candidates and of held-out blocks are handed to, such as a cluster's.

    Raises:
        InputError: a parameter cannot be free, or no recording is long enough.
        EngineFailure: the engine fails with its settings in every window.
    """
    free = {one.name: one for one in free_parameters(problem, engine, settings, names)}
    model = Model(engine, problem, settings, free, jobs, executor)
    windows = fitted_stretches(problem)
    if not windows:
        raise InputError("no recording to identify from has readings enough for a free run; record for 5 s or longer")
    failures = Failures()
    tried = [name for name in free if name != LEVEL]
    left_out: tuple[EngineFailure, ...] = ()
    levelled = attempt(failures, Part.SEARCH, "level of CAM", lambda: level_of_cam(problem), None)
    try:
        selection = select(model, windows, tried, Stage(progress, *_FITS), levelled)
    except EngineFailure:
        windows, left_out = run_through(model, windows, {LEVEL: float(free[LEVEL].default or 0.0)})
        if not left_out:
            raise
        selection = select(model, windows, tried, Stage(progress, *_FITS), levelled)
    held_out = attempt(
        failures,
        Part.VALIDATION,
        "errors on held-out blocks",
        lambda: held_out_errors(model, windows, selection, Stage(progress, *_ERRORS)),
        None,
    )
    selection, held_out, rejected = _predicting(selection, held_out)
    told_apart = combinations(selection, tuple(free.values()))
    return Tuned(model, windows, selection, told_apart, held_out, rejected, left_out, failures.all)


def _predicting(
    selection: Selection, held_out: HeldOutErrors | None
) -> tuple[Selection, HeldOutErrors | None, Rejected | None]:
    """The same, or nothing tuned where physics is missing and what pays in sample predicts no better.

    A parameter of an incomplete model fits the colour of what is missing; that of a complete one is known from the
    fit, better than a few blocks tell.
    """
    if held_out is None or not selection.pays or selection.found.complete:
        return selection, held_out, None
    before, after = rms(held_out.before), rms(held_out.after)
    if after < before:
        return selection, held_out, None
    return replace(selection, pays=()), held_out.untuned(), Rejected(selection.pays, before, after)


def check_names(engine: Engine, settings: Mapping[str, Any], names: Sequence[str] | None) -> None:
    """Refuse names that cannot be free on any rig, before anything is computed for this one.

    Raises:
        InputError: there are none, or one of them cannot be.
    """
    if names is not None and not any(name.strip() for name in names):
        raise InputError("--free names no parameter; name one, or leave it out for the default set")
    # Bounds of quantities of the scene follow from the rig's.
    plain = None if names is None else [Named.of(one).name for one in names]
    free_of(engine, Rig(), parameters_of(engine, settings), plain)


def free_parameters(
    problem: Problem, engine: Engine, settings: Mapping[str, Any], names: Sequence[str] | None
) -> tuple[Free, ...]:
    """The level angle and the parameters that may be tuned.

    Raises:
        InputError: one of them cannot be.
    """
    return level_of(problem.rig, names), *free_of(engine, problem.rig, parameters_of(engine, settings), names)
