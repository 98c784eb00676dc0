"""Estimates K, α₀ and ℓ, as far as the rig file does not determine them, from the recordings.

Model: CAM divided by m (1 + J/(m r²)), with a rolling friction so that friction does not bias the other estimates:

    s̈ = K [g sin(α + α₀) + s α̇² − ℓ α̈ − f N/m · sgn ṡ],   K = 1/(1 + J/(m r²)),   ℓ = h + r + J/(m r).

Masses and radii are not identifiable beyond K, ℓ and α₀. At the measured s and ṡ the bracket is known except for the
four parameters, so that the position is a double time integral, linearised in them (Gauss–Newton). The residual is
sensor noise plus a random walk of the velocity caused by errors of the angle, white acceleration of density q. Least
squares on innovations, with q by maximum restricted likelihood, is the generalised least squares solution. A slow ball
whose driving force is below friction is held and does not accelerate. The sign of friction depends on the velocity,
which each iteration improves; iterations stop at convergence.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.special import erf

from analytic.kernel import Grid
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.preparation.recordings import Observed
from harness.preparation.whitening import innovations
from harness.signals import smooth
from harness.signals.prescribed import integrate_twice, nodes

# Speed below which a ball is held if friction exceeds the driving force [m/s]: the error of the smoothed velocity where
# a ball stops, at 0.3 mm of noise. A free ball of this speed would stop within 2 mm/s / (K g f).
_STOPPING_SPEED = 2e-3
_LOG_DENSITIES = (-25.0, 5.0)  # search range of q [log m²/s³], from an exact angle to a useless one
_MAX_ITERATIONS = 10
_CONVERGED = 0.05  # largest step at convergence, in standard errors
_DRAWS = 24  # of the beam motion
# Prior standard deviations about the rough rig: K [1], α₀ [rad], ℓ [m], f [1]. They bound a parameter that is not
# identifiable from the recordings, and keep its standard error large.
_PRIOR_STD = np.array([0.3, 0.1, 0.3, 0.1])


@dataclass(frozen=True)
class Estimate:
    """One estimated quantity: value and standard error in `unit` (infinite if assumed), and the method."""

    name: str
    value: float
    std: float
    unit: str
    how: str


@dataclass(frozen=True)
class Fitted:
    """Estimates of K, α₀ and ℓ; those that were not requested are the rig's, with zero variance.

    Attributes:
        ratio: K [1].
        level: α₀ [rad].
        lever: ℓ [m].
        covariance: of these three in this order, shape (3, 3).
        friction: f of the jointly fitted rolling friction [1].
        friction_std: standard error of f [1].
    """

    ratio: float
    level: float
    lever: float
    covariance: FloatArray
    friction: float
    friction_std: float

    @property
    def std(self) -> tuple[float, float, float]:
        """Standard errors of K [1], α₀ [rad] and ℓ [m]."""
        ratio, level, lever = np.sqrt(np.diag(self.covariance)).tolist()
        return ratio, level, lever


def fit_unknown(observed: Sequence[Observed], rig: Rig, *, ratio: bool, level: bool, lever: bool) -> Fitted:
    """Estimates the requested ones of K, α₀ and ℓ from all recordings jointly; the others are those of `rig`.

    The covariance is the sum of that of generalised least squares and that due to the angle's uncertainty (drawn beam
    motions, `Drive.draw`). Fast errors of the angle are in both, hence counted twice; slow ones, such as that of a beam
    at rest within one count, only in the second.
    """
    free = np.array([ratio, level, lever, True])
    value = np.array([rig.rolling_ratio, rig.level_angle, rig.lever, 0.0])
    prior = value.copy()
    records = [_Linearised(one, rig) for one in observed]
    for _ in range(_MAX_ITERATIONS):
        for record in records:
            record.linearise(value)
        density = _most_likely_density(records, free, prior - value)
        solution = _solve(records, free, prior - value, density)
        value = value + solution.change
        for record in records:
            record.update(solution.change)
        if np.all(np.abs(solution.change) <= _CONVERGED * np.sqrt(np.diag(solution.covariance))):
            break
    covariance = solution.covariance + _covariance_of_angle(records, free, density)
    ratio_found, level_found, lever_found, friction = map(float, value)
    return Fitted(
        ratio_found, level_found, lever_found, covariance[:3, :3], friction, float(math.sqrt(covariance[3, 3]))
    )


class _Linearised:
    """One recording, linearised about the current estimate.

    After `linearise`, `signals` contains the residual of the position and the derivatives of the predicted position
    with respect to K, α₀, ℓ and f, shape (n, 5) [m, m per unit].
    """

    def __init__(self, one: Observed, rig: Rig) -> None:
        self.drive, self.rig = one.drive, rig
        self.time, self.grid = one.ball.time, Grid.over(one.ball.time)
        self.nodes, self.table = nodes(self.grid), self.grid.tabulate(one.drive)
        self.reading = np.where(one.ball.trusted, one.recording.position, 0.0)
        self.variance = np.where(one.ball.trusted, one.noise**2, np.inf)
        self.position, self.velocity = one.ball.position, one.ball.velocity
        self.velocity_std = np.sqrt(one.ball.covariance[:, 1, 1])

    def linearise(self, value: FloatArray) -> None:
        """Linearises about K, α₀, ℓ, f = `value` at the current estimate of position and velocity."""
        K, level, lever, friction = value
        angle, rate, angular = self.table.T
        s, v, v_std = (np.interp(self.nodes, self.time, x) for x in (self.position, self.velocity, self.velocity_std))
        height = self.rig.eccentricity + self.rig.rolling_radius
        load = self.rig.gravity * np.cos(angle) - 2.0 * v * rate - s * angular - height * rate**2  # N/m
        drive = self.rig.gravity * np.sin(angle + level) + s * rate**2
        held = (np.abs(v) < np.maximum(3.0 * v_std, _STOPPING_SPEED)) & (
            np.abs(drive - lever * angular) < friction * load
        )
        self.moves = np.where(held, 0.0, 1.0)
        # erf is the expected sign of a velocity with standard deviation v_std
        friction_per_f = -load * erf(v / (math.sqrt(2.0) * v_std))
        self.angle_gain = K * self.rig.gravity * np.cos(angle + level)
        self.angular_gain = K * lever
        slopes = (
            drive - lever * angular + friction * friction_per_f,
            self.angle_gain,
            -K * angular,
            K * friction_per_f,
        )
        found = np.array([integrate_twice(self.grid, self.moves * slope) for slope in slopes])
        self.run = K * found[0]  # position and velocity, shape (2, n)
        self.slopes = found  # shape (4, 2, n)
        self.signals = np.ascontiguousarray(np.vstack((self.reading - self.run[0], self.slopes[:, 0])).T)

    def update(self, change: FloatArray) -> None:
        """Smooths the ball's state again, relative to the updated model, which resolves the corners where it stops."""
        position, velocity = self.run + np.tensordot(change, self.slopes, 1)
        rest = smooth(self.time, self.reading - position, self.variance)
        self.position, self.velocity = position + rest.mean[:, 0], velocity + rest.mean[:, 1]
        self.velocity_std = np.sqrt(rest.covariance[:, 1, 1])

    def displacements(self, seed: int) -> FloatArray:
        """Displacement of the ball by drawn errors of the angle, shape (n, draws) [m]."""
        shifts = []
        for path in self.drive.draw(_DRAWS, seed):
            angle, _, angular = (self.grid.tabulate(path) - self.table).T
            shifts.append(
                integrate_twice(self.grid, self.moves * (self.angle_gain * angle - self.angular_gain * angular))[0]
            )
        return np.array(shifts).T


@dataclass(frozen=True)
class _Solution:
    """One Gauss–Newton step: change of (K, α₀, ℓ, f), shape (4,), its covariance (4, 4), and −2 log L."""

    change: FloatArray
    covariance: FloatArray
    cost: float


def _most_likely_density(records: Sequence[_Linearised], free: NDArray[np.bool_], towards: FloatArray) -> float:
    """Density q of the white acceleration by maximum restricted likelihood [m²/s³]."""
    found = minimize_scalar(
        lambda log: _solve(records, free, towards, math.exp(log)).cost,
        bounds=_LOG_DENSITIES,
        method="bounded",
        options={"xatol": 0.1},
    )
    return math.exp(found.x)


def _solve(records: Sequence[_Linearised], free: NDArray[np.bool_], towards: FloatArray, density: float) -> _Solution:
    """One step of generalised least squares; `towards` is prior mean minus current value, shape (4,)."""
    whitened = [innovations(one.time, one.signals, one.variance, density) for one in records]
    signals = np.concatenate([signals for signals, _ in whitened])
    error, slopes = signals[:, 0], signals[:, 1:][:, free]
    weight = np.diag(_PRIOR_STD[free] ** -2)
    information = slopes.T @ slopes + weight
    step = np.linalg.solve(information, slopes.T @ error + weight @ towards[free])
    change, covariance = np.zeros(4), np.zeros((4, 4))
    change[free] = step
    covariance[np.ix_(free, free)] = np.linalg.inv(information)
    # Restricted likelihood (Patterson and Thompson, 1971), which accounts for the fitted parameters.
    off = towards[free] - step
    cost = np.sum((error - slopes @ step) ** 2) + off @ weight @ off + np.linalg.slogdet(information)[1]
    return _Solution(change, covariance, float(cost) + sum(log for _, log in whitened))


def _covariance_of_angle(records: Sequence[_Linearised], free: NDArray[np.bool_], density: float) -> FloatArray:
    """Covariance of the estimate due to the uncertainty of the angle, shape (4, 4)."""
    slopes, displacements = [], []
    for seed, one in enumerate(records):
        both = np.ascontiguousarray(np.column_stack((one.signals[:, 1:][:, free], one.displacements(seed))))
        both, _ = innovations(one.time, both, one.variance, density)
        slopes.append(both[:, : free.sum()])
        displacements.append(both[:, free.sum() :])
    J = np.concatenate(slopes)
    shifts = np.linalg.solve(J.T @ J + np.diag(_PRIOR_STD[free] ** -2), J.T @ np.concatenate(displacements))
    covariance = np.zeros((4, 4))
    covariance[np.ix_(free, free)] = shifts @ shifts.T / _DRAWS
    return covariance
