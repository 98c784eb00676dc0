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
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from analytic.effects import CATALOGUE, Parameter
from analytic.motion import FloatArray
from harness.identify.design.discrimination import SteadyFilters
from harness.identify.estimate.fit import Fit, fit
from harness.identify.filter.residuals import Residuals
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import PHASE, Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates, hidden_by, in_threads
from harness.identify.selection.criterion import Criterion
from harness.numerics import evenly_chosen
from harness.progress import Progress, silent

ALIKE = 0.95
"""Correlation of the signatures of two effects from which they are told apart badly [1]."""
_MOST_STEPS = 20_000  # integration steps that are filtered: of longer cases some recordings stand for all
_RATIO, _ABOVE = 5.0, 5  # of neighbouring process noises; number of these above the fitted one
_ROUNDS, _EXACT = 8, 0.03  # secant steps for the size, and the relative error of the gain at which they end
_FARTHEST = 1e3  # largest size tried, over the typical one
_MOST_FACTOR = 30.0  # by which one secant step changes the size
_STEP = 1e-3  # of the Jacobian of unknown rig quantities, in scaled parameters


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
    reference = _Reference(part, base, problem.readings / part.readings)
    signatures = in_threads(lambda name: _Signature(reference, name, len(problem.recordings)), names)
    found = in_threads(_limit, signatures)
    progress("effects that look alike", share=0.8)
    return Detection(_with_alike(reference, signatures, found), base, len(chosen), hidden_by(problem.unknown))


class _Reference:
    """The declared model on the recordings: its residuals over the process noise, and what process noise costs."""

    def __init__(self, problem: Problem, base: Fit, scale: float) -> None:
        self.problem, self.base, self.scale = problem, base, scale
        self.criterion = Criterion(problem.settings)
        self.price = math.log(problem.readings * scale)
        floor, quiet = problem.angle_floor**2, problem.least_process_noise
        fitted = max(base.process_noise, quiet)
        below = floor * _RATIO ** np.arange(max(math.ceil(math.log(max(fitted / floor, 1.0), _RATIO)), 0))
        above = fitted * _RATIO ** np.arange(_ABOVE + 1.0)
        self.process_noises = np.array([quiet, *below[below > 1.01 * quiet], *above[above > 1.01 * quiet]])
        self.at_best = int(np.argmin(np.abs(np.log(self.process_noises / fitted))))
        needs_noise = self.price * (self.process_noises > quiet)  # process noise counts as a parameter
        self.cost = self._least_is_zero(scale * self._deviances() + needs_noise)
        self.cost_explained = self._least_is_zero(self._expected() + needs_noise)

    @staticmethod
    def _least_is_zero(costs: FloatArray) -> FloatArray:
        return costs - costs.min()

    def _deviances(self) -> FloatArray:
        terms = self.base.terms
        return np.array(in_threads(lambda q: deviance(self.problem, terms, q), self.process_noises))

    def _expected(self) -> FloatArray:
        """Expected excess deviance at each process noise if nothing but the angle's error disturbs the ball."""
        problem = self.problem
        interval = float(np.median(np.concatenate([np.diff(one.time) for one in problem.recordings])))
        steady = SteadyFilters.of(interval, problem.reading_variance, problem.with_angle(0.0))
        at = np.log(problem.angle_floor**2 + self.process_noises)
        return problem.readings * self.scale * np.interp(at, np.log(steady.process_noise), steady.cost)

    @cached_property
    def residuals(self) -> list[FloatArray]:
        """Residuals of the declared model at each process noise, shape (readings,) each."""
        return [self.of(self.base.hypothesis, q).at(self.base.theta) for q in self.process_noises]

    @cached_property
    def nuisance(self) -> list[FloatArray]:
        """Orthonormal basis of what unknown rig quantities imitate, at each process noise, shape (readings, k) each."""

        def basis(q: float) -> FloatArray:
            slopes = self.of(self.base.hypothesis, q).jacobian(self.base.theta, _STEP)
            made: FloatArray = np.linalg.qr(slopes)[0]
            return made

        if not len(self.base.theta):
            return [np.zeros((len(one), 0)) for one in self.residuals]
        return in_threads(basis, self.process_noises)

    def of(self, hypothesis: Hypothesis, process_noise: float) -> Residuals:
        return Residuals(self.problem, hypothesis, process_noise)


class _Signature:
    """What an effect changes in the residuals, over its size, 1 at the typical one."""

    def __init__(self, reference: _Reference, name: str, recordings: int) -> None:
        self.reference, self.name, self.effect = reference, name, CATALOGUE[name]
        base, problem = reference.base, reference.problem
        self.hypothesis = Hypothesis((*base.hypothesis.names, name))
        own = recordings * len(self.hypothesis.own)
        self.numbers = len(self.hypothesis.parameters) + own - len(base.hypothesis.parameters)
        self.needed = reference.criterion.settings.keep + reference.price * self.numbers
        self.main = self.effect.parameters[0]
        self.neutral = self.main.neutral_on(problem.rig)
        self.inverse = not self.effect.strengths and not callable(self.main.neutral) and self.neutral == 0.0
        self.most = self._most()

    def _growing(self, parameter: Parameter) -> bool:
        return parameter is self.main or parameter.name in self.effect.strengths

    def _sign(self, parameter: Parameter) -> float:
        neutral = parameter.neutral_on(self.reference.problem.rig)
        return math.copysign(1.0, parameter.typical - neutral)

    def _value(self, parameter: Parameter, size: float) -> float:
        """The parameter's value at a size."""
        problem = self.reference.problem
        if parameter.place:
            return float(np.median(problem.visited))
        if not self._growing(parameter):
            return parameter.typical
        if self.inverse:
            return parameter.typical / size
        neutral = parameter.neutral_on(problem.rig)
        return neutral + size * self._sign(parameter) * parameter.size(problem.rig)

    def _most(self) -> float:
        """The largest size within the bounds."""
        problem, most = self.reference.problem, _FARTHEST
        for one in filter(self._growing, self.effect.parameters):
            low, high = one.bounds_on(problem.visited, problem.rig)
            if self.inverse:
                most = min(most, one.typical / max(low, one.typical / _FARTHEST))
                continue
            room = (high - one.neutral_on(problem.rig)) if self._sign(one) > 0 else one.neutral_on(problem.rig) - low
            most = min(most, max(room, 0.0) / one.size(problem.rig))
        return most

    def _theta(self, size: float, phase: float) -> FloatArray:
        """Scaled parameters of the declared model with the effect at a size."""
        base, problem = self.reference.base, self.reference.problem
        values = base.values()
        new = {(self.name, one.name): self._value(one, size) for one in self.effect.parameters}
        shared = [(values | new)[key] for key in self.hypothesis.parameters]
        count = len(problem.recordings)
        alternating = np.resize([1.0, -1.0], count)
        spread = alternating / max(float(np.std(alternating)), 1e-12)
        own = [
            np.full(count, phase) if one == PHASE else self._value(self.main, size) * spread
            for one in self.hypothesis.own
        ]
        made: FloatArray = np.concatenate([shared, *own]) / self.hypothesis.scale(problem)
        return made

    def change(self, at: int, size: float, phase: float = 0.0) -> FloatArray:
        """Change of the residuals at a process noise of this number, shape (readings,)."""
        reference = self.reference
        residuals = reference.of(self.hypothesis, float(reference.process_noises[at]))
        change = residuals.at(self._theta(size, phase)) - reference.residuals[at]
        basis = reference.nuisance[at]
        made: FloatArray = change - basis @ (basis.T @ change)
        return made

    def squares(self, size: float) -> FloatArray:
        """Sum of squares of the change, at each process noise; where φ₀ matters its mean over two."""
        phases = (0.0, 0.5 * math.pi) if self.hypothesis.turning else (0.0,)
        sums = [
            [float(np.sum(self.change(at, size, phase) ** 2)) for phase in phases]
            for at in range(len(self.reference.process_noises))
        ]
        return self.reference.scale * np.mean(np.nan_to_num(np.array(sums), nan=0.0, posinf=0.0), axis=1)

    def size_of(self, gain: Callable[[FloatArray], float]) -> float:
        """The size at which a gain, a function of the squares, reaches what is needed; infinite if none does.

        By secants of its logarithm, as it grows with a power of the size that is between 1 and 2 for most laws, within
        the sizes known to be too small and large enough: a few laws act from a certain size on.
        """
        size, power, before = min(1.0, self.most), 2.0, None
        small, large = 0.0, math.inf
        for _ in range(_ROUNDS):
            here = gain(self.squares(size))
            ratio = max(here, 1e-6) / self.needed
            if abs(ratio - 1.0) < _EXACT:
                return size
            if ratio < 1.0:
                if size == self.most:
                    return math.inf
                small = size
            else:
                large = size
            if before is not None and size != before[0]:
                slope = math.log(ratio / before[1]) / math.log(size / before[0])
                power = min(max(slope, 0.5), 3.0)
            before = size, ratio
            factor = min(max(ratio ** (-1.0 / power), 1.0 / _MOST_FACTOR), _MOST_FACTOR)
            size = min(size * factor, self.most)
            if not small < size < large:
                size = math.sqrt(small * large)
        return large if math.isfinite(large) else size

    def distance(self, size: float) -> float:
        """Distance of the main parameter from where the effect does nothing, at a size; its value if inverse."""
        if math.isinf(size):
            return 0.0 if self.inverse else math.inf
        if self.inverse:
            return self._value(self.main, size)
        return size * self.main.size(self.reference.problem.rig)


def _limit(signature: _Signature) -> Limit:
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


def _with_alike(reference: _Reference, signatures: list[_Signature], limits: list[Limit]) -> tuple[Limit, ...]:
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


def _size_at(signature: _Signature, limit: Limit) -> float:
    """The size at the limit; the largest possible one without a limit."""
    if signature.inverse:
        return min(signature.main.typical / limit.limit, signature.most) if limit.limit > 0.0 else signature.most
    return min(limit.limit / signature.distance(1.0), signature.most)


def _possible(size: float, signature: _Signature) -> float:
    return size if size <= signature.most else math.inf


def _apart(reference: _Reference, found: _Signature, rival: _Signature, length: float, correlation: float) -> float:
    """Factor of the size from which the rival's best fit is behind by what distinguishes two fits."""
    price = reference.price * (rival.numbers - found.numbers)
    needed = max(reference.criterion.settings.rival - price, 0.0)
    rest = reference.scale * length**2 * (1.0 - min(correlation**2, 1.0))
    if needed == 0.0:
        return 1.0
    return math.sqrt(needed / rest) if rest > 1e-9 * needed else math.inf
