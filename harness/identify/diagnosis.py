"""Closing the loop: search, reconsider, verify, and propose the next experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.identify.design.choose import pairs_of, reveal, separate
from harness.identify.design.proposal import Proposal
from harness.identify.problem.problem import Problem, Record
from harness.identify.selection.candidates import hidden_by
from harness.identify.selection.cross_validation import reconsider
from harness.identify.validation.baseline_comparison import Contest, contest
from harness.identify.validation.engine_errors import engine_errors, engines_running
from harness.identify.validation.held_out import Comparison, Split, held_out, on_another, on_identify, splits
from harness.identify.verdict import RIVAL, Search, Verdict, search
from harness.progress import Progress, Stage, silent

# Where each stage begins and ends as a share of the whole time, and about how many texts it tells: of the cases handed
# out with the project on two cores, typically.
_SEARCH = (0.1, 0.5, 60.0)
_VALIDATION = (0.5, 0.7, 5.0)
_ENGINES = (0.7, 0.95, 10.0)


@dataclass(frozen=True)
class Another:
    """Errors before and after on a recording that nothing was fitted to, and those of the engines."""

    errors: Comparison
    engines: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Diagnosis(Search):
    """What the recordings say, and what it is worth.

    Attributes:
        identify, heldout: errors before and after.
        engines: the same in the engines' scenes, as in diagnosis.json.
        also: the same on further recordings, by name.
        next_experiment: what would tell the most; none where nothing is left to be told, or the rig can do nothing.
        contest: with models that know next to nothing; none where recordings are too short for it.
        hidden: effects that no recording can show, because the rig file leaves open what they change.
    """

    identify: Comparison
    heldout: Comparison
    engines: Mapping[str, Mapping[str, Any]]
    also: Mapping[str, Another] = field(default_factory=dict)
    next_experiment: Proposal | None = None
    contest: Contest | None = None
    hidden: tuple[str, ...] = ()


def diagnose(
    problem: Problem,
    progress: Progress = silent,
    *,
    also: Sequence[Record] = (),
    length: float | None = None,
    jobs: int = 1,
) -> Diagnosis:
    """Find what acts, verify it by held-out predictions and by the engines, and propose the next experiment.

    Args:
        progress: told what is being done.
        also: further recordings, to which nothing is fitted, to verify on.
        length: of the beam, where it is known; the next experiment may use all of it [m].
        jobs: processes for the engines' runs (`harness.parallel`); 1 for this one.
    """
    searching, validating, running = (Stage(progress, *stage) for stage in (_SEARCH, _VALIDATION, _ENGINES))
    said = reconsider(search(problem, searching), searching)
    held = splits(problem, said.base, said.found, validating)
    others = {
        one.name: Another(
            on_another(problem, said.base, said.found, one, validating),
            engine_errors(Split(problem, said.base, said.found, (one,)), progress=validating, jobs=jobs),
        )
        for one in also
    }
    seen = Split(problem, said.base, said.found, problem.records)
    with engines_running(seen, held, running, jobs=jobs) as engines:
        return Diagnosis(
            **vars(said),
            identify=on_identify(problem, said.base, said.found, validating),
            heldout=held_out(held),
            also=others,
            next_experiment=_next(said, length, validating),
            contest=contest(held, validating),
            hidden=hidden_by(problem.unknown),
            engines=engines(),
        )


def _next(said: Search, length: float | None, progress: Progress) -> Proposal | None:
    """What tells the found from its rivals; where nothing was found, what shows most of what would go unseen."""
    progress("the next experiment")
    if said.verdict in (Verdict.EFFECT, Verdict.UNLISTED):
        rivals = {one.name: one.indistinguishable_from for one in said.findings}
        pairs = pairs_of(said.found, said.ledger, rivals, RIVAL)
        return separate(said.problem, said.found, pairs, length=length) if pairs else None
    return reveal(said.problem, said.found, said.unseen, length=length) if said.unseen else None
