"""Detection limits: the size at which each effect of the catalogue would pass the criterion on these recordings.

An effect changes the normalised innovations of the filter. The sum of squares S of that change, at a process noise q
and without the part that unknown rig quantities imitate, is its noncentrality: for small sizes the size squared times
the Fisher information (Kay, Fundamentals of Statistical Signal Processing II, 1998, section 6.5). A model without the
effect may take up part of it as process noise. What it costs is therefore the least of c(q) + S(q) over q, where c(q)
is the deviance at q above that at the best q. The limit is the size at which this reaches the criterion's threshold.
The filter starts from the first reading with an unknown velocity, so that the start is accounted for, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from harness.identify.design.signature import Reference, Signature
from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates, hidden_by
from harness.numerics import evenly_chosen
from harness.progress import Progress, silent
from harness.threads import in_threads

ALIKE = 0.95
"""Correlation of the signatures of two effects from which they are told apart badly [1]."""
_MOST_STEPS = 20_000  # integration steps that are filtered: of longer cases some recordings stand for all


@dataclass(frozen=True)
class Limit:
    """Detection limit of an effect.

    Attributes:
        effect, parameter: names; the parameter is the effect's strength, the others are at their typical values.
        unit: of the parameter, SI.
        neutral: value of the parameter at which the effect does nothing; for an `inverse` effect there is none.
        inverse: whether it acts the more the smaller the parameter is; the limit is then the largest value that shows.
        limit: distance from `neutral` at which the expected gain reaches the threshold, with what the declared model
            leaves unexplained; infinite (0 for an inverse one) if no possible size is.
        explained: the same once all that else is missing has been explained.
        typical: distance from `neutral` at which the effect matters.
        alike: effects whose signature correlates by more than `ALIKE` with this one, with the correlation.
        apart: distance from `neutral` from which it is told from all of these; infinite if that cannot be done, NaN
            without any.
    """

    effect: str
    parameter: str
    unit: str
    neutral: float
    inverse: bool
    limit: float
    explained: float
    typical: float
    alike: tuple[tuple[str, float], ...] = ()
    apart: float = math.nan

    def shows(self, limit: float) -> bool:
        """Whether the effect shows at its typical size, given a limit."""
        return limit >= self.typical if self.inverse else limit <= self.typical

    @property
    def seen(self) -> bool:
        """Whether the effect shows at its typical size once all else is explained."""
        return self.shows(self.explained)


@dataclass(frozen=True)
class Detection:
    """Detection limits of all candidates.

    Attributes:
        limits: in the order of the catalogue.
        base: fit of the declared model.
        used: number of recordings that were filtered.
        hidden: effects that the estimates of unknown rig quantities take in, so that they cannot show.
    """

    limits: tuple[Limit, ...]
    base: Fit
    used: int
    hidden: tuple[str, ...] = ()


def detection_limits(problem: Problem, progress: Progress = silent) -> Detection:
    """Detection limits of all candidates on the recordings of a problem."""
    mean = problem.steps / len(problem.recordings)
    chosen = evenly_chosen(problem.recordings, max(int(_MOST_STEPS / mean), 2))
    part = replace(problem, recordings=chosen)
    progress("fit of the declared model", share=0.2)
    base = fit(part, Hypothesis(part.unknown))
    names = candidates(problem)
    progress(f"detection limits of {len(names)} effects", share=0.4)
    reference = Reference(part, base, problem.readings / part.readings)
    signatures = in_threads(lambda name: Signature(reference, name, len(problem.recordings)), names)
    found = in_threads(_limit, signatures)
    progress("effects that look alike", share=0.8)
    return Detection(_with_alike(reference, signatures, found), base, len(chosen), hidden_by(problem.unknown))


def _limit(signature: Signature) -> Limit:
    reference, main = signature.reference, signature.main
    as_recorded = signature.size_of(lambda squares: float(np.min(reference.cost + squares)))
    explained = signature.size_of(lambda squares: float(np.min(reference.cost_explained + squares)))
    return Limit(
        signature.name,
        main.name,
        main.unit,
        signature.neutral,
        signature.inverse,
        signature.distance(as_recorded),
        signature.distance(min(explained, as_recorded)),
        signature.distance(1.0),
    )


def _with_alike(reference: Reference, signatures: list[Signature], limits: list[Limit]) -> tuple[Limit, ...]:
    """The limits with the effects of nearly the same signature, at the fitted process noise and each at its limit."""
    at = reference.at_best
    sizes = [_size_at(signature, limit) for signature, limit in zip(signatures, limits, strict=True)]
    changes = in_threads(lambda pair: pair[0].change(at, pair[1]), list(zip(signatures, sizes, strict=True)))
    lengths = np.array([float(np.linalg.norm(one)) for one in changes])
    clean: NDArray[np.float64] = np.array(
        [one / norm if norm > 0.0 and math.isfinite(norm) else np.zeros_like(one)
         for one, norm in zip(changes, lengths, strict=True)]
    )  # fmt: skip
    correlation = clean @ clean.T
    pairs: dict[int, list[int]] = {}
    for one, other in combinations(range(len(limits)), 2):
        if abs(correlation[one, other]) > ALIKE:
            pairs.setdefault(one, []).append(other)
            pairs.setdefault(other, []).append(one)
    made = []
    for one, limit in enumerate(limits):
        others = sorted(pairs.get(one, ()), key=lambda other, one=one: -abs(correlation[one, other]))
        alike = tuple((limits[other].effect, float(correlation[one, other])) for other in others)
        apart = math.nan
        if others:
            factors = [
                _apart(reference, signatures[one], signatures[other], lengths[one], correlation[one, other])
                for other in others
            ]
            apart = signatures[one].distance(_possible(sizes[one] * max(factors), signatures[one]))
        made.append(replace(limit, alike=alike, apart=apart))
    return tuple(made)


def _size_at(signature: Signature, limit: Limit) -> float:
    """The size at the limit; the largest possible one without a limit."""
    if signature.inverse:
        return min(signature.main.typical / limit.limit, signature.most) if limit.limit > 0.0 else signature.most
    return min(limit.limit / signature.distance(1.0), signature.most)


def _possible(size: float, signature: Signature) -> float:
    return size if size <= signature.most else math.inf


def _apart(reference: Reference, found: Signature, rival: Signature, length: float, correlation: float) -> float:
    """Factor of the size from which the rival's best fit is behind by what distinguishes two fits."""
    price = reference.price * (rival.numbers - found.numbers)
    needed = max(reference.criterion.settings.rival - price, 0.0)
    rest = reference.scale * length**2 * (1.0 - min(correlation**2, 1.0))
    if needed == 0.0:
        return 1.0
    return math.sqrt(needed / rest) if rest > 1e-9 * needed else math.inf
