"""Closing the loop: search, reconsider, verify, and propose the next experiment."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
    progress: Callable[[str], None] = lambda _: None,
    *,
    also: Sequence[Record] = (),
    length: float | None = None,
) -> Diagnosis:
    """Find, trace, verify, on the recordings `also` too, which nothing is fitted to; and propose the next experiment.

    On a beam of known `length` [m] that may use all of it.
    """
    said = reconsider(search(problem, progress), progress)
    held = splits(problem, said.base, said.found, progress)
    others = {
        one.name: Another(
            on_another(problem, said.base, said.found, one, progress),
            engine_errors(Split(problem, said.base, said.found, (one,)), progress=progress),
        )
        for one in also
    }
    with engines_running(Split(problem, said.base, said.found, problem.records), held, progress) as engines:
        return Diagnosis(
            **vars(said),
            identify=on_identify(problem, said.base, said.found, progress),
            heldout=held_out(held),
            also=others,
            next_experiment=_next(said, length, progress),
            contest=contest(held, progress),
            hidden=hidden_by(problem.unknown),
            engines=engines(),
        )


def _next(said: Search, length: float | None, progress: Callable[[str], None]) -> Proposal | None:
    """What tells the found from its rivals; where nothing was found, what shows most of what would go unseen."""
    progress("the next experiment")
    if said.verdict in (Verdict.EFFECT, Verdict.UNLISTED):
        rivals = {one.name: one.indistinguishable_from for one in said.findings}
        pairs = pairs_of(said.found, said.ledger, rivals, RIVAL)
        return separate(said.problem, said.found, pairs, length=length) if pairs else None
    return reveal(said.problem, said.found, said.unseen, length=length) if said.unseen else None
