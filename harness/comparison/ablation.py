"""Which choice separates CAM from CUM, and which one pays: every combination of them on the same recording.

Four choices are crossed: the radius in the inertia (R or r), the α̈ term, α₀ (0 or fitted) and the friction's reading
(none or one of four, f_b fitted). What is fitted is fitted for each combination anew, on the runs that are scored, as
the paper did: the question is what the best of each kind can do.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from analytic.kernel import Grid, integrate
from analytic.models import CUM, FRICTION_GAIN, LEVEL, Model, Reading
from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.comparison.setting import Setting

_FRICTION_START = {  # of f_b, in the unit its reading needs: each slows a ball at 0.1 m/s by some 0.03 m/s²
    Reading.PRINTED: 0.05,
    Reading.PRINTED_DISSIPATIVE: 0.05,
    Reading.COULOMB: 0.005,
    Reading.VISCOUS: 0.03,
}

_LOST = 1e3  # the error of a run that ran away, finite so that the fit can turn back from it [m]


@dataclass(frozen=True)
class Combination:
    """One way to build a model, and how well the best of its kind does.

    Attributes:
        radius: in the inertia, "R" or "r".
        eccentric: with the α̈ term.
        level: whether α₀ was fitted; else it is 0.
        reading: of the friction.
        level_angle: α₀ [rad].
        friction_coefficient: f_b in the reading's unit; 0 without friction.
        max_error, rms_error: over all runs [m].
        e_disp: ∫|e_s| dt over all runs [m s].
        position: of its runs, shape (runs, n), NaN outside [m].
    """

    radius: str
    eccentric: bool
    level: bool
    reading: Reading
    level_angle: float
    friction_coefficient: float
    max_error: float
    rms_error: float
    e_disp: float
    position: FloatArray

    @property
    def key(self) -> tuple[str, bool, bool, Reading]:
        """Which choices these are."""
        return self.radius, self.eccentric, self.level, self.reading


def ablate(setting: Setting, horizon: Horizon) -> dict[tuple[str, bool, bool, Reading], Combination]:
    """All combinations on the runs of `horizon`, by their key."""
    grid = Grid.over(setting.time)
    table = grid.tabulate(setting.motion)
    found = {}
    for radius, eccentric, level, reading in itertools.product("Rr", (False, True), (False, True), Reading):
        model = CUM.variant("", inertia_radius=radius, eccentric=eccentric, reading=reading)
        one = _fit(setting, horizon, grid, table, model, level)
        found[one.key] = one
    return found


def _fit(setting: Setting, horizon: Horizon, grid: Grid, table: FloatArray, model: Model, level: bool) -> Combination:
    rig = setting.rig.with_(level_angle=0.0)
    unit = rig.with_(friction_coefficient=1.0)
    base = setting.vector(model, unit)
    starts = setting.starts(horizon)
    use = [setting.ball.trusted[where] for where in horizon.slices()]
    measured = setting.recording.position

    def vector(x: FloatArray) -> FloatArray:
        p = base.copy()
        rest = list(x)
        p[LEVEL] += rest.pop(0) if level else 0.0
        p[FRICTION_GAIN] *= rest.pop(0) if model.reading else 0.0
        return p

    def run(x: FloatArray) -> FloatArray:
        return integrate(grid, table, vector(x), starts, first=horizon.first, last=horizon.last).position

    def errors(x: FloatArray) -> FloatArray:
        position = run(x)
        pieces = [(position[i, w] - measured[w])[use[i]] for i, w in enumerate(horizon.slices())]
        return np.nan_to_num(np.concatenate(pieces), nan=_LOST).clip(-_LOST, _LOST)

    x = np.array([0.0] * level + ([_FRICTION_START[model.reading]] if model.reading else []))
    if len(x):
        bounds = ([-0.1] * level + [0.0] * bool(model.reading), [0.1] * level + [np.inf] * bool(model.reading))
        scale = [0.003] * level + ([_FRICTION_START[model.reading]] if model.reading else [])
        x = least_squares(errors, x, bounds=bounds, x_scale=scale).x
    position, error = run(x), errors(x)
    e_disp = sum(
        float(np.trapezoid(np.abs(position[i, w] - measured[w])[use[i]], setting.time[w][use[i]]))
        for i, w in enumerate(horizon.slices())
    )
    return Combination(
        radius=model.inertia_radius,
        eccentric=model.eccentric,
        level=level,
        reading=model.reading,
        level_angle=float(x[0]) if level else 0.0,
        friction_coefficient=float(x[-1]) if model.reading else 0.0,
        max_error=float(np.max(np.abs(error))),
        rms_error=float(np.sqrt(np.mean(error**2))),
        e_disp=e_disp,
        position=position,
    )
