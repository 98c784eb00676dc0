"""The ledger as JSON: every decision with what determines it, what came out, and a hash of both.

Fits stand in a table of their own under hashes of their content, and the hash of the problem (recordings, rig, known
effects, noise, baseline, settings, versions) is part of each: whoever changes a number, an input or a decision changes
a hash.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.record import (
    ActingRecord,
    EvidenceRecord,
    FitRecord,
    FittedEffect,
    LedgerLine,
    LedgerRecord,
    ProblemRecord,
    RigRecord,
    SourcesRecord,
)
from harness.identify.selection.criterion import Criterion, Evidence
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection

_DIGITS = 16  # of a hash: 64 bits tell some thousand decisions apart


def digest(value: Any) -> str:
    """A short SHA-256 of JSON content; numbers count with all their digits."""
    text = json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def hashed(part: ProblemRecord | LedgerLine) -> str:
    """The hash of a part of the record, over all of it but the hash itself."""
    return digest(part.model_dump(mode="json", exclude={"hash"}))


def declared_record(problem: Problem) -> tuple[ActingRecord, ...]:
    """The known effects."""
    return tuple(ActingRecord(name=one.effect.name, values=dict(one.values)) for one in problem.declared)


def problem_record(problem: Problem, inputs: SourcesRecord) -> ProblemRecord:
    """What determines every fit and decision; `inputs` are hashes of files and versions of software."""
    record = ProblemRecord(
        inputs=inputs,
        recordings=tuple(one.name for one in problem.recordings),
        readings=problem.readings,
        reading_variance_m2=problem.reading_variance,
        baseline=problem.model.name,
        rig=RigRecord.model_validate(problem.rig),
        declared=declared_record(problem),
        settings=asdict(problem.settings),
    )
    return record.model_copy(update={"hash": hashed(record)})


def fit_record(one: Fit, criterion: Criterion) -> FitRecord:
    """A fit: its hypothesis with the law of each effect, its parameters, and how well it predicts."""
    spline = one.hypothesis.spline
    return FitRecord(
        effects=tuple(FittedEffect.model_validate(effect) for effect in one.hypothesis.effects),
        spline_term=None if spline is None else spline.record(),
        parameters=tuple(one.theta.tolist()),
        process_noise_m2_s3=one.process_noise,
        deviance=one.deviance,
        criterion=criterion.value(one),
    )


def ledger_record(problem: Problem, selection: Selection, inputs: SourcesRecord) -> LedgerRecord:
    """`ledger`, `fits` and `problem` of diagnosis.json; the first of the fits is the one without any effect."""
    posed = problem_record(problem, inputs)
    criterion = Criterion(problem.settings)
    fits: dict[str, FitRecord] = {}

    def name_of(one: Fit) -> str:
        record = fit_record(one, criterion)
        name = fit_hash(posed, record)
        fits[name] = record
        return name

    name_of(selection.base)
    lines = tuple(_line(each, name_of) for each in selection.ledger)
    return LedgerRecord(ledger=lines, fits=fits, problem=posed)


def fit_hash(posed: ProblemRecord, record: FitRecord) -> str:
    """Name of a fit among the `fits`."""
    return digest([posed.hash, record.model_dump(mode="json")])


def _line(one: Line, name_of: Callable[[Fit], str]) -> LedgerLine:
    line = LedgerLine(
        effect=one.title,
        tried=one.effects,
        beside=one.beside,
        gain=one.gain,
        kept=one.kept,
        because=one.because,
        rule=one.rule.value,
        fit=name_of(one.fit),
        against=name_of(one.against),
        evidence=_evidence(one.evidence, name_of),
    )
    return line.model_copy(update={"hash": hashed(line)})


def _evidence(one: Evidence, name_of: Callable[[Fit], str]) -> EvidenceRecord:
    return EvidenceRecord(
        winner=one.winner and name_of(one.winner),
        holder=one.holder and name_of(one.holder),
        without=tuple(name_of(each) for each in one.without),
        before=one.before,
        after=one.after,
        tests=one.tests,
        nested=one.nested,
    )
