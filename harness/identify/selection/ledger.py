"""The ledger as a record: every attempt with what determines it, what came out, and a hash of both.

An attempt is held against another fit, the one without what is tried. Both stand among the record's `fits` under
hashes of their content, and the hash of the problem (recordings, rig, declared effects, noise, baseline, versions) is
part of each: whoever changes a number, an input or a decision changes a hash.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import Entry

_DIGITS = 16  # of a hash: 64 bits tell some thousand attempts apart


def digest(value: Any) -> str:
    """A short SHA-256 of JSON content; numbers count with all their digits."""
    text = json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def problem_record(problem: Problem, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """What determines every fit; `inputs` are hashes of files and versions of software."""
    return {
        "inputs": dict(inputs),
        "recordings": [one.name for one in problem.records],
        "readings": problem.readings,
        "reading_variance_m2": problem.noise,
        "baseline": problem.model.name,
        "rig": asdict(problem.rig),
        "declared": [{"name": one.effect.name, "values": dict(one.values)} for one in problem.declared],
    }


def fit_record(one: Fit) -> dict[str, Any]:
    """A fit: its hypothesis with the law of each effect, its numbers, and how well it predicts."""
    shape = one.hypothesis.shape
    return {
        "effects": [{"name": effect.name, "law": effect.law} for effect in one.hypothesis.effects],
        "curve": None if shape is None else shape.record(),
        "numbers": one.numbers.tolist(),
        "process_noise_m2_s3": one.density,
        "deviance": _finite(one.deviance),
        "score": _finite(one.score),
        "bic": _finite(one.bic),
    }


def ledger_record(problem: Problem, base: Fit, ledger: Sequence[Entry], inputs: Mapping[str, Any]) -> dict[str, Any]:
    """`ledger`, `fits` and `problem` of diagnosis.json; the first of the fits is the one without any effect."""
    posed = problem_record(problem, inputs)
    posed["hash"] = digest(posed)
    fits: dict[str, Any] = {}

    def kept(one: Fit) -> str:
        record = fit_record(one)
        name = fit_hash(posed, record)
        fits[name] = record
        return name

    kept(base)
    lines = []
    for entry in ledger:
        line = {
            "effect": entry.effect,
            "beside": list(entry.beside),
            "gain": _finite(entry.gain),
            "kept": entry.kept,
            "because": entry.because,
            "rule": entry.rule,
            "fit": kept(entry.fit),
            "against": kept(entry.against),
        }
        lines.append({**line, "hash": digest(line)})
    return {"ledger": lines, "fits": fits, "problem": posed}


def fit_hash(posed: Mapping[str, Any], record: Mapping[str, Any]) -> str:
    """Name of a fit among the `fits`."""
    return digest([posed["hash"], dict(record)])


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
