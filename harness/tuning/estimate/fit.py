"""Fit of an engine's free runs to windows: robust generalised least squares, starts of the windows eliminated.

Each window's start (s, ṡ) is fitted along. Covariances are those of the parameters alone, after the starts' columns
have been projected out (variable projection, Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

from analytic.motion import FloatArray
from harness.errors import EngineFailure
from harness.tuning.estimate.free import Free
from harness.tuning.estimate.runs import Model, Values
from harness.tuning.estimate.windows import Stretch

ROBUST = 3.0
"""Whitened residual from which the soft L1 loss weighs less: hardly any normal one reaches it."""
_CLIPPED = 0.9950  # mean of min(z², 9) of a standard normal z
_MEDIAN = 0.6745  # median absolute value of a standard normal variable
_WRONG = 2.0  # excess from which a model is clearly incomplete
_STEPS = (1e-3, 2e-3)  # of difference quotients by a start [m], [m/s]
_SETTLING = 2  # steps of least squares for starts that are not known yet
_ITERATIONS = 20
_TOLERANCE = 1e-4  # relative decrease of the loss at which a fit ends
_CLUSTERS = 6  # windows from which they tell a covariance of their own
_AT_BOUND = 1e-3  # of the range
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Fitted:
    """A fit.

    Attributes:
        names: of the k tuned parameters.
        free: what they are.
        values: of them, and of those that were given and not fitted, by name.
        starts: s [m] and ṡ [m/s] of each window, shape (windows, 2).
        residual: whitened, shape (readings,).
        deviance: twice the robust loss; for a complete model a sum of squares of standard normal variables.
        jacobian: of the runs by the scaled parameters, whitened, starts projected out, shape (readings, k).
        window: number of each reading's window, shape (readings,).
        converged: whether it ended by its tolerance.
    """

    names: tuple[str, ...]
    free: tuple[Free, ...]
    values: dict[str, float]
    starts: FloatArray
    residual: FloatArray
    deviance: float
    jacobian: FloatArray
    window: NDArray[np.int64]
    converged: bool = True

    @property
    def unknowns(self) -> int:
        """Number of fitted numbers, starts included."""
        return len(self.names) + self.starts.size

    @property
    def excess(self) -> float:
        """Mean squared residual over what noise and angle error explain, 1 for a complete model; outliers clipped."""
        count = len(self.residual)
        mean = float(np.mean(np.minimum(self.residual**2, ROBUST**2))) / _CLIPPED
        return mean * count / max(count - self.unknowns, 1)

    @property
    def inflation(self) -> float:
        """Factor of the covariance: the excess; where it is large, by the median, which clipping does not bound."""
        median = (float(np.median(np.abs(self.residual))) / _MEDIAN) ** 2
        return max(1.0, self.excess, median if self.excess > _WRONG else 1.0)

    @property
    def misfit(self) -> float:
        """Mean squared residual over what noise and angle error explain, outliers and all."""
        return float(np.sum(self.residual**2)) / max(len(self.residual) - self.unknowns, 1)

    @property
    def complete(self) -> bool:
        """Whether noise and angle error explain the residuals: their mean square is within five standard deviations."""
        return self.excess < 1.0 + 5.0 * float(np.sqrt(2.0 / max(len(self.residual) - self.unknowns, 1)))

    @cached_property
    def covariance(self) -> FloatArray:
        """Of the scaled parameters, shape (k, k).

        That of generalised least squares, inflated where residuals exceed what they should be; and where the sums over
        windows scatter more than that (Liang and Zeger, Biometrika 73, 1986), widened to their scatter.
        """
        if not self.names:
            return np.zeros((0, 0))
        bread = np.linalg.pinv(self.jacobian.T @ self.jacobian, hermitian=True)
        plain = bread * self.inflation
        count = int(self.window[-1]) + 1
        if count < max(_CLUSTERS, 2 * len(self.names)):
            return np.asarray(plain, np.float64)
        weight = 1.0 / np.sqrt(1.0 + (self.residual / ROBUST) ** 2)
        scores = np.zeros((count, len(self.names)))
        np.add.at(scores, self.window, self.jacobian * (weight * self.residual)[:, None])
        sandwich = bread @ (scores.T @ scores) @ bread * count / (count - len(self.names))
        wider = np.sqrt(np.maximum(np.diag(sandwich) / np.diag(plain), 1.0))
        return np.asarray(plain * np.outer(wider, wider), np.float64)

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations of the scaled parameters, shape (k,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), np.float64)

    @property
    def correlation(self) -> FloatArray:
        """Of the parameters, shape (k, k)."""
        size = np.where(self.deviations > 0.0, self.deviations, 1.0)
        return np.asarray(self.covariance / np.outer(size, size))

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a parameter in its unit, on its scale symmetric, within its bounds."""
        at = self.names.index(name)
        one, here = self.free[at], self.free[at].scaled(self.values[name])
        reach = float(student.ppf(0.5 + CONFIDENCE / 2.0, max(len(self.residual) - self.unknowns, 1)))
        half = reach * float(self.deviations[at])
        return one.value(here - half), one.value(here + half)

    def at_bound(self, name: str) -> bool:
        """Whether a parameter ended at a bound, where its interval says little."""
        one = self.free[self.names.index(name)]
        low, high = one.scaled(one.low), one.scaled(one.high)
        here = (one.scaled(self.values[name]) - low) / (high - low)
        return not _AT_BOUND < here < 1.0 - _AT_BOUND


class Objective:
    """Whitened residuals of a model over windows, and their derivatives."""

    def __init__(self, model: Model, windows: Sequence[Stretch], free: Sequence[Free], fixed: Values) -> None:
        self.model, self.windows, self.free, self.fixed = model, tuple(windows), tuple(free), dict(fixed)
        self.window = np.repeat(np.arange(len(windows), dtype=np.int64), [len(one.time) for one in windows])
        self._kept: tuple[bytes, list[FloatArray]] | None = None

    def values(self, x: FloatArray) -> dict[str, float]:
        """All values that are not defaults, in their units.

        Args:
            x: vector of the fit: k scaled parameters, then starts.
        """
        fitted = {one.name: one.value(float(scaled)) for one, scaled in zip(self.free, x, strict=False)}
        return {**self.fixed, **fitted}

    def starts(self, x: FloatArray) -> FloatArray:
        """Starts of the windows, shape (windows, 2)."""
        return x[len(self.free) :].reshape(-1, 2)

    def residual(self, x: FloatArray) -> FloatArray:
        """Whitened readings minus runs, shape (readings,)."""
        if self._kept is None or self._kept[0] != x.tobytes():
            self._kept = x.tobytes(), self.model.runs(self.windows, [(self.values(x), self.starts(x))])[0]
        return self._whitened([one.reading - run for one, run in zip(self.windows, self._kept[1], strict=True)])

    def jacobian(self, x: FloatArray) -> FloatArray:
        """Derivatives of `residual`, shape (readings, k + 2 windows)."""
        self.residual(x)
        assert self._kept is not None
        here, k = self._kept[1], len(self.free)
        steps = [-one.step if x[i] + one.step > one.scaled(one.high) else one.step for i, one in enumerate(self.free)]
        moved = []
        for i, step in enumerate(steps):
            changed = x.copy()
            changed[i] += step
            moved.append((self.values(changed), self.starts(x)))
        for which, by in enumerate(_STEPS):  # windows do not share starts: all of them are moved at once
            starts = self.starts(x).copy()
            starts[:, which] += by
            moved.append((self.values(x), starts))
        runs = self.model.runs(self.windows, moved)
        made = np.zeros((len(self.window), len(x)))
        for i, (run, step) in enumerate(zip(runs, [*steps, *_STEPS], strict=True)):
            column = self._whitened([(a - b) / step for a, b in zip(here, run, strict=True)])
            if i < k:
                made[:, i] = column
            else:
                made[np.arange(len(column)), k + 2 * self.window + (i - k)] = column
        return made

    def settled(self, x: FloatArray) -> FloatArray:
        """x with starts of least squares, shape (k + 2 windows,): runs are nearly linear in them.

        From a first guess that is hundreds of standard deviations off, the robust loss would take dozens of steps.
        """
        made, k = x.copy(), len(self.free)
        for _ in range(_SETTLING):
            move = np.linalg.lstsq(self.jacobian(made)[:, k:], self.residual(made), rcond=None)[0]
            made[k:] -= move
        return made

    def _whitened(self, parts: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([one.whitened(part) for one, part in zip(self.windows, parts, strict=True)])

    def projected(self, columns: FloatArray, slopes: FloatArray) -> FloatArray:
        """`columns`, shape (readings, c), without what the starts with these slopes, (readings, 2 windows), explain."""
        rest = np.array(columns, dtype=float)
        for number in range(len(self.windows)):
            rows = self.window == number
            basis, _ = np.linalg.qr(slopes[rows][:, 2 * number : 2 * number + 2])
            rest[rows] -= basis @ (basis.T @ rest[rows])
        return rest


def best_begin(
    model: Model, windows: Sequence[Stretch], free: Sequence[Free], begins: Sequence[Values]
) -> tuple[Values, FloatArray]:
    """Of these first values the ones with the least deviance, and their starts of least squares, shape (windows, 2).

    Args:
        begins: values of the free parameters, at least one set.
    """
    objective = Objective(model, windows, free, {})
    first = np.array([one.first_start() for one in windows]).ravel()
    settled = [
        objective.settled(np.concatenate(([one.scaled(values[one.name]) for one in free], first))) for values in begins
    ]
    best = min(range(len(begins)), key=lambda at: deviance_of(objective.residual(settled[at])))
    return begins[best], objective.starts(settled[best])


def deviance_of(residual: FloatArray) -> float:
    """Twice the robust loss of whitened residuals, any shape."""
    return float(np.sum(2.0 * ROBUST**2 * (np.sqrt(1.0 + (residual / ROBUST) ** 2) - 1.0)))


def run_through(
    model: Model, windows: Sequence[Stretch], values: Values
) -> tuple[tuple[Stretch, ...], tuple[EngineFailure, ...]]:
    """The windows that the engine runs through with these values from a start fitted to each, and its failures.

    Raises:
        EngineFailure: it runs through none.
    """
    kept, failures = [], []
    for one in windows:
        try:
            fit(model, [one], [], {}, fixed=values)
            kept.append(one)
        except EngineFailure as failure:
            failures.append(failure)
    if failures and not kept:
        first = failures[0]
        names = ", ".join(dict.fromkeys(one.recording.name for one in windows))
        advice = (
            f"It fails in every window of {names}, so that nothing can be tuned to them; `harness diagnose` finds what "
            "acts without an engine"
        )
        raise EngineFailure(first.engine, first.failure, first.time, f"{first.reason}. {advice}")
    return tuple(kept), tuple(failures)


def fit(
    model: Model,
    windows: Sequence[Stretch],
    free: Sequence[Free],
    initial: Values,
    starts: FloatArray | None = None,
    *,
    fixed: Values = MappingProxyType({}),
    iterations: int = _ITERATIONS,
) -> Fitted:
    """Fit parameters and starts from one starting point.

    Args:
        model: the engine; what is not in `free` is as its settings and rig say.
        windows: to fit to.
        free: the parameters to fit.
        initial: their first values, by name.
        starts: first guess, shape (windows, 2); if none is given, by the first readings and then by least squares.
        fixed: values of parameters that are not fitted and not at their defaults.
        iterations: most evaluations of the residuals.

    Raises:
        EngineFailure: the engine fails with the values that came out.
    """
    objective, k = Objective(model, windows, free, fixed), len(free)
    first = np.array([one.first_start() for one in windows]) if starts is None else starts
    low = np.array([one.scaled(one.low) for one in free] + [-np.inf] * first.size)
    high = np.array([one.scaled(one.high) for one in free] + [np.inf] * first.size)
    x = np.concatenate(([one.scaled(initial[one.name]) for one in free], first.ravel()))
    margin = 1e-9 * np.where(np.isfinite(high - low), high - low, 0.0)
    x = np.clip(x, low + margin, high - margin)
    if starts is None:
        x = objective.settled(x)
    done = least_squares(
        objective.residual,
        x,
        jac=objective.jacobian,
        bounds=(low, high),
        loss="soft_l1",
        f_scale=ROBUST,
        x_scale="jac",
        max_nfev=iterations,
        ftol=_TOLERANCE,
        xtol=1e-9,
        gtol=1e-9,
    )
    residual, jacobian = objective.residual(done.x), objective.jacobian(done.x)
    failure = model.failed(windows, objective.values(done.x), objective.starts(done.x))
    if failure is not None:
        raise failure
    weight = (1.0 + (residual / ROBUST) ** 2) ** -0.25  # of rows, as in the fit
    weighted = jacobian * weight[:, None]
    projected = objective.projected(-weighted[:, :k], weighted[:, k:])
    names = tuple(one.name for one in free)
    return Fitted(
        names, tuple(free), objective.values(done.x), objective.starts(done.x), residual,
        deviance_of(residual), projected, objective.window, bool(done.status > 0),
    )  # fmt: skip
