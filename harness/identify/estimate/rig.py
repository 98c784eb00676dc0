"""The only estimator of K, α₀ and ℓ: fits what stands for the quantities that a rig file leaves open.

Model: CAM with the declared effects, and a rolling friction so that friction does not bias the other estimates:

    s̈ = K [g sin(α + α₀) + s α̇² − ℓ α̈ − f N/m · sgn ṡ],   K = 1/(1 + J/(m r²)),   ℓ = h + r + J/(m r).

Of a ball that is damped so much that its velocity follows the angle, as in water, or that is recorded late, that model
gives a K several times too small; `damped` puts viscous damping and a delay of the position in the friction's place.

Masses and radii are not identifiable beyond K, ℓ and α₀. K and ℓ are fitted as such, in place of the rough rig's: no
mass or radius has to be adapted to them on the way, and K may leave (0, 1), which tells of a wrong unit or sign.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CHANNEL_DELAY, LEVEL_ERROR, ROLLING_RESISTANCE, VISCOUS_DAMPING, Effect, Parameter
from analytic.effects.force import Values
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.slots import (
    CENTRIFUGAL,
    DAHL_STIFFNESS,
    ECCENTRIC,
    FRICTION_GAIN,
    GRAVITY,
    IMBALANCE,
    QUADRATIC,
    RESPONSE,
    VISCOUS,
)
from harness.identify.estimate.covariance import interval_jacobian
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.screening import COARSE_STEP, information_inverse
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

_PROPORTIONAL = [
    GRAVITY,
    CENTRIFUGAL,
    ECCENTRIC,
    FRICTION_GAIN,
    RESPONSE,
    VISCOUS,
    QUADRATIC,
    IMBALANCE,
    DAHL_STIFFNESS,
]  # slots of the kernel's vector that contain K as a factor
_DRAWS = 24  # of the beam motion
_ROUNDS = 3  # of parameters and process noise in turn: K and ℓ enter linearly, and a diagnosis fits all of it again
_MAX_LEVER_STD = 0.02  # largest standard error of an estimated lever that is used [m]


def _write_ratio(p: FloatArray, rig: Rig, values: Values) -> None:
    p[_PROPORTIONAL] *= values["ratio"] / rig.rolling_ratio


def _write_lever(p: FloatArray, rig: Rig, values: Values) -> None:
    p[ECCENTRIC] = p[RESPONSE] * values["lever"]


_RATIO = Effect(
    "fitted_ratio",
    "K is this instead of the rig's, ℓ as before",
    (Parameter("ratio", "1", -3.0, 10.0, 0.6, starts=lambda _, rig: [rig.rolling_ratio]),),
    "the paper, eq. 14",
    write=_write_ratio,
)
_LEVER = Effect(
    "fitted_lever",
    "ℓ is this instead of the rig's",
    (Parameter("lever", "m", -2.0, 2.0, 0.05, starts=lambda _, rig: [rig.lever]),),
    "the paper, eq. 14",
    write=_write_lever,
)
_STAND_INS = {
    effect.name: effect for effect in (_RATIO, _LEVER, LEVEL_ERROR, ROLLING_RESISTANCE, VISCOUS_DAMPING, CHANNEL_DELAY)
}


@dataclass(frozen=True)
class _RigHypothesis(Hypothesis):
    """A hypothesis of stand-ins."""

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """By name."""
        return tuple(_STAND_INS[name] for name in self.names)


@dataclass(frozen=True)
class FittedRig:
    """Estimates of K, α₀ and ℓ; those that were not requested are the rig's, with zero variance.

    Attributes:
        ratio: K [1].
        level: α₀ [rad].
        lever: ℓ [m].
        covariance: of these three in this order, shape (3, 3).
        deviance: of the fit [1].
        beside: what was fitted jointly, beside the declared effects: value and standard error of each effect's only
            parameter, in its unit.
    """

    ratio: float
    level: float
    lever: float
    covariance: FloatArray
    deviance: float
    beside: Mapping[Effect, tuple[float, float]]

    @property
    def std(self) -> tuple[float, float, float]:
        """Standard errors of K [1], α₀ [rad] and ℓ [m]."""
        ratio, level, lever = np.sqrt(np.diag(self.covariance)).tolist()
        return ratio, level, lever


def fit_rig(problem: Problem, *, ratio: bool, level: bool, lever: bool, damped: bool = False) -> FittedRig:
    """Estimates the requested ones of K, α₀ and ℓ from all recordings jointly; the others are those of the rig.

    Args:
        problem: of the rough rig, with nothing that stands for the unknown.
        ratio, level, lever: which are requested; ℓ is left at the rig's if its standard error would exceed 0.02 m.
        damped: whether viscous damping and a delay are fitted jointly, and not a rolling friction.
    """
    beside = (VISCOUS_DAMPING, CHANNEL_DELAY) if damped else (ROLLING_RESISTANCE,)
    requested = {_RATIO: ratio, LEVEL_ERROR: level, beside[0]: True}
    names = tuple(effect.name for effect, wanted in requested.items() if wanted)
    found = fit(problem, _RigHypothesis(names), rounds=_ROUNDS)
    if damped:  # one after the other: from no damping, a long delay is a better explanation than a short one
        found = _fit_with(problem, found, CHANNEL_DELAY, 0.0)
    if lever:
        found = _with_lever(problem, found)
    rig, values = problem.rig, found.values()
    rows = {key: row for row, key in enumerate(found.hypothesis.parameters)}
    chosen = [rows.get(_key(one), -1) for one in (_RATIO, LEVEL_ERROR, _LEVER, *beside)]
    # The last row and column are those of what is not fitted.
    covariance = np.pad(_covariance(problem, found), (0, 1))[np.ix_(chosen, chosen)]
    return FittedRig(
        ratio=values.get(_key(_RATIO), rig.rolling_ratio),
        level=rig.level_angle + values.get(_key(LEVEL_ERROR), 0.0),
        lever=values.get(_key(_LEVER), rig.lever),
        covariance=covariance[:3, :3],
        deviance=found.deviance,
        beside={
            effect: (values[_key(effect)], float(np.sqrt(variance)))
            for effect, variance in zip(beside, np.diag(covariance)[3:], strict=True)
        },
    )


def _with_lever(problem: Problem, found: Fit) -> Fit:
    """A fit of ℓ too, if the recordings identify it."""
    wider, begin = _wider(problem, found, _LEVER, problem.rig.lever)
    slopes = Residuals(problem, wider, found.process_noise).jacobian(begin, COARSE_STEP)
    variance = information_inverse(problem, wider, slopes)[-1, -1]
    if variance > _MAX_LEVER_STD**2:
        return found
    return _fit_with(problem, found, _LEVER, problem.rig.lever)


def _fit_with(problem: Problem, found: Fit, effect: Effect, value: float) -> Fit:
    """A fit of an effect too, from the values of `found` and this one of its only parameter, in its unit."""
    wider, begin = _wider(problem, found, effect, value)
    return fit(problem, wider, starts=(begin,), process_noise=found.process_noise, rounds=_ROUNDS)


def _wider(problem: Problem, found: Fit, effect: Effect, value: float) -> tuple[_RigHypothesis, FloatArray]:
    """The hypothesis of `found` with an effect more, and its scaled parameters, shape (k,)."""
    wider = _RigHypothesis((*found.hypothesis.names, effect.name))
    return wider, np.append(found.theta, value / wider.scale(problem)[-1])


def _key(effect: Effect) -> tuple[str, str]:
    """Key of an effect's only parameter among the values of a fit."""
    return effect.name, effect.parameters[0].name


def _covariance(problem: Problem, found: Fit) -> FloatArray:
    """Covariance of the fitted parameters in their units, shape (k, k).

    That of the likelihood, whose angle error is small enough for slopes, and the scatter of the estimates over beam
    motions drawn from the drive: when a resting ball goes is no smooth function of the angle.
    """
    residuals = Residuals(problem, found.hypothesis, found.process_noise)
    slopes, here = interval_jacobian(problem, found), residuals.at(found.theta)
    paths = [record.drive.draw(_DRAWS, seed) for seed, record in enumerate(problem.recordings)]
    moved = []
    for drawn in zip(*paths, strict=True):
        records = [
            replace(record, drive=replace(record.drive, states=path.states))
            for record, path in zip(problem.recordings, drawn, strict=True)
        ]
        other = Residuals(replace(problem, recordings=tuple(records)), found.hypothesis, found.process_noise)
        moved.append(other.at(found.theta) - here)
    shifts = np.linalg.lstsq(slopes, np.array(moved).T)[0] * found.hypothesis.scale(problem)[:, None]
    return information_inverse(problem, found.hypothesis, slopes) + shifts @ shifts.T / _DRAWS
