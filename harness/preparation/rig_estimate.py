"""What the rig file leaves open and CAM needs is estimated from the recordings.

CAM, divided by m (1 + J/(m r²)), with a rolling friction beside, so that it is not taken for something else:

    s̈ = K [g sin(α + α₀) + s α̇² − ℓ α̈ − f N/m · sgn ṡ],   K = 1/(1 + J/(m r²)),   ℓ = h + r + J/(m r).

Only K, ℓ and α₀ appear: masses and radii cannot be told apart by a trajectory. At the measured s and ṡ the bracket is
known but for the four quantities, so that the ball's path is a double integral in time, of which only derivatives with
respect to them are needed. What it leaves of the measured position is noise and the wandering of a ball that is pushed
by the angle's error; least squares on the innovations weighs both, at the likeliest density of the wandering. A slow
ball whose pull friction exceeds is held: nothing acts on it then. Where friction acts depends on the velocity, which
the fit improves: it is repeated until it settles.
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
from harness.preparation.whitening import innovations
from harness.signals import smooth
from harness.signals.ball_state import BallEstimate
from harness.signals.drive import Drive
from harness.signals.prescribed import integrate_twice, nodes

# Smoothing rounds the corner where a ball stops, by this much at 0.3 mm of noise. A ball that is slower while friction
# exceeds its pull stops within 2 mm/s / (K g f) anyway [m/s].
_SLOW = 2e-3
_LOG_DENSITIES = (-25.0, 5.0)  # of the white acceleration [log m²/s³]: an ideal angle to one that is useless
_ROUNDS = 10
_SETTLED = 0.05  # standard errors
_DRAWS = 24
# What rigs can be at all, one standard deviation about the rough rig: K [1], α₀ [rad], ℓ [m], f [1]. It keeps a
# recording that does not show a quantity from giving any value of it, and leaves its standard error large.
_POSSIBLE = np.array([0.3, 0.1, 0.3, 0.1])


@dataclass(frozen=True)
class Estimate:
    """One estimated quantity: value and standard error in `unit`, and what was done."""

    name: str
    value: float
    std: float
    unit: str
    how: str


@dataclass(frozen=True)
class Observed:
    """One recording as the estimation sees it.

    Attributes:
        motion: the beam.
        ball: the ball's state relative to a rough rig.
        position: readings, shape (n,), NaN where not known [m].
        noise: standard deviation of a reading, rounding included [m].
    """

    motion: Drive
    ball: BallEstimate
    position: FloatArray
    noise: float


@dataclass(frozen=True)
class Fitted:
    """What was estimated; quantities that were not asked for are the rig's, with zero variance.

    Attributes:
        ratio: K [1].
        level: α₀ [rad].
        lever: ℓ [m].
        covariance: of these three in this order, shape (3, 3).
        friction: f of the rolling friction that was fitted beside [1].
        friction_std: its standard error.
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
    """Estimate those of K, α₀, ℓ that are asked for on all recordings together; the others stay as in `rig`.

    The covariance is that of generalised least squares, and what the readings of the angle leave open is added
    (drawn beam motions, `Drive.draw`). Both see the angle's fast errors, so that these count twice; slow ones, such as
    that of a beam at rest within one count, only the draws know.
    """
    free = np.array([ratio, level, lever, True])
    value = np.array([rig.rolling_ratio, rig.level_angle, rig.lever, 0.0])
    possible = value.copy()
    records = [_Record(one, rig) for one in observed]
    for _ in range(_ROUNDS):
        for record in records:
            record.linearise(value)
        density = _likeliest(records, free, possible - value)
        solution = _solve(records, free, possible - value, density)
        value = value + solution.change
        for record in records:
            record.follow(solution.change)
        if np.all(np.abs(solution.change) <= _SETTLED * np.sqrt(np.diag(solution.covariance))):
            break
    covariance = solution.covariance + _of_angle(records, free, density)
    ratio_found, level_found, lever_found, friction = map(float, value)
    return Fitted(
        ratio_found, level_found, lever_found, covariance[:3, :3], friction, float(math.sqrt(covariance[3, 3]))
    )


class _Record:
    """One recording, linearised about the present estimate.

    After `linearise`, `signals` holds the error of the position that the estimate predicts and its derivatives with
    respect to K, α₀, ℓ and f, shape (n, 5) [m, m per unit].
    """

    def __init__(self, one: Observed, rig: Rig) -> None:
        self.motion, self.rig = one.motion, rig
        self.time, self.grid = one.ball.time, Grid.over(one.ball.time)
        self.nodes, self.table = nodes(self.grid), self.grid.tabulate(one.motion)
        self.reading = np.where(one.ball.trusted, one.position, 0.0)
        self.variance = np.where(one.ball.trusted, one.noise**2, np.inf)
        self.position, self.velocity = one.ball.position, one.ball.velocity
        self.velocity_std = np.sqrt(one.ball.covariance[:, 1, 1])

    def linearise(self, value: FloatArray) -> None:
        """About K, α₀, ℓ, f = `value`, at the ball's present position and velocity."""
        K, level, lever, friction = value
        angle, rate, angular = self.table.T
        s, v, v_std = (np.interp(self.nodes, self.time, x) for x in (self.position, self.velocity, self.velocity_std))
        height = self.rig.eccentricity + self.rig.rolling_radius
        load = self.rig.gravity * np.cos(angle) - 2.0 * v * rate - s * angular - height * rate**2  # N/m
        pull = self.rig.gravity * np.sin(angle + level) + s * rate**2
        held = (np.abs(v) < np.maximum(3.0 * v_std, _SLOW)) & (np.abs(pull - lever * angular) < friction * load)
        self.moves = np.where(held, 0.0, 1.0)
        # erf is the mean of the sign of a velocity that is known to ± v_std
        against = -load * erf(v / (math.sqrt(2.0) * v_std))
        self.tilting = K * self.rig.gravity * np.cos(angle + level)
        self.jolting = K * lever
        slopes = (pull - lever * angular + friction * against, self.tilting, -K * angular, K * against)
        found = np.array([integrate_twice(self.grid, self.moves * slope) for slope in slopes])
        self.run = K * found[0]  # position and velocity, shape (2, n)
        self.slopes = found  # shape (4, 2, n)
        self.signals = np.ascontiguousarray(np.vstack((self.reading - self.run[0], self.slopes[:, 0])).T)

    def follow(self, change: FloatArray) -> None:
        """Measure the ball anew, relative to the estimate after `change`: corners at stops are then the model's."""
        position, velocity = self.run + np.tensordot(change, self.slopes, 1)
        rest = smooth(self.time, self.reading - position, self.variance)
        self.position, self.velocity = position + rest.mean[:, 0], velocity + rest.mean[:, 1]
        self.velocity_std = np.sqrt(rest.covariance[:, 1, 1])

    def pushed(self, seed: int) -> FloatArray:
        """Displacement of the ball by errors drawn of the angle, shape (n, draws) [m]."""
        shifts = []
        for path in self.motion.draw(_DRAWS, seed):
            angle, _, angular = (self.grid.tabulate(path) - self.table).T
            shifts.append(integrate_twice(self.grid, self.moves * (self.tilting * angle - self.jolting * angular))[0])
        return np.array(shifts).T


@dataclass(frozen=True)
class _Solution:
    """One step: change of (K, α₀, ℓ, f), shape (4,), its covariance (4, 4), and twice the negative log likelihood."""

    change: FloatArray
    covariance: FloatArray
    cost: float


def _likeliest(records: Sequence[_Record], free: NDArray[np.bool_], towards: FloatArray) -> float:
    """Density of the wandering [m²/s³]."""
    found = minimize_scalar(
        lambda log: _solve(records, free, towards, math.exp(log)).cost,
        bounds=_LOG_DENSITIES,
        method="bounded",
        options={"xatol": 0.1},
    )
    return math.exp(found.x)


def _solve(records: Sequence[_Record], free: NDArray[np.bool_], towards: FloatArray, density: float) -> _Solution:
    """Generalised least squares; `towards` is the way to what is possible, shape (4,)."""
    whitened = [innovations(one.time, one.signals, one.variance, density) for one in records]
    signals = np.concatenate([signals for signals, _ in whitened])
    error, slopes = signals[:, 0], signals[:, 1:][:, free]
    weight = np.diag(_POSSIBLE[free] ** -2)
    information = slopes.T @ slopes + weight
    step = np.linalg.solve(information, slopes.T @ error + weight @ towards[free])
    change, covariance = np.zeros(4), np.zeros((4, 4))
    change[free] = step
    covariance[np.ix_(free, free)] = np.linalg.inv(information)
    # The restricted likelihood (Patterson and Thompson, 1971): fitted parameters take their share of the innovations.
    off = towards[free] - step
    cost = np.sum((error - slopes @ step) ** 2) + off @ weight @ off + np.linalg.slogdet(information)[1]
    return _Solution(change, covariance, float(cost) + sum(log for _, log in whitened))


def _of_angle(records: Sequence[_Record], free: NDArray[np.bool_], density: float) -> FloatArray:
    """Covariance of the estimate, shape (4, 4), from what the readings of the angle leave open."""
    slopes, pushes = [], []
    for seed, one in enumerate(records):
        both = np.ascontiguousarray(np.column_stack((one.signals[:, 1:][:, free], one.pushed(seed))))
        both, _ = innovations(one.time, both, one.variance, density)
        slopes.append(both[:, : free.sum()])
        pushes.append(both[:, free.sum() :])
    J = np.concatenate(slopes)
    moved = np.linalg.solve(J.T @ J + np.diag(_POSSIBLE[free] ** -2), J.T @ np.concatenate(pushes))
    covariance = np.zeros((4, 4))
    covariance[np.ix_(free, free)] = moved @ moved.T / _DRAWS
    return covariance
