"""Output-error models s(t) = B(q)/F(q) α(t), fitted to free runs over windows.

They are black boxes of order two or three, with one coefficient more in B than in F (Ljung, System Identification, 2nd
ed., section 4.2); their constant input represents an angle offset.

Gains and initial states follow by linear least squares, and only the parameters of F are searched for (variable
projection, Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). Since F ŝ = B α, the derivative of a free run ŝ with
respect to a coefficient of F is −ŝ/F, delayed: the same filter, applied once more. Projected as the free runs are, it
is the Jacobian of Kaufman (BIT 15, 1975), which gives the exact gradient.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtbtrs
from scipy.optimize import least_squares

from analytic.motion import FloatArray
from harness.identify.problem.windows import Window

# Bounds of F, as λ² + f₁ λ + f₀ = 0 with λ = ln(z)/T: growth by at most e in a second, three times that of a ball on
# the softest beam measured, since a fit that grows by more predicts kilometres; decay within one or two readings;
# oscillation below half the sampling rate.
_SLOWEST, _FASTEST = -1.0, 4.0  # [1/s], [1 per step]
_STARTS = ((0.0, 0.0), (1.0, 1.0))  # f₁ [1/s] and f₀ [1/s²]: the double integrator, and a damped oscillator
_FURTHER_STARTS = (0.5, 10.0)  # decay of a third pole [1/s]: slower than the beam's motion, and faster
# Relative decrease of the sum of squares that ends a search: half as much of the RMS error. That of held-out blocks is
# then within 0.2 % of what 1e-9 gives on measured recordings; flat valleys of order three leave up to 1 %.
_CONVERGED = 1e-5
_COMPLEX_STEP = 1e-20  # its square is lost in rounding, so that derivatives are exact


@dataclass(frozen=True)
class OutputError:
    """B(q)/F(q) with poles exp(λ T).

    Of λ² + f₁ λ + f₀ = 0 and, for order three, λ = −f: `poles` are f₁ [1/s], f₀ [1/s²] and f [1/s].
    """

    poles: tuple[float, ...]

    @property
    def order(self) -> int:
        """Of F."""
        return len(self.poles)

    def denominator(self, step: float | FloatArray) -> FloatArray:
        """Coefficients of F(q) in q⁰, q⁻¹, …, shape (…, order + 1), for sampling intervals `step` [s]."""
        return _denominator(np.array(self.poles, dtype=np.complex128), np.asarray(step)).real

    def denominator_slopes(self, step: FloatArray) -> FloatArray:
        """Derivatives of F(q) with respect to `poles`, shape (…, order + 1, order)."""
        moved = np.array(self.poles) + 1j * _COMPLEX_STEP * np.eye(self.order)
        return np.stack([_denominator(poles, step).imag for poles in moved], axis=-1) / _COMPLEX_STEP

    def driven(self, window: Window) -> FloatArray:
        """α/F with delays of 0 to `order` steps, and 1/F of a step, shape (m, order + 2)."""
        stack = _Stack.of([window], [np.ones(len(window.time), dtype=np.bool_)])
        return stack.at_stamps(_Responses.of(self, stack).driven)[0]

    def free(self, window: Window) -> FloatArray:
        """1/F of an impulse at each of the first stamps, shape (m, order)."""
        stack = _Stack.of([window], [np.ones(len(window.time), dtype=np.bool_)])
        return stack.at_stamps(_Responses.of(self, stack).free)[0]


def _denominator(poles: NDArray[np.complex128], step: FloatArray) -> NDArray[np.complex128]:
    first, zeroth, *further = poles
    T = step[..., None]
    cosine = np.cos(T * np.sqrt(zeroth - 0.25 * first**2))  # of an angle that is imaginary for real poles
    F = np.concatenate((np.ones_like(T), -2.0 * np.exp(-0.5 * first * T) * cosine, np.exp(-first * T)), axis=-1)
    for rate in further:
        none = np.zeros_like(T)
        F = np.concatenate((F, none), axis=-1) - np.exp(-rate * T) * np.concatenate((none, F), axis=-1)
    return F


def fit_poles(windows: Sequence[Window], order: int, near: OutputError | None = None) -> tuple[OutputError, FloatArray]:
    """The model of order two or three of least squares over free runs of the windows, and its gains.

    Args:
        near: a fit to most of these windows, from whose poles the search starts.

    Returns:
        The model, and the coefficients of B and the response to a constant, shape (order + 2,).
    """
    stack = _Stack.of(windows, [np.isfinite(window.reading) for window in windows])
    fastest = _FASTEST / float(stack.steps.max())
    low, high = (_SLOWEST, -(_SLOWEST**2), _SLOWEST), (fastest, fastest**2, fastest)
    if near is not None:
        best = _best(stack, [near.poles], low[:order], high[:order])
    else:
        best = _best(stack, _STARTS, low[:2], high[:2])
        if order == 3:
            best = _best(stack, [(*best.law.poles, further) for further in _FURTHER_STARTS], low, high)
    return best.law, best.gains


def _best(stack: _Stack, starts: Sequence[tuple[float, ...]], low: Sequence[float], high: Sequence[float]) -> _FreeRuns:
    """The free runs of least squares, searched for from each of `starts`."""

    @lru_cache(maxsize=1)  # the search asks for slopes where it has just asked for residuals
    def runs(*poles: float) -> _FreeRuns:
        return _FreeRuns(OutputError(poles), stack)

    def residuals(poles: FloatArray) -> FloatArray:
        return runs(*poles.tolist()).residuals

    def slopes(poles: FloatArray) -> FloatArray:
        return runs(*poles.tolist()).slopes

    fits = [
        least_squares(residuals, np.clip(start, low, high), jac=slopes, bounds=(low, high), ftol=_CONVERGED)
        for start in starts
    ]
    return runs(*min(fits, key=lambda fit: float(fit.cost)).x.tolist())


@dataclass(frozen=True)
class _Stack:
    """w windows one after another, n samples on their grids in all, which are read off at up to m stamps each.

    Attributes:
        steps: sampling intervals that occur [s].
        step: which of these a sample has, shape (n,).
        window: number of the window that a sample is in, shape (n,).
        angle: α, shape (n,) [rad].
        before, after: samples in the same window before each sample and after it, shape (n,).
        cell: the sample before each stamp; n for none, where a window has fewer than m stamps, shape (w, m).
        share: of the way to the next sample at which the stamp lies, shape (w, m).
        reading: at the stamps, 0 for none, shape (w, m) [m].
    """

    steps: FloatArray
    step: NDArray[np.intp]
    window: NDArray[np.intp]
    angle: FloatArray
    before: NDArray[np.intp]
    after: NDArray[np.intp]
    cell: NDArray[np.intp]
    share: FloatArray
    reading: FloatArray

    @classmethod
    def of(cls, windows: Sequence[Window], use: Sequence[NDArray[np.bool_]]) -> _Stack:
        """The windows, read off at those of their stamps that are in `use`, shape (m,) each."""
        sizes = np.array([len(window.grid) for window in windows])
        steps, step = np.unique([window.step for window in windows], return_inverse=True)
        number = np.repeat(np.arange(len(windows)), sizes)
        first = np.cumsum(sizes) - sizes
        before = np.arange(sizes.sum()) - first[number]
        shape = len(windows), max(int(one.sum()) for one in use)
        cell, share, reading = np.full(shape, len(number)), np.zeros(shape), np.zeros(shape)
        for row, (window, one) in enumerate(zip(windows, use, strict=True)):
            stamps, count = window.stamps[one], int(one.sum())
            inside = np.minimum(np.searchsorted(window.grid, stamps, side="right") - 1, sizes[row] - 2)
            cell[row, :count] = first[row] + inside
            share[row, :count] = (stamps - window.grid[inside]) / window.step
            reading[row, :count] = window.reading[one]
        angle = np.concatenate([window.angle for window in windows])
        return cls(
            steps, step[number], number, angle, before, sizes[number] - 1 - before, cell, share, np.nan_to_num(reading)
        )

    def delayed(self, signal: FloatArray, lags: range) -> FloatArray:
        """A signal, shape (n,), later by each of `lags` samples within its window, shape (n, lags)."""
        return np.column_stack([np.where(self.before >= lag, np.roll(signal, lag), 0.0) for lag in lags])

    def filtered(self, F: FloatArray, signals: FloatArray) -> FloatArray:
        """1/F(q) of signals, shape (n, c), from rest at the begin of every window: nothing passes to the next one.

        As a triangular system with bands: F differs where sampling intervals do.

        Args:
            F: coefficients at every sample, shape (n, order + 1).
        """
        band = np.where(self.after >= np.arange(F.shape[1])[:, None], F.T, 0.0)
        solved: FloatArray = dtbtrs(band, signals, uplo="L", diag="U")[0]
        return solved

    def at_stamps(self, signals: FloatArray) -> FloatArray:
        """Signals on the grids, shape (n, c), interpolated at the stamps, shape (w, m, c); 0 where there is none."""
        padded = np.concatenate((signals, np.zeros((2, signals.shape[1]))))
        begin = padded.take(self.cell, axis=0)
        if not self._between:
            return begin
        return begin + self.share[..., None] * (padded.take(self.cell + 1, axis=0) - begin)

    @cached_property
    def _between(self) -> bool:
        """Whether any stamp lies between two samples."""
        return bool(self.share.any())


@dataclass(frozen=True)
class _Responses:
    """Responses of a model on the grids: `driven`, shape (n, order + 2), and `free`, shape (n, order); see there."""

    F: FloatArray
    driven: FloatArray
    free: FloatArray

    @classmethod
    def of(cls, law: OutputError, stack: _Stack) -> _Responses:
        F = law.denominator(stack.steps)[stack.step]
        inputs = np.column_stack((stack.angle, stack.before == 0, np.ones_like(stack.angle)))
        direct, pulse, constant = stack.filtered(F, inputs).T
        driven = np.column_stack((stack.delayed(direct, range(law.order + 1)), constant))
        return cls(F, driven, stack.delayed(pulse, range(law.order)))


class _FreeRuns:
    """The free runs of a model over stacked windows, with gains and initial states of least squares.

    Attributes:
        gains: shape (order + 2,).
        residuals: readings minus the free runs, 0 where there is none, shape (w m,) [m].
    """

    def __init__(self, law: OutputError, stack: _Stack) -> None:
        self.law, self._stack = law, stack
        self._responses = _Responses.of(law, stack)
        self._Q, self._R = np.linalg.qr(stack.at_stamps(self._responses.free))
        self._driven = stack.at_stamps(self._responses.driven)
        A, y = self._without_start(self._driven), self._without_start(stack.reading[..., None])[:, 0]
        self._basis, triangle = np.linalg.qr(A)
        self.gains: FloatArray = np.linalg.lstsq(triangle, self._basis.T @ y, rcond=None)[0]
        self.residuals: FloatArray = y - A @ self.gains

    @cached_property
    def slopes(self) -> FloatArray:
        """Jacobian of `residuals` with respect to the poles, shape (w m, order)."""
        law, stack, responses = self.law, self._stack, self._responses
        rest = (stack.reading - self._driven @ self.gains)[..., None]
        initial = (np.linalg.pinv(self._R) @ (self._Q.swapaxes(1, 2) @ rest))[..., 0]
        run = responses.driven @ self.gains + np.sum(responses.free * initial[stack.window], axis=1)
        once_more = stack.delayed(stack.filtered(responses.F, run[:, None])[:, 0], range(1, law.order + 1))
        of_poles = np.einsum("nl,nlp->np", once_more, law.denominator_slopes(stack.steps)[stack.step, 1:])
        slopes = self._without_start(stack.at_stamps(of_poles))
        return slopes - self._basis @ (self._basis.T @ slopes)

    def _without_start(self, columns: FloatArray) -> FloatArray:
        """Columns at the stamps, shape (w, m, c), without what initial states explain, shape (w m, c)."""
        rest = columns - self._Q @ (self._Q.swapaxes(1, 2) @ columns)
        return rest.reshape(-1, columns.shape[-1])
