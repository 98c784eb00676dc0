"""What the rig file leaves open and CAM needs is estimated from the recordings, over short windows.

Over a window of 2 s the start state hardly matters once a straight line is taken out of the error, and the beam's
angle error has not yet grown. A Coulomb friction (eq. 15) is fitted beside, so that it is not taken for something
else; the law of motion is CAM's, divided by m:

    s̈ = K [g sin(α + α₀) + s α̇² − ℓ α̈] − friction,   K = 1/(1 + J/(m r²)),   ℓ = h + r + J/(m r).

Only K, ℓ and α₀ appear: masses and radii cannot be told apart by a trajectory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from analytic.kernel import Grid, integrate
from analytic.models import (
    CENTRIFUGAL,
    ECCENTRIC,
    FRICTION_GAIN,
    GRAVITY,
    LEVEL,
    READING,
    SLOTS,
    TRANSITION,
    Reading,
)
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig
from harness.ball_state import BallEstimate
from harness.compare.segments import horizons

_WINDOW = 2.0  # [s]
_BOUNDS = {"ratio": (0.05, 1.5), "level": (-0.2, 0.2), "lever": (-0.5, 0.5), "friction": (0.0, 0.5)}


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
    """One recording as the estimation sees it."""

    motion: BeamMotion
    ball: BallEstimate
    position: FloatArray


@dataclass(frozen=True)
class Fitted:
    """Rolling ratio K [1], level angle α₀ [rad], lever ℓ [m] and their covariance, shape (3, 3), in this order."""

    ratio: float
    level: float
    lever: float
    covariance: FloatArray


def fit_unknown(observed: Sequence[Observed], rig: Rig, *, ratio: bool, level: bool, lever: bool) -> Fitted:
    """Estimate those of K, α₀, ℓ that are asked for on all recordings together; the others stay as in `rig`.

    The covariance is the sandwich over windows (Liang and Zeger, Biometrika 73, 1986): errors within a window are
    correlated, windows nearly are not.
    """
    names = [name for name, free in (("ratio", ratio), ("level", level), ("lever", lever)) if free]
    start = {"ratio": rig.rolling_ratio, "level": rig.level_angle, "lever": rig.lever, "friction": 1e-3}
    free = [*names, "friction"]
    windows = [_windows(one) for one in observed]

    def residuals(x: FloatArray) -> list[FloatArray]:
        value = start | dict(zip(free, x, strict=True))
        p = np.zeros(SLOTS)
        p[GRAVITY], p[CENTRIFUGAL] = value["ratio"] * rig.gravity, value["ratio"]
        p[ECCENTRIC], p[LEVEL] = value["ratio"] * value["lever"], value["level"]
        p[READING], p[TRANSITION] = float(Reading.COULOMB), rig.transition_velocity
        p[FRICTION_GAIN] = p[GRAVITY] * value["friction"]
        return [piece for window in windows for piece in window(p)]

    low, high = np.array([_BOUNDS[name] for name in free]).T
    scale = [{"ratio": 0.1, "level": 0.01, "lever": 0.05, "friction": 0.005}[name] for name in free]

    def joined(x: FloatArray) -> FloatArray:
        return np.concatenate(residuals(x))

    found = least_squares(
        joined,
        np.clip([start[name] for name in free], low + 1e-9, high - 1e-9),
        bounds=(low, high),
        x_scale=scale,
        loss="soft_l1",
    )
    lengths = [len(piece) for piece in residuals(found.x)]
    value = start | dict(zip(free, found.x, strict=True))
    covariance = np.zeros((3, 3))
    each = _sandwich(np.asarray(found.jac), found.fun, lengths)
    place = [("ratio", "level", "lever").index(name) for name in names]
    covariance[np.ix_(place, place)] = each[: len(names), : len(names)]
    return Fitted(float(value["ratio"]), float(value["level"]), float(value["lever"]), covariance)


def _windows(one: Observed) -> Callable[[FloatArray], list[FloatArray]]:
    """Maps kernel parameters to one recording's window errors, a straight line taken out, over the noise."""
    ball = one.ball
    grid = Grid.over(ball.time)
    table = grid.tabulate(one.motion)
    spans = horizons(ball.time, np.isfinite(one.position), [_WINDOW])[-1]
    starts = np.column_stack((ball.position[spans.first], ball.velocity[spans.first]))

    def errors(p: FloatArray) -> list[FloatArray]:
        runs = integrate(grid, table, p, starts, first=spans.first, last=spans.last)
        pieces = []
        for run, where in zip(runs.position, spans.slices(), strict=True):
            use = ball.trusted[where]
            time, error = ball.time[where][use], (one.position[where] - run[where])[use]
            if len(time) > 4:
                line = np.polynomial.polynomial.polyfit(time - time[0], error, 1)
                pieces.append((error - np.polynomial.polynomial.polyval(time - time[0], line)) / ball.noise)
        return pieces

    return errors


def _sandwich(jacobian: FloatArray, residual: FloatArray, lengths: Sequence[int]) -> FloatArray:
    """Covariance of an M-estimate with soft-L1 loss, windows of `lengths` residuals being independent of each other."""
    weight = 1.0 / np.sqrt(1.0 + residual**2)
    bread = np.linalg.pinv(jacobian.T @ (weight[:, None] * jacobian))
    ends = np.cumsum(lengths)
    pulls = jacobian * (weight * residual)[:, None]
    scores = np.array([pulls[end - n : end].sum(axis=0) for end, n in zip(ends, lengths, strict=True)])
    groups = len(lengths)
    correction = groups / max(groups - jacobian.shape[1], 1)
    result: FloatArray = correction * bread @ (scores.T @ scores) @ bread
    return result
