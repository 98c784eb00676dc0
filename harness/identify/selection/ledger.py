"""The ledger as a record: every attempt with what determines it, what came out, and a hash of both.

An attempt is held against another fit, the one without what is tried. Both stand among the record's `fits` under
hashes of their content, and the hash of the problem (recordings, rig, declared effects, noise, baseline, versions) is
part of each: whoever changes a number, an input or a decision changes a hash.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Any

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.record import (
    ActingRecord,
    FitRecord,
    FittedEffect,
    LedgerLine,
    LedgerRecord,
    ProblemRecord,
    RigRecord,
    SourcesRecord,
)
from harness.identify.selection.candidates import Entry

_DIGITS = 16  # of a hash: 64 bits tell some thousand attempts apart


def digest(value: Any) -> str:
    """A short SHA-256 of JSON content; numbers count with all their digits."""
    text = json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def hashed(part: ProblemRecord | LedgerLine) -> str:
    """The hash of a part of the record, over all of it but the hash itself."""
    return digest(part.model_dump(mode="json", exclude={"hash"}))


def declared_record(problem: Problem) -> tuple[ActingRecord, ...]:
    """The declared effects."""
    return tuple(ActingRecord(name=one.effect.name, values=dict(one.values)) for one in problem.declared)


def problem_record(problem: Problem, inputs: SourcesRecord) -> ProblemRecord:
    """What determines every fit; `inputs` are hashes of files and versions of software."""
    record = ProblemRecord(
        inputs=inputs,
        recordings=tuple(one.name for one in problem.records),
        readings=problem.readings,
        reading_variance_m2=problem.noise,
        baseline=problem.model.name,
        rig=RigRecord.model_validate(problem.rig),
        declared=declared_record(problem),
    )
    return record.model_copy(update={"hash": hashed(record)})


def fit_record(one: Fit) -> FitRecord:
    """A fit: its hypothesis with the law of each effect, its numbers, and how well it predicts."""
    shape = one.hypothesis.shape
    return FitRecord(
        effects=tuple(FittedEffect.model_validate(effect) for effect in one.hypothesis.effects),
        curve=None if shape is None else shape.record(),
        numbers=tuple(one.numbers.tolist()),
        process_noise_m2_s3=one.density,
        deviance=one.deviance,
        score=one.score,
        bic=one.bic,
    )


def ledger_record(problem: Problem, base: Fit, ledger: Sequence[Entry], inputs: SourcesRecord) -> LedgerRecord:
    """`ledger`, `fits` and `problem` of diagnosis.json; the first of the fits is the one without any effect."""
    posed = problem_record(problem, inputs)
    fits: dict[str, FitRecord] = {}

    def kept(one: Fit) -> str:
        record = fit_record(one)
        name = fit_hash(posed, record)
        fits[name] = record
        return name

    kept(base)
    lines = []
    for entry in ledger:
        line = LedgerLine(
            effect=entry.effect,
            beside=entry.beside,
            gain=entry.gain,
            kept=entry.kept,
            because=entry.because,
            rule=entry.rule,
            fit=kept(entry.fit),
            against=kept(entry.against),
        )
        lines.append(line.model_copy(update={"hash": hashed(line)}))
    return LedgerRecord(ledger=tuple(lines), fits=fits, problem=posed)


def fit_hash(posed: ProblemRecord, record: FitRecord) -> str:
    """Name of a fit among the `fits`."""
    return digest([posed.hash, record.model_dump(mode="json")])
