"""Replay of a recorded ledger: check that its hashes, deviances and decisions follow from the same inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from harness.identify.estimate.band import Band
from harness.identify.estimate.block_errors import block_errors
from harness.identify.estimate.cross_validation import cross_validated
from harness.identify.estimate.fit import Estimator, Fit, fit, quiet_deviance
from harness.identify.estimate.free_run_fit import in_sample_losses
from harness.identify.estimate.travel import Travel
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import SplineTerm
from harness.identify.problem.windows import fitted_windows
from harness.identify.record import DiagnosisRecord, FitRecord, LedgerLine, LedgerRecord, ProblemRecord
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Decision, Evidence, Rule
from harness.identify.selection.ledger import Line
from harness.identify.selection.ledger_record import fit_hash, hashed, problem_record
from harness.identify.selection.search import Selection
from harness.identify.selection.spline_terms import held_out_deviances
from harness.progress import Progress, silent

# Absolute tolerance of a deviance at the same parameters: its some thousand terms may round differently by up to 1e-9
# on another processor; the smallest decision threshold is 1.
_TOLERANCE = 1e-3
_RELATIVE = 1e-9  # relative tolerance of the problem's numbers, some of which are estimates
_WRONG_HASH = "its content does not give its hash"


@dataclass(frozen=True)
class Mismatch:
    """A difference between record and replay: where it is, and both values."""

    where: str
    what: str


@dataclass(frozen=True)
class Replay:
    """Result of a replay.

    Attributes:
        attempts, fits: numbers of decisions and fits that were replayed.
        mismatches: all differences.
        largest: largest difference of a deviance.
        selection: the fits and decisions of the record, evaluated; `None` if it does not name its fits.
    """

    attempts: int
    fits: int
    mismatches: tuple[Mismatch, ...]
    largest: float
    selection: Selection | None = None


def replay(
    record: LedgerRecord | DiagnosisRecord,
    problem: Problem,
    *,
    refit: bool = False,
    progress: Progress = silent,
) -> Replay:
    """Replay `ledger`, `fits` and `problem` of a diagnosis.json.

    Args:
        problem: made from the same files.
        refit: re-optimise every fit from its recorded parameters and recompute held-out results before deciding,
            instead of evaluating the fits at their recorded parameters.

    Raises:
        KeyError, ValueError: fits and decisions of the record are inconsistent.
    """
    posed, recorded, lines = record.problem, record.fits, record.ledger
    mismatches = [*_problem_differences(posed, problem)]
    fits: dict[str, Fit] = {}
    recorded_fits: dict[str, Fit] = {}
    largest = 0.0
    for name, entry in recorded.items():
        names = [effect.name for effect in entry.effects]
        title = " + ".join([*names, *(["spline term"] if entry.spline_term else [])]) or "none"
        progress(f"replay: {title} ({len(fits) + 1} of {len(recorded)})")
        if fit_hash(posed, entry) != name:
            mismatches.append(Mismatch(f"fit {name} ({title})", _WRONG_HASH))
        evaluated = _evaluated(entry, problem)
        difference = abs(evaluated.deviance - _number(entry.deviance))
        largest = max(largest, difference)
        if difference > _TOLERANCE:
            text = f"deviance {evaluated.deviance:.6f}, recorded {_number(entry.deviance):.6f}"
            mismatches.append(Mismatch(f"fit {name} ({title})", text))
        value = Criterion(problem.settings).value(evaluated)
        if not abs(value - _number(entry.criterion)) <= _TOLERANCE:
            text = f"criterion {value:.6f}, recorded {_number(entry.criterion):.6f}"
            mismatches.append(Mismatch(f"fit {name} ({title})", text))
        recorded_fits[name] = evaluated
        fits[name] = _refitted(evaluated, problem) if refit else evaluated
    decisions = _decisions(lines, fits, problem, progress if refit else None)
    mismatches += _decision_differences(lines, decisions, exact=not refit)
    selection = _selection(record, recorded_fits, problem)
    return Replay(len(lines), len(recorded), tuple(mismatches), largest, selection)


def _selection(record: LedgerRecord | DiagnosisRecord, fits: Mapping[str, Fit], problem: Problem) -> Selection | None:
    """The result of the search that a record tells, with its fits evaluated."""
    if record.found not in fits:
        return None
    lines = tuple(
        Line(
            Rule(line.rule),
            line.tried,
            fits[line.fit],
            fits[line.against],
            _evidence(line, fits, problem, None),
            Decision(line.kept, _number(line.gain), line.because),
        )
        for line in record.ledger
    )
    return Selection(problem, next(iter(fits.values())), fits[record.found], lines)


def _problem_differences(posed: ProblemRecord, problem: Problem) -> Iterator[Mismatch]:
    if hashed(posed) != posed.hash:
        yield Mismatch("problem", _WRONG_HASH)
    recorded = posed.model_dump(exclude={"hash"})
    for key, value in problem_record(problem, posed.inputs).model_dump(exclude={"hash"}).items():
        if not _alike(value, recorded[key]):
            yield Mismatch("problem", f"{key} is {value}, recorded {recorded[key]}")


def _alike(one: Any, other: Any) -> bool:
    """Whether two records agree up to rounding."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_alike(one[key], other[key]) for key in one)
    if isinstance(one, Sequence) and isinstance(other, Sequence) and not isinstance(one, str):
        return len(one) == len(other) and all(map(_alike, one, other))
    if isinstance(one, float) and isinstance(other, float | int):
        return math.isclose(one, other, rel_tol=_RELATIVE)
    return bool(one == other)


def _evaluated(entry: FitRecord, problem: Problem) -> Fit:
    """A recorded fit with the deviance at its recorded parameters."""
    spline = None if entry.spline_term is None else SplineTerm.of(entry.spline_term)
    hypothesis = Hypothesis(tuple(effect.name for effect in entry.effects), spline)
    theta = np.array(entry.parameters, dtype=float)
    if len(theta) != hypothesis.size(problem):
        raise ValueError(f"{len(theta)} parameters for a hypothesis of {hypothesis.size(problem)}")
    at, process_noise = hypothesis.terms(theta, problem), entry.process_noise_m2_s3
    covariance = np.zeros((len(theta),) * 2)
    if entry.covariance:
        covariance = np.array([[_number(one) for one in row] for row in entry.covariance])
    return Fit(
        hypothesis,
        theta,
        at,
        process_noise,
        deviance(problem, at, process_noise),
        covariance,
        problem.readings,
        entry.abandoned,
        Estimator(entry.estimator),
        tuple(map(_number, entry.held_out_m)),
        Band(entry.band, entry.band_growth_m2_s),
        Travel.of(entry.travel_m),
        tuple(map(_number, entry.forecast_errors_m)),
        quiet_deviance(problem, at),
    )


def _refitted(recorded: Fit, problem: Problem) -> Fit:
    """The fit re-optimised from its recorded parameters, or the same fit if its deviance does not decrease.

    A fit to free runs is cross-validated anew; no decision depends on its band.
    """
    if recorded.estimator is Estimator.FREE_RUNS:
        return cross_validated(problem, recorded)
    again = fit(problem, recorded.hypothesis, process_noise=recorded.process_noise, starts=[recorded.theta])
    return again if again.deviance < recorded.deviance else replace(recorded)


def _decisions(
    lines: Sequence[LedgerLine], fits: Mapping[str, Fit], problem: Problem, refit: Progress | None
) -> list[Decision]:
    """Every decision by the rules of the search, from the fits and the held-out results."""
    criterion = Criterion(problem.settings)
    decisions: list[Decision] = []
    rounds = groupby(lines, key=lambda line: (line.rule, line.against, line.evidence.winner))
    for (rule, against, _), group in rounds:
        tried = [(fits[line.fit], _evidence(line, fits, problem, refit)) for line in group]
        winner = _winner(Rule(rule), tried, criterion)
        for candidate, evidence in tried:
            among = any(evidence.winner is one for one, _ in tried)
            full = replace(evidence, winner=winner) if among else evidence
            if refit is not None and Rule(rule) is Rule.EXCHANGE:
                full = _with_losses(full, problem, candidate, fits[against], criterion)
            decisions.append(criterion.decide(Rule(rule), candidate, fits[against], full))
    return decisions


def _with_losses(evidence: Evidence, problem: Problem, tried: Fit, against: Fit, criterion: Criterion) -> Evidence:
    """The evidence of an exchange with the in-sample losses computed anew, which the winner of a round needs."""
    if evidence.winner is not tried or not criterion.needs_evidence(Rule.EXCHANGE, tried, against, evidence.tests):
        return replace(evidence, before=(), after=())
    before, after = in_sample_losses(problem, fitted_windows(problem.recordings), (against, tried))
    return replace(evidence, before=(before,), after=(after,))


def _winner(rule: Rule, tried: Sequence[tuple[Fit, Evidence]], criterion: Criterion) -> Fit | None:
    """The best fit of a round."""
    fits = [candidate for candidate, _ in tried]
    return criterion.ranked(fits)[0] if rule in (Rule.ADD, Rule.SWAP) else min(fits, key=criterion.value)


def _evidence(
    line: LedgerLine,
    fits: Mapping[str, Fit],
    problem: Problem,
    refit: Progress | None,
) -> Evidence:
    """Evidence of a line, with held-out results as recorded or, to `refit`, recomputed."""
    recorded = line.evidence
    before, after = tuple(map(_number, recorded.before)), tuple(map(_number, recorded.after))
    tried, against = fits[line.fit], fits[line.against]
    if refit is not None and Rule(line.rule) is Rule.RESTORE:
        before, after = against.held_out, tuple(block_errors(problem, tried).tolist())
    elif refit is not None and before and Rule(line.rule) is not Rule.EXCHANGE:
        before, after = held_out_deviances(problem, against, tried, refit)
    return Evidence(
        winner=None if recorded.winner is None else fits[recorded.winner],
        holder=None if recorded.holder is None else fits[recorded.holder],
        without=tuple(fits[name] for name in recorded.without),
        before=before,
        after=after,
        tests=recorded.tests,
        nested=recorded.nested,
        weight=_number(recorded.weight),
    )


def _decision_differences(
    lines: Sequence[LedgerLine], decisions: Sequence[Decision], *, exact: bool
) -> Iterator[Mismatch]:
    """Differences of hashes, decisions and, if `exact`, gains and reasons."""
    for n, (line, now) in enumerate(zip(lines, decisions, strict=True)):
        where = f"attempt {n + 1}, {line.effect}"
        if hashed(line) != line.hash:
            yield Mismatch(where, _WRONG_HASH)
        if now.kept != line.kept:
            kept, recorded = ("kept" if one else "not kept" for one in (now.kept, line.kept))
            yield Mismatch(where, f"is {kept}, recorded as {recorded}")
        if exact and not abs(now.gain - _number(line.gain)) <= _TOLERANCE:
            yield Mismatch(where, f"gain {now.gain:.4f}, recorded {_number(line.gain):.4f}")
        elif exact and now.because != line.because:
            yield Mismatch(where, f'the reason is "{now.because}", recorded "{line.because}"')


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
