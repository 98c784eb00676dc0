"""Replay of a recorded ledger: do its hashes, deviances and decisions come out again from the same inputs?"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from harness.identify.estimate.fit import Fit, fit
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import SplineTerm
from harness.identify.record import DiagnosisRecord, FitRecord, LedgerLine, LedgerRecord, ProblemRecord
from harness.identify.selection.candidates import Progress
from harness.identify.selection.criterion import Criterion, Decision, Evidence, Rule
from harness.identify.selection.cross_validation import held_out_errors
from harness.identify.selection.ledger_record import fit_hash, hashed, problem_record
from harness.identify.selection.spline_terms import held_out_deviances

# Of a deviance, evaluated at the same parameters: another processor may round some thousand terms differently, by 1e-9
# at most; what decides is 6000 times as large.
_TOLERANCE = 1e-3
_RELATIVE = 1e-9  # of the problem's numbers, some of which are estimated


@dataclass(frozen=True)
class Mismatch:
    """Something that does not come out again: where, and what is recorded against what was found."""

    where: str
    what: str


@dataclass(frozen=True)
class Replay:
    """What a replay found.

    Attributes:
        attempts, fits: how many were replayed.
        mismatches: what did not come out again.
        largest: difference of a deviance.
    """

    attempts: int
    fits: int
    mismatches: tuple[Mismatch, ...]
    largest: float


def replay(
    record: LedgerRecord | DiagnosisRecord,
    problem: Problem,
    *,
    refit: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Replay:
    """Replay `ledger`, `fits` and `problem` of a diagnosis.json.

    Args:
        problem: posed anew from the same files.
        refit: re-optimise every fit from its recorded parameters, compute what was held out anew, and decide by what
            comes out, instead of evaluating the fits where they are.

    Raises:
        KeyError, ValueError: fits and decisions of the record do not belong together.
    """
    posed, recorded, lines = record.problem, record.fits, record.ledger
    mismatches = [*_problem(posed, problem)]
    fits: dict[str, Fit] = {}
    largest = 0.0
    for name, one in recorded.items():
        names = [each.name for each in one.effects]
        title = " + ".join([*names, *(["spline term"] if one.spline_term else [])]) or "none"
        progress(f"{title} ({len(fits) + 1} of {len(recorded)})")
        if fit_hash(posed, one) != name:
            mismatches.append(Mismatch(f"fit {name} ({title})", "its content does not give its hash"))
        found = _evaluated(one, problem)
        difference = abs(found.deviance - _number(one.deviance))
        largest = max(largest, difference)
        if difference > _TOLERANCE:
            text = f"deviance {found.deviance:.6f}, recorded {_number(one.deviance):.6f}"
            mismatches.append(Mismatch(f"fit {name} ({title})", text))
        fits[name] = _again(found, problem) if refit else found
    decisions = _decided_anew(lines, fits, problem, progress if refit else None)
    mismatches += _differences(lines, decisions, exact=not refit)
    return Replay(len(lines), len(recorded), tuple(mismatches), largest)


def _problem(posed: ProblemRecord, problem: Problem) -> Iterator[Mismatch]:
    if hashed(posed) != posed.hash:
        yield Mismatch("problem", "its content does not give its hash")
    recorded = posed.model_dump(exclude={"hash"})
    for key, value in problem_record(problem, posed.inputs).model_dump(exclude={"hash"}).items():
        if not _alike(value, recorded[key]):
            yield Mismatch("problem", f"{key} is {value}, recorded {recorded[key]}")


def _alike(one: Any, other: Any) -> bool:
    """Whether two records are the same but for rounding."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_alike(one[key], other[key]) for key in one)
    if isinstance(one, Sequence) and isinstance(other, Sequence) and not isinstance(one, str):
        return len(one) == len(other) and all(map(_alike, one, other))
    if isinstance(one, float) and isinstance(other, float | int):
        return math.isclose(one, other, rel_tol=_RELATIVE)
    return bool(one == other)


def _evaluated(one: FitRecord, problem: Problem) -> Fit:
    """A recorded fit, its deviance evaluated anew at its recorded parameters."""
    spline = None if one.spline_term is None else SplineTerm.of(one.spline_term)
    hypothesis = Hypothesis(tuple(each.name for each in one.effects), spline)
    theta = np.array(one.parameters, dtype=float)
    if len(theta) != hypothesis.size(problem):
        raise ValueError(f"{len(theta)} parameters for a hypothesis of {hypothesis.size(problem)}")
    at, process_noise = hypothesis.terms(theta, problem), one.process_noise_m2_s3
    return Fit(
        hypothesis,
        theta,
        at,
        process_noise,
        deviance(problem, at, process_noise),
        np.zeros((len(theta),) * 2),
        problem.readings,
    )


def _again(found: Fit, problem: Problem) -> Fit:
    """Re-optimised from where it is; where that leads nowhere better, as it is."""
    onward = fit(problem, found.hypothesis, process_noise=found.process_noise, starts=[found.theta])
    return onward if onward.deviance < found.deviance else replace(found)


def _decided_anew(
    lines: Sequence[LedgerLine], fits: Mapping[str, Fit], problem: Problem, refit: Progress | None
) -> list[Decision]:
    """Every decision by the rules of the search, from the fits and the held-out figures."""
    criterion = Criterion(problem.settings)
    decisions: list[Decision] = []
    rounds = groupby(lines, key=lambda line: (line.rule, line.against, line.evidence.winner))
    for (rule, against, _), each in rounds:
        tried = [(fits[line.fit], _evidence(line, fits, problem, refit)) for line in each]
        winner = _winner(Rule(rule), tried, criterion)
        for one, evidence in tried:
            among = evidence if evidence.winner is None else replace(evidence, winner=winner)
            decisions.append(criterion.decide(Rule(rule), one, fits[against], among))
    return decisions


def _winner(rule: Rule, tried: Sequence[tuple[Fit, Evidence]], criterion: Criterion) -> Fit | None:
    """The best of a round: by its held-out gain if that is what is asked, else by the criterion."""
    if rule is Rule.EXTEND:
        margins = [(criterion.reduction(evidence), one) for one, evidence in tried]
        sure = [(margin.value, one) for margin, one in margins if margin.sure]
        return max(sure, key=lambda each: each[0])[1] if sure else None
    return min((one for one, _ in tried), key=criterion.value)


def _evidence(
    line: LedgerLine,
    fits: Mapping[str, Fit],
    problem: Problem,
    refit: Progress | None,
) -> Evidence:
    """Evidence of a line; held-out figures as recorded, or computed anew."""
    recorded = line.evidence
    before, after = tuple(map(_number, recorded.before)), tuple(map(_number, recorded.after))
    one, against = fits[line.fit], fits[line.against]
    if refit is not None and before:
        if line.rule == Rule.SPLINE:
            before, after = held_out_deviances(problem, against, one, refit)
        else:
            refit(f"{line.effect} on held-out windows")
            before, after = held_out_errors(problem, against), held_out_errors(problem, one)
    return Evidence(
        winner=None if recorded.winner is None else fits[recorded.winner],
        holder=None if recorded.holder is None else fits[recorded.holder],
        without=tuple(fits[name] for name in recorded.without),
        before=before,
        after=after,
        tests=recorded.tests,
        nested=recorded.nested,
    )


def _differences(lines: Sequence[LedgerLine], decisions: Sequence[Decision], *, exact: bool) -> Iterator[Mismatch]:
    """Hashes, gains, decisions and reasons that are not as recorded."""
    for n, (line, now) in enumerate(zip(lines, decisions, strict=True)):
        where = f"attempt {n + 1}, {line.effect}"
        if hashed(line) != line.hash:
            yield Mismatch(where, "its content does not give its hash")
        if now.kept != line.kept:
            yield Mismatch(where, f"is {_fate(now.kept)}, recorded as {_fate(line.kept)}")
        if exact and not abs(now.gain - _number(line.gain)) <= _TOLERANCE:
            yield Mismatch(where, f"gain {now.gain:.4f}, recorded {_number(line.gain):.4f}")


def _fate(kept: bool) -> str:
    return "kept" if kept else "not kept"


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
