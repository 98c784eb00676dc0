"""The ledger as JSON: every decision with its inputs, its result and a hash of both.

Fits are in a table, named by a hash of their content and of the problem (recordings, rig, known effects, reading
variance, baseline, settings, versions), so that a change of any number, input or decision changes a hash.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.problem import Problem
from harness.identify.record import (
    ActingRecord,
    ColourRecord,
    EvidenceRecord,
    FitRecord,
    FittedEffect,
    LedgerLine,
    LedgerRecord,
    ProblemRecord,
    RigRecord,
    SourcesRecord,
)
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection
from harness.provenance import canonical

_LATER = ("band_growth_m2_s", "travel_m", "forecast_errors_m")  # keys of a fit that earlier files lack
_DIGITS = 16  # of a hash: with 64 bits a collision among some thousand decisions is excluded


def digest(value: Any) -> str:
    """A short SHA-256 of JSON content, with all digits of its numbers."""
    return hashlib.sha256(canonical(value).encode()).hexdigest()[:_DIGITS]


def hashed(part: ProblemRecord | LedgerLine) -> str:
    """Hash of a part of the record, without its field `hash`."""
    return digest(part.model_dump(mode="json", exclude={"hash"}))


def declared_record(problem: Problem) -> tuple[ActingRecord, ...]:
    """The known effects."""
    return tuple(ActingRecord(name=term.effect.name, values=dict(term.values)) for term in problem.declared)


def colour_record(problem: Problem) -> ColourRecord:
    """The colour of the reading noise."""
    return ColourRecord(share=problem.colour.share, time_s=problem.colour.time)


def problem_record(problem: Problem, inputs: SourcesRecord) -> ProblemRecord:
    """The inputs of every fit and decision; `inputs` are hashes of files and versions of the software."""
    record = ProblemRecord(
        inputs=inputs,
        recordings=tuple(recording.name for recording in problem.recordings),
        readings=problem.readings,
        reading_variance_m2=problem.reading_variance,
        colour=colour_record(problem),
        roughness=problem.roughness,
        noise_share=problem.noise_share,
        held_command=problem.held_command,
        baseline=problem.model.name,
        rig=RigRecord.model_validate(problem.rig),
        declared=declared_record(problem),
        settings=asdict(problem.settings),
    )
    return record.model_copy(update={"hash": hashed(record)})


def fit_record(fit: Fit, criterion: Criterion, *, covariance: bool = False) -> FitRecord:
    """A fit as JSON: hypothesis with the law of each effect, parameters, process noise, deviance and criterion.

    Args:
        covariance: whether with the covariance of its parameters.
    """
    spline = fit.hypothesis.spline
    return FitRecord(
        effects=tuple(FittedEffect.model_validate(effect) for effect in fit.hypothesis.effects),
        spline_term=None if spline is None else spline.record(),
        parameters=tuple(fit.theta.tolist()),
        process_noise_m2_s3=fit.process_noise,
        deviance=fit.deviance,
        criterion=criterion.value(fit),
        abandoned=fit.abandoned,
        estimator=fit.estimator.value,
        held_out_m=fit.held_out,
        band=fit.band.factor,
        band_growth_m2_s=fit.band.growth,
        travel_m=fit.travel.ends,
        forecast_errors_m=fit.forecast_errors,
        covariance=tuple(map(tuple, fit.covariance.tolist())) if covariance else (),
    )


def ledger_record(selection: Selection, inputs: SourcesRecord) -> LedgerRecord:
    """`ledger`, `fits` and `problem` of diagnosis.json; the first fit is the one without any effect."""
    posed = problem_record(selection.problem, inputs)
    criterion = Criterion(selection.problem.settings)
    fits: dict[str, FitRecord] = {}

    def name_of(fit: Fit) -> str:
        record = fit_record(fit, criterion, covariance=_keeps_covariance(fit, selection.found))
        name = fit_hash(posed, record)
        fits[name] = record
        return name

    name_of(selection.base)
    lines = tuple(_line(line, name_of) for line in selection.ledger)
    return LedgerRecord(ledger=lines, fits=fits, problem=posed, found=name_of(selection.found))


def _keeps_covariance(fit: Fit, found: Fit) -> bool:
    """Whether the covariance of a fit cannot be computed from the rest, and something depends on it.

    That of the result by likelihood can. Of fits with a spline term nothing depends on it.
    """
    if fit.estimator is Estimator.FREE_RUNS:
        return True
    same = fit.hypothesis.names == found.hypothesis.names and np.array_equal(fit.theta, found.theta)
    return fit.hypothesis.spline is None and not same


def fit_hash(posed: ProblemRecord, record: FitRecord) -> str:
    """Name of a fit in the table `fits`; a key that came later counts where it says something."""
    content = record.model_dump(mode="json")
    for key in _LATER:
        if not content[key]:
            del content[key]
    return digest([posed.hash, content])


def _line(line: Line, name_of: Callable[[Fit], str]) -> LedgerLine:
    record = LedgerLine(
        effect=line.title,
        tried=line.effects,
        beside=line.beside,
        gain=line.gain,
        kept=line.kept,
        because=line.because,
        rule=line.rule.value,
        fit=name_of(line.fit),
        against=name_of(line.against),
        evidence=_evidence(line.evidence, name_of),
    )
    return record.model_copy(update={"hash": hashed(record)})


def _evidence(evidence: Evidence, name_of: Callable[[Fit], str]) -> EvidenceRecord:
    return EvidenceRecord(
        winner=evidence.winner and name_of(evidence.winner),
        holder=evidence.holder and name_of(evidence.holder),
        without=tuple(map(name_of, evidence.without)),
        before=evidence.before,
        after=evidence.after,
        tests=evidence.tests,
        nested=evidence.nested,
        weight=evidence.weight,
    )
