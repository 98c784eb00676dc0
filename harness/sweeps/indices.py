"""Sobol' indices: which share of an output's variance comes from which factor, with SALib.

Sources: Saltelli et al., "Variance based sensitivity analysis of model output", Comput. Phys. Commun. 181, 2010;
Herman and Usher, "SALib", J. Open Source Softw. 2(9), 2017.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from analytic.motion import FloatArray

MOST_DROPPED = 0.1
"""Share of base samples with a failed run beyond which what is left no longer stands for the ranges [1]."""
_RESAMPLES = 1000
_CONFIDENCE = 0.95


@dataclass(frozen=True)
class Index:
    """The indices of one factor, each with the half width of its 95 % interval (bootstrap).

    Attributes:
        factor: its name.
        first, first_half: share of the variance that it explains alone [1].
        total, total_half: share that it takes part in [1].
    """

    factor: str
    first: float
    first_half: float
    total: float
    total_half: float


@dataclass(frozen=True)
class Indices:
    """Sobol' indices of one output of one source.

    Attributes:
        source: model or engine.
        output: column of the results.
        listed: values of the factors that are crossed instead of sampled.
        factors: in the order of the spec; none if there is a reason.
        base_samples, dropped: how many there were, and how many were left out because of failed runs.
        reason: why there are no indices; empty if there are.
    """

    source: str
    output: str
    listed: dict[str, Any]
    factors: tuple[Index, ...] = field(default=())
    base_samples: int = 0
    dropped: int = 0
    reason: str = ""


def indices_of(
    source: str, output: str, listed: dict[str, Any], names: Sequence[str], values: FloatArray, *, seed: int
) -> Indices:
    """The indices of `values`, in the order of SALib's sample without second order.

    Args:
        source, output, listed: as of `Indices`.
        names: of the factors.
        values: shape (base samples · (len(names) + 2),), NaN where a run failed.
        seed: of the bootstrap.
    """
    from SALib.analyze import sobol

    groups = values.reshape(-1, len(names) + 2)
    whole = np.isfinite(groups).all(axis=1)
    dropped = int((~whole).sum())
    known = groups[whole].ravel()
    facts: dict[str, Any] = {"base_samples": len(groups), "dropped": dropped}
    if dropped > MOST_DROPPED * len(groups):
        reason = f"{dropped} of {len(groups)} base samples have a failed run; narrow the ranges to where runs succeed"
        return Indices(source, output, listed, reason=reason, **facts)
    if np.ptp(known) == 0.0:
        return Indices(source, output, listed, reason="it is the same in all runs", **facts)
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    found = sobol.analyze(
        problem, known, calc_second_order=False, num_resamples=_RESAMPLES, conf_level=_CONFIDENCE, seed=seed
    )
    columns = zip(names, found["S1"], found["S1_conf"], found["ST"], found["ST_conf"], strict=True)
    factors = tuple(Index(name, *map(float, numbers)) for name, *numbers in columns)
    return Indices(source, output, listed, factors, **facts)
