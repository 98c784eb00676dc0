"""The diagnosis: identify what acts, validate it, compare it with baselines, and propose the next experiment."""

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

# Where each stage begins and ends as a share of the whole time, and about how many texts it tells: of a rig with one
# hidden effect and two recordings of 8 s, on two cores.
_SEARCH = (0.1, 0.5, 30.0)
_VALIDATION = (0.5, 0.7, 5.0)
_ENGINES = (0.7, 0.95, 10.0)


@dataclass(frozen=True)
class Another:
    """Errors before and after on a recording that nothing was fitted to, and those of the engines."""

    errors: BeforeAfter
    engines: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Diagnosis(Identification):
    """What the recordings say, and what it is worth.

    Attributes:
        identify, heldout: errors before and after.
        engines: the same in the engines' scenes, as in diagnosis.json.
        also: the same on further recordings, by name.
        next_experiment: what would tell the most; none where nothing is left to be told, or the rig can do nothing.
        baselines: comparison with models that know no physics; none where recordings are too short for it.
        hidden: effects that no recording can show, because the rig file leaves open what they change.
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
    """Identify, validate, compare, propose.

    Args:
        progress: told what is being done.
        also: further recordings, which nothing is fitted to and errors are told of.
        length: of the beam, where it is known [m]; the next experiment may use all of it.
        jobs: processes for the engines' runs (`harness.parallel`); 1 for this one.
    """
    searching, validating, running = (Stage(progress, *stage) for stage in (_SEARCH, _VALIDATION, _ENGINES))
    identified = identify(problem, searching)
    base, found = identified.base, identified.found
    held = fit_folds(problem, base, found, validating)
    others = {
        one.name: Another(
            on_another(problem, base, found, one, validating),
            engine_errors(HeldOut(problem, base, found, (one,)), progress=validating, jobs=jobs),
        )
        for one in also
    }
    seen = HeldOut(problem, base, found, problem.recordings)
    with engines_running(seen, held, running, jobs=jobs) as engines:
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
    """What tells the found from its rivals; where nothing was found, what shows most of what would go unseen."""
    progress("the next experiment")
    problem, found = identified.problem, identified.found
    if identified.verdict in (Verdict.EFFECT, Verdict.UNLISTED):
        rivals = {one.name: one.indistinguishable_from for one in identified.effects}
        pairs = pairs_of(found, identified.ledger, rivals, Criterion(problem.settings))
        return choose_to_discriminate(problem, found, pairs, length=length) if pairs else None
    return choose_to_detect(problem, found, identified.unseen, length=length) if identified.unseen else None
