"""The identified model linearised about an operating point, with intervals from the covariance of its parameters.

At rest at s₀ on a beam at α₀ the equation of motion is s̈ = a(s, ṡ, α, α̇, α̈). In the states x = (s, ṡ, angle behind
the beam's lags, sensed position) it is ẋ = A x + B₀ u + B₁ u̇ + B₂ ü with the recorded angle u. As y does not depend on
ṡ, C B₂ = 0, and with z = x − B₂ u̇ − (B₁ + A B₂) u

    ż = A z + (B₀ + A B₁ + A² B₂) u,   y = C z + (D₀ + C (B₁ + A B₂)) u,

one input and no derivatives of it. Dry friction and play have no derivative and are left out, which is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import pade as pade_of
from scipy.signal import tf2ss

from analytic.effects import Acting, parameters_with
from analytic.law import acceleration
from analytic.models import CAM
from analytic.motion import FloatArray
from harness.errors import InputError
from harness.exports.model import ExportModel, refuse_own_effects
from harness.identify.problem.spline_term import Regressor
from harness.numerics import TWO_SIDED

_WIDTHS = np.array([1e-5, 1e-5, 1e-5, 1e-3, 1e-2])  # of differences in s, ṡ, α, α̇, α̈ (SI): errors of 1e-9
_MOST_PADE = 10  # beyond, the coefficients of a Padé approximation lose their digits
_SHARE = 1e-4  # of a parameter's standard deviation, over which the matrices are differenced


@dataclass(frozen=True)
class Point:
    """The operating point: the ball at rest at `position` [m], the recorded angle `angle` [rad]."""

    position: float = 0.0
    angle: float = 0.0


@dataclass(frozen=True)
class Linear:
    """A linear model ẋ = A x + B u, y = C x + D u of deviations from an operating point.

    Attributes:
        point: the operating point.
        A, B, C, D: shape (n, n), (n, 1), (1, n), (1, 1); u is the recorded angle [rad], y the recorded position [m].
        B_angle, B_rate, B_acceleration: of the angle, its rate and its second derivative as three inputs, (n, 1) each,
            with the states `physical`.
        deviations: standard deviations of A, B, C and D from the covariance of the parameters, by name.
        states: names of the states of A, B, C, D.
        physical: names of the states of A, B_angle, B_rate, B_acceleration.
        offset: acceleration that is left at the operating point [m/s²]; 0 where the ball would stay.
        delay, delay_deviation: of y [s]; not in the matrices.
        left_out: effects that no linear model has, with the reason.
    """

    point: Point
    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    B_angle: FloatArray
    B_rate: FloatArray
    B_acceleration: FloatArray
    states: tuple[str, ...]
    physical: tuple[str, ...]
    offset: float
    delay: float
    left_out: tuple[str, ...]
    deviations: dict[str, FloatArray]
    delay_deviation: float = 0.0

    def interval(self, name: str) -> tuple[FloatArray, FloatArray]:
        """95 % interval of a matrix, lower and upper end, in its shape."""
        value, reach = getattr(self, name), TWO_SIDED * self.deviations[name]
        return value - reach, value + reach

    def with_pade(self, order: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """A, B, C, D with the delay as a Padé approximation of this order behind them.

        Raises:
            InputError: the delay is negative, or there is none, or the order is out of 1 … 10.
        """
        if not 1 <= order <= _MOST_PADE:
            raise InputError(f"a Padé approximation of order {order}; it must lie between 1 and {_MOST_PADE}")
        if self.delay <= 0.0:
            told = "there is no delay" if self.delay == 0.0 else f"the delay is {self.delay:g} s: the angle is late"
            raise InputError(f"no Padé approximation: {told}; leave out --pade")
        A, B, C, D = delay_matrices(self.delay, order)
        n, m = len(self.A), len(A)
        joined = np.block([[self.A, np.zeros((n, m))], [B @ self.C, A]])
        return joined, np.vstack((self.B, B @ self.D)), np.hstack((D @ self.C, C)), D @ self.D


def delay_matrices(delay: float, order: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """A, B, C, D of the Padé approximation of exp(−p delay), numerator and denominator of this order; `delay` in s."""
    series = np.cumprod(np.concatenate(([1.0], -1.0 / np.arange(1.0, 2 * order + 1))))
    above, below = pade_of(series, order, order)
    powers = delay ** np.arange(order, -1, -1.0)  # p delay in place of p
    A, B, C, D = tf2ss(above.coeffs * powers, below.coeffs * powers)
    return A, B, C, D


def linearise(model: ExportModel, point: Point) -> Linear:
    """The linear model about a point, with standard deviations by the delta method.

    Raises:
        InputError: a law of the user's own, or one of time or of the rolled angle, which has no operating point.
    """
    refuse_own_effects(model, "a linear model")
    if model.spline is not None and model.spline.depends in (Regressor.TIME, Regressor.ROLL_ANGLE):
        raise InputError(
            f"{model.origin}: its model has a law of the {model.spline.depends.value.replace('_', ' ')}, which has no "
            "operating point; export with --to python"
        )
    best = _linear(model, model.acting, point)
    count = len(model.keys)
    sizes = np.sqrt(np.diag(model.covariance)[:count].clip(min=0.0)) if count else np.zeros(0)
    names = ("A", "B", "C", "D")
    slopes: dict[str, list[FloatArray]] = {name: [] for name in (*names, "delay")}
    for i, size in enumerate(sizes):
        width = _SHARE * size
        sides = []
        for sign in (1.0, -1.0):
            theta = model.theta.copy()
            theta[i] += sign * width
            sides.append(_linear(model, model.with_theta(theta), point))
        for name, column in slopes.items():
            apart = np.asarray(getattr(sides[0], name)) - np.asarray(getattr(sides[1], name))
            column.append(apart / (2.0 * width) if width > 0.0 else np.zeros_like(apart))
    covariance = model.covariance[:count, :count]
    deviations = {name: _deviation(columns, covariance, getattr(best, name)) for name, columns in slopes.items()}
    delay = float(deviations.pop("delay"))
    return replace(best, deviations=deviations, delay_deviation=delay)


def _deviation(columns: Sequence[FloatArray], covariance: FloatArray, like: FloatArray | float) -> FloatArray:
    """√(g' Σ g) of each entry, g its slopes by the parameters."""
    if not columns:
        return np.zeros_like(np.asarray(like))
    slopes = np.array(columns)
    return np.sqrt(np.einsum("i...,ij,j...->...", slopes, covariance, slopes).clip(min=0.0))


def _linear(model: ExportModel, effects: Sequence[Acting], point: Point) -> Linear:
    """The linear model with these values of the effects, without deviations."""
    smooth = [one for one in effects if not one.effect.dry and (one.effect.code is None or not one.effect.code.inner)]
    p = parameters_with(CAM, model.declared_rig, smooth)
    if model.spline is not None and not model.spline.friction:
        model.spline.write(p)
    sensor = model.sensor_of(effects)
    gain, lags, left = (
        1.0,
        [],
        [f"{one.effect.name}: {one.effect.law}; it has no derivative at rest" for one in effects if one not in smooth],
    )
    beam = point.angle
    for one in effects:
        stage = None if one.effect.code is None else one.effect.code.stage
        values = list(one.values.values())
        if stage == "gain":
            gain, beam = gain * values[0], beam * values[0]
        elif stage == "curve":
            square, cube = values
            gain *= 1.0 + beam * (2.0 * square + 3.0 * cube * beam)
            beam *= 1.0 + beam * (square + cube * beam)
        elif stage == "lag":
            lags.append((values[0], 0.0))
        elif stage == "servo":
            lags.append((values[0], (0.5 * values[0] / values[1]) ** 2))
        elif stage == "hold":
            lags.append((0.5 * values[0], 0.0))
            left.append(f"{one.effect.name}: the mean over T stands as a lag of T/2, right to first order in frequency")
        elif stage is not None:
            left.append(f"{one.effect.name}: {one.effect.law}; no linear time-invariant model has it")
    if model.spline is not None and model.spline.friction:
        left.append(f"{model.spline.name}: a dry friction; it has no derivative at rest")
    at = np.array([point.position, 0.0, beam, 0.0, 0.0])
    slopes = np.array(
        [
            (_of(at + step, p) - _of(at - step, p)) / (2.0 * width)
            for step, width in zip(np.diag(_WIDTHS), _WIDTHS, strict=True)
        ]
    )
    return _assembled(
        point,
        slopes,
        gain,
        [one for one in lags if one[0] > 0.0],
        sensor.lag,
        float(sensor.slope(np.array(point.position))),
        _of(at, p),
        sensor.delay,
        left,
    )


def _of(at: FloatArray, p: FloatArray) -> float:
    """s̈ [m/s²] at s, ṡ, α, α̇, α̈, shape (5,)."""
    s, v, angle, rate, angular = at.tolist()
    return float(acceleration(s, v, angle, rate, angular, p))


def _assembled(
    point: Point,
    slopes: FloatArray,
    gain: float,
    lags: Sequence[tuple[float, float]],
    sensor_lag: float,
    sensor_gain: float,
    offset: float,
    delay: float,
    left: Sequence[str],
) -> Linear:
    """The matrices from derivatives of s̈ by s, ṡ, α, α̇, α̈, shape (5,), gain and lags of the beam, and the sensor.

    Each lag is T [s] and q [s²] of q β̈ + T β̇ + β, q = 0 where it is of first order.
    """
    n = 2 + sum(1 + (square > 0.0) for _, square in lags) + (sensor_lag > 0.0)
    A, B = np.zeros((n, n)), np.zeros((3, n, 1))  # of u, u̇, ü
    A[0, 1], A[1, :2] = 1.0, slopes[:2]
    # α, α̇, α̈ of the beam as rows over x and over u, u̇, ü
    of_x, of_u = np.zeros((3, n)), gain * np.eye(3)
    row, physical = 2, ["position_m", "velocity_m_s"]
    for number, (constant, square) in enumerate(lags, start=1):
        before_x, before_u = of_x, of_u
        angle = np.eye(n)[row]
        physical.append(f"lagging_angle_{number}_rad")
        if square > 0.0:
            rate = np.eye(n)[row + 1]
            bend_x, bend_u = (before_x[0] - angle - constant * rate) / square, before_u[0] / square
            A[row], A[row + 1], B[:, row + 1, 0] = rate, bend_x, bend_u
            of_x, of_u = np.array([angle, rate, bend_x]), np.array([np.zeros(3), np.zeros(3), bend_u])
            physical.append(f"lagging_rate_{number}_rad_s")
        else:
            rate_x, rate_u = (before_x[0] - angle) / constant, before_u[0] / constant
            A[row], B[:, row, 0] = rate_x, rate_u
            of_x = np.array([angle, rate_x, (before_x[1] - rate_x) / constant])
            of_u = np.array([np.zeros(3), rate_u, (before_u[1] - rate_u) / constant])
        row += 1 + (square > 0.0)
    A[1] += slopes[2:] @ of_x
    B[:, 1, 0] += slopes[2:] @ of_u
    C = np.zeros((1, n))
    if sensor_lag > 0.0:
        A[n - 1, 0], A[n - 1, n - 1] = 1.0 / sensor_lag, -1.0 / sensor_lag
    C[0, n - 1 if sensor_lag > 0.0 else 0] = sensor_gain
    behind = B[1] + A @ B[2]
    physical += ["sensed_position_m"] if sensor_lag > 0.0 else []
    shifts = zip(physical, B[2].ravel(), behind.ravel(), strict=True)
    return Linear(
        point,
        A,
        B[0] + A @ B[1] + A @ A @ B[2],
        C,
        C @ behind,
        B[0],
        B[1],
        B[2],
        tuple(_shifted(*each) for each in shifts),
        tuple(physical),
        offset,
        delay,
        tuple(left),
        {},
    )


def _shifted(name: str, rate: float, angle: float) -> str:
    """A state of A, B, C, D in terms of a physical one."""
    parts = [f"{-value:+.9g} {what}" for value, what in ((rate, "angle_rate"), (angle, "angle")) if value != 0.0]
    return " ".join([name, *parts])
