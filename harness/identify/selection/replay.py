"""Replay of a kept ledger: do its hashes, its deviances and its decisions come out again from the same inputs?"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Shape
from harness.identify.record import DiagnosisRecord, FitRecord, LedgerLine, LedgerRecord, ProblemRecord
from harness.identify.selection.candidates import THRESHOLD
from harness.identify.selection.ledger import fit_hash, hashed, problem_record
from harness.identify.selection.spline_terms import CURVE_THRESHOLD
from harness.identify.selection.swaps import RARER

# Of a deviance, evaluated at the same numbers: another processor may round some thousand terms differently, by 1e-9 at
# most; what decides is 6000 times as large.
_TOLERANCE = 1e-3
_RELATIVE = 1e-9  # of the problem's numbers, some of which are estimated

_RULES = ("score", "split", "again", "either")


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
        refit: fit every hypothesis on from its recorded numbers, and decide by what comes out, instead of evaluating
            them where they are.

    Raises:
        KeyError, ValueError: fits and attempts of the record do not belong together.
    """
    posed, kept, lines = record.problem, record.fits, record.ledger
    mismatches = [*_problem(posed, problem)]
    fits: dict[str, Fit] = {}
    largest = 0.0
    for name, one in kept.items():
        title = " + ".join([*(each.name for each in one.effects), *(["curve"] if one.curve else [])]) or "none"
        progress(f"{title} ({len(fits) + 1} of {len(kept)})")
        if fit_hash(posed, one) != name:
            mismatches.append(Mismatch(f"fit {name} ({title})", "its content does not give its hash"))
        found = _evaluated(one, problem)
        difference = abs(found.deviance - _number(one.deviance))
        largest = max(largest, difference)
        if difference > _TOLERANCE:
            text = f"deviance {found.deviance:.6f}, recorded {_number(one.deviance):.6f}"
            mismatches.append(Mismatch(f"fit {name} ({title})", text))
        fits[name] = _again(found, problem) if refit else found
    mismatches += _attempts(lines, fits, exact=not refit)
    return Replay(len(lines), len(kept), tuple(mismatches), largest)


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
    """A recorded fit, its deviance evaluated anew at its recorded numbers."""
    shape = None if one.curve is None else Shape.of(one.curve)
    hypothesis = Hypothesis(tuple(each.name for each in one.effects), shape)
    numbers = np.array(one.numbers, dtype=float)
    if len(numbers) != hypothesis.size(problem):
        raise ValueError(f"{len(numbers)} numbers for a hypothesis of {hypothesis.size(problem)}")
    at, density = hypothesis.read(numbers, problem), one.process_noise_m2_s3
    deviance = problem.deviance(at.effects, at.phases, density, at.shape)
    return Fit(hypothesis, numbers, at, density, deviance, np.zeros((len(numbers),) * 2), problem.readings)


def _again(found: Fit, problem: Problem) -> Fit:
    """Fitted on from where it is; where that leads nowhere better, as it is."""
    onward = fit(problem, found.hypothesis, density=found.density, starts=[found.numbers])
    return onward if onward.deviance < found.deviance else replace(found)


def _attempts(lines: Sequence[LedgerLine], fits: Mapping[str, Fit], *, exact: bool) -> Iterator[Mismatch]:
    """Hashes, gains and decisions, in the order in which they were made."""
    decided = dict(_decisions(lines, fits))
    for n, line in enumerate(lines):
        where = f"attempt {n + 1}, {line.effect}"
        if hashed(line) != line.hash:
            yield Mismatch(where, "its content does not give its hash")
        if exact:
            gain = _gain(line, fits)
            if not abs(gain - _number(line.gain)) <= _TOLERANCE:
                yield Mismatch(where, f"gain {gain:.4f}, recorded {_number(line.gain):.4f}")
        if n in decided and decided[n] != line.kept:
            yield Mismatch(where, f"is {_fate(decided[n])}, recorded as {_fate(line.kept)}")


def _decisions(lines: Sequence[LedgerLine], fits: Mapping[str, Fit]) -> Iterator[tuple[int, bool]]:
    """Which attempts are to be kept, by the rules of the search, from the fits alone.

    Curves dropped beside others and predictions come last, and need fits to fewer recordings.
    """
    lines = [line for line in lines if line.rule in _RULES]
    current = base = next(iter(fits))
    n = 0
    while n < len(lines):
        line, kept = lines[n], False
        if line.rule == "again":  # with a runner-up of the first round
            current, kept = base, _gain(line, fits) > THRESHOLD
        elif line.rule == "either":
            current, kept = line.against, _gain(line, fits) > THRESHOLD
        elif line.rule == "split":
            more = len(fits[line.fit].hypothesis.names) > len(fits[line.against].hypothesis.names)
            kept = _gain(line, fits) > (RARER if more else -RARER)
            kept = kept and (line.kept or not more)  # each of two must also pay, by fits that were not kept
        elif line.fit == current:  # tried without what had been kept
            dropped = _gain(line, fits) < THRESHOLD
            yield n, not dropped
            current = line.against if dropped else current
            n += 1
            continue
        else:
            round_ = _round(lines, n, current)
            best = min(round_, key=lambda i: _criterion(fits[lines[i].fit]))
            kept = _pays(lines[best], fits, current)
            if _has_curve(lines[best], fits):  # it must also recur, which is a matter of fits to fewer recordings
                kept = kept and lines[best].kept
            yield from ((i, kept and i == best) for i in round_)
            current = lines[best].fit if kept else current
            n += len(round_)
            continue
        yield n, kept
        current = line.fit if kept else current
        n += 1


def _round(lines: Sequence[LedgerLine], first: int, current: str) -> range:
    """All attempts from the `first` one on that were made on top of the same."""
    end = first
    while (
        end < len(lines)
        and lines[end].rule == "score"
        and lines[end].against == lines[first].against
        and lines[end].fit != current
    ):
        end += 1
    return range(first, end)


def _pays(line: LedgerLine, fits: Mapping[str, Fit], current: str) -> bool:
    """Whether the best attempt of a round replaces what is current."""
    tried, against = fits[line.fit], fits[line.against]
    if line.against != current:  # in place of one that had been kept
        return _criterion(tried) < _criterion(fits[current])
    curve = _has_curve(line, fits) and against.hypothesis.shape is None
    return _gain(line, fits) > (CURVE_THRESHOLD if curve else THRESHOLD)


def _has_curve(line: LedgerLine, fits: Mapping[str, Fit]) -> bool:
    return fits[line.fit].hypothesis.shape is not None


def _gain(line: LedgerLine, fits: Mapping[str, Fit]) -> float:
    tried, against = fits[line.fit], fits[line.against]
    return against.bic - tried.bic if _has_curve(line, fits) else against.score - tried.score


def _criterion(one: Fit) -> float:
    return one.score if one.hypothesis.shape is None else one.bic


def _fate(kept: bool) -> str:
    return "kept" if kept else "not kept"


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
