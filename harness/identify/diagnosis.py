"""The diagnosis: identify missing physics, validate it, compare it with baselines, propose the next experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.identify.design.choose import choose_to_detect, choose_to_discriminate, pairs_of
from harness.identify.design.proposal import Proposal
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.selection.candidates import hidden_by
from harness.identify.selection.criterion import Criterion
from harness.identify.validation.baseline_comparison import BaselineComparison, compare_with_baselines
from harness.identify.validation.engine_errors import engine_errors, engines_running
from harness.identify.validation.held_out import (
    BeforeAfter,
    HeldOut,
    fit_folds,
    on_another,
    on_held_out,
    on_identify,
)
from harness.identify.verdict import Identification, Verdict, identify
from harness.progress import Progress, Stage, silent

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
        hidden: effects that cannot be separated from unknown rig quantities.
    """

    identify: BeforeAfter
    heldout: BeforeAfter
    engines: Mapping[str, Mapping[str, Any]]
    also: Mapping[str, Another] = field(default_factory=dict)
    next_experiment: Proposal | None = None
    baselines: BaselineComparison | None = None
    hidden: tuple[str, ...] = ()


def diagnose(
    problem: Problem,
    progress: Progress = silent,
    *,
    also: Sequence[PreparedRecording] = (),
    length: float | None = None,
    jobs: int = 1,
) -> Diagnosis:
    """Identify, validate, compare with the baselines and propose the next experiment.

    Args:
        progress: receives the progress texts.
        also: further recordings, used for validation only.
        length: of the beam, where it is known [m]; the next experiment may use all of it.
        jobs: processes for the engines' runs (`harness.parallel`); 1 runs them in this process.
    """
    searching, validating, running = (Stage(progress, *stage) for stage in (_SEARCH, _VALIDATION, _ENGINES))
    identified = identify(problem, searching)
    base, found = identified.base, identified.found
    held = fit_folds(problem, base, found, validating)
    others = {
        recording.name: Another(
            on_another(problem, base, found, recording, validating),
            engine_errors(HeldOut(problem, base, found, (recording,)), progress=validating, jobs=jobs),
        )
        for recording in also
    }
    in_sample = HeldOut(problem, base, found, problem.recordings)
    with engines_running(in_sample, held, running, jobs=jobs) as engines:
        return Diagnosis(
            **vars(identified),
            identify=on_identify(problem, base, found, validating),
            heldout=on_held_out(held),
            also=others,
            next_experiment=_next_experiment(identified, length, validating),
            baselines=compare_with_baselines(held, validating),
            hidden=hidden_by(problem.unknown),
            engines=engines(),
        )


def _next_experiment(identified: Identification, length: float | None, progress: Progress) -> Proposal | None:
    """The motion that best discriminates the fit from its rivals; without a finding, that detects most `unseen`."""
    progress("design of the next experiment")
    problem, found = identified.problem, identified.found
    if identified.verdict in (Verdict.EFFECT, Verdict.UNLISTED):
        rivals = {effect.name: effect.indistinguishable_from for effect in identified.effects}
        pairs = pairs_of(found, identified.ledger, rivals, Criterion(problem.settings))
        return choose_to_discriminate(problem, found, pairs, length=length) if pairs else None
    return choose_to_detect(problem, found, identified.unseen, length=length) if identified.unseen else None
