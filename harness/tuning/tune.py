"""Tuning: select and fit an engine's parameters, judge the result, and hold it against held-out readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from harness.engines.catalogue import parameters_of
from harness.engines.protocol import Engine
from harness.errors import InputError
from harness.failures import Failed, Failures, Part, attempt
from harness.identify.problem.problem import Problem
from harness.progress import Progress, Stage, silent
from harness.tuning.estimate.free import LEVEL, Free, free_of, level_of
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
class Tuned:
    """What tuning found.

    Attributes:
        model: the engine, with what was free.
        windows: that it was fitted to.
        selection: fits and decisions.
        combinations: what the recordings do not tell apart.
        held_out: errors on held-out blocks; `None` where there are none.
        failures: parts that failed.
    """

    model: Model
    windows: tuple[Stretch, ...]
    selection: Selection
    combinations: tuple[Combination, ...]
    held_out: HeldOutErrors | None
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
) -> Tuned:
    """Tune an engine to the recordings of a problem.

    Args:
        problem: recordings, rig and declared effects.
        engine: to tune.
        settings: of it that stay as they are.
        names: of the parameters that may be tuned; `None` for the default set.
        progress: receives the progress texts.
        jobs: processes for the runs.

    Raises:
        InputError: a parameter cannot be free, or no recording is long enough.
        EngineFailure: the engine fails with its settings.
    """
    free = {one.name: one for one in free_parameters(problem, engine, settings, names)}
    model = Model(engine, problem, settings, free, jobs)
    windows = fitted_stretches(problem)
    if not windows:
        raise InputError("no recording to identify from has readings enough for a free run; record for 5 s or longer")
    failures = Failures()
    selection = select(model, windows, [name for name in free if name != LEVEL], Stage(progress, *_FITS))
    return Tuned(
        model,
        windows,
        selection,
        combinations(selection, tuple(free.values())),
        attempt(
            failures,
            Part.VALIDATION,
            "errors on held-out blocks",
            lambda: held_out_errors(model, selection, Stage(progress, *_ERRORS)),
            None,
        ),
        failures.all,
    )


def free_parameters(
    problem: Problem, engine: Engine, settings: Mapping[str, Any], names: Sequence[str] | None
) -> tuple[Free, ...]:
    """The level angle and the parameters that may be tuned.

    Raises:
        InputError: one of them cannot be.
    """
    return level_of(problem.rig), *free_of(engine, problem.rig, parameters_of(engine, settings), names)
