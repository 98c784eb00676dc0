"""The ledger as JSON: every decision with what determines it, what came out, and a hash of both.

Fits stand in a table of their own under hashes of their content, and the hash of the problem (recordings, rig, known
effects, noise, baseline, settings, versions) is part of each: whoever changes a number, an input or a decision changes
a hash.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion, Evidence
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection

_DIGITS = 16  # of a hash: 64 bits tell some thousand decisions apart


def digest(value: Any) -> str:
    """A short SHA-256 of JSON content; numbers count with all their digits."""
    text = json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def problem_record(problem: Problem, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """What determines every fit and decision; `inputs` are hashes of files and versions of software."""
    return {
        "inputs": dict(inputs),
        "recordings": [one.name for one in problem.records],
        "readings": problem.readings,
        "reading_variance_m2": problem.noise,
        "baseline": problem.model.name,
        "rig": asdict(problem.rig),
        "declared": [{"name": one.effect.name, "values": dict(one.values)} for one in problem.declared],
        "settings": asdict(problem.settings),
    }


def fit_record(one: Fit, criterion: Criterion) -> dict[str, Any]:
    """A fit: its hypothesis with the law of each effect, its parameters, and how well it predicts."""
    shape = one.hypothesis.shape
    return {
        "effects": [{"name": effect.name, "law": effect.law} for effect in one.hypothesis.effects],
        "spline_term": None if shape is None else shape.record(),
        "parameters": one.numbers.tolist(),
        "process_noise_m2_s3": one.density,
        "deviance": finite(one.deviance),
        "criterion": finite(criterion.value(one)),
    }


def ledger_record(problem: Problem, selection: Selection, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """`ledger`, `fits` and `problem` of diagnosis.json; the first of the fits is the one without any effect."""
    posed = problem_record(problem, inputs)
    posed["hash"] = digest(posed)
    criterion = Criterion(problem.settings)
    fits: dict[str, Any] = {}

    def name_of(one: Fit) -> str:
        record = fit_record(one, criterion)
        name = fit_hash(posed, record)
        fits[name] = record
        return name

    name_of(selection.base)
    lines = [_line(each, name_of) for each in selection.ledger]
    return {"ledger": [{**line, "hash": digest(line)} for line in lines], "fits": fits, "problem": posed}


def fit_hash(posed: Mapping[str, Any], record: Mapping[str, Any]) -> str:
    """Name of a fit among the `fits`."""
    return digest([posed["hash"], dict(record)])


def _line(one: Line, name_of: Callable[[Fit], str]) -> dict[str, Any]:
    return {
        "effect": one.title,
        "tried": list(one.effects),
        "beside": list(one.beside),
        "gain": finite(one.gain),
        "kept": one.kept,
        "because": one.because,
        "rule": str(one.rule),
        "fit": name_of(one.fit),
        "against": name_of(one.against),
        "evidence": _evidence(one.evidence, name_of),
    }


def _evidence(one: Evidence, name_of: Callable[[Fit], str]) -> dict[str, Any]:
    """What there is of it, fits by name."""
    found = {
        "winner": one.winner and name_of(one.winner),
        "holder": one.holder and name_of(one.holder),
        "without": [name_of(each) for each in one.without],
        "before": list(one.before),
        "after": list(one.after),
        "tests": one.tests if one.tests > 1 else None,
        "nested": one.nested,
    }
    return {key: value for key, value in found.items() if value}


def finite(value: float) -> float | None:
    """A number as JSON has it: nothing where it is not finite."""
    return float(value) if math.isfinite(value) else None
