"""What an effect changes in the innovations of the filter, over its size, beside the declared model.

It is what the effect changes in the prediction, with gains of the filter as they are without it. An effect between the
measured angle and the beam also changes how the angle's error reaches the ball, and with it the gains. Where the
declared model leaves much unexplained, gains that differ a little change large innovations by more than the effect
does, which is no sign of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Parameter
from analytic.motion import FloatArray
from harness.identify.design.discrimination import SteadyFilters
from harness.identify.estimate.fit import Fit
from harness.identify.filter.residuals import Residuals
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import PHASE, Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.threads import in_threads

_RATIO, _ABOVE = 5.0, 5  # of neighbouring process noises; number of these above the fitted one
_ROUNDS, _EXACT = 8, 0.03  # secant steps for the size, and the relative error of the gain at which they end
_FARTHEST = 1e3  # largest size tried, over the typical one
_MOST_FACTOR = 30.0  # by which one secant step changes the size
_STEP = 1e-3  # of the Jacobian of unknown rig quantities, in scaled parameters


class Reference:
    """The declared model on the recordings: its residuals over the process noise, and what process noise costs."""

    def __init__(self, problem: Problem, base: Fit, scale: float) -> None:
        self.problem, self.base, self.scale = problem, base, scale
        through = (*problem.declared, *base.terms.effects)
        self._same_gains = replace(
            problem, recordings=tuple(replace(one, error_of=through) for one in problem.recordings)
        )
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
        """Residuals of a hypothesis at a process noise [m²/s³]."""
        return Residuals(self._same_gains, hypothesis, process_noise)


class Signature:
    """What an effect changes in the residuals, over its size, 1 at the typical one."""

    def __init__(self, reference: Reference, name: str, recordings: int) -> None:
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
        problem = self.reference.problem
        return parameter.direction_on(problem.visited, problem.rig)

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
        change = self._residuals(at, size, phase) - self._without[at]
        basis = reference.nuisance[at]
        made: FloatArray = change - basis @ (basis.T @ change)
        return made

    def _residuals(self, at: int, size: float, phase: float = 0.0) -> FloatArray:
        return self.reference.of(self.hypothesis, float(self.reference.process_noises[at])).at(self._theta(size, phase))

    @cached_property
    def _without(self) -> list[FloatArray]:
        """Residuals without the effect, at each process noise, shape (readings,) each.

        A law that acts less the larger its parameter changes how the filter takes its steps however little it acts: it
        is held against itself at the upper bound.
        """
        if not self.inverse:
            return self.reference.residuals
        least = self.main.typical / self.main.high
        return [self._residuals(at, least) for at in range(len(self.reference.process_noises))]

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
