"""Full-factorial ablation of the model terms that separate CAM from CUM, on one recording.

Factors: the radius in the inertia (R or r), the α̈ term, α₀ (0 or fitted) and the reading of the friction law (none or
one of four, f_b fitted). α₀ and f_b are fitted separately for each combination, on the runs that are scored, as in the
paper: combinations are compared at their best fit.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from analytic.kernel import Grid, integrate_windows
from analytic.models import CUM, Model, Reading
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.slots import FRICTION_GAIN, LEVEL
from harness.comparison.horizons import Horizon
from harness.comparison.setting import Setting
from harness.numerics import rms

_FRICTION_START = {  # initial f_b in the unit of its reading; each decelerates a ball at 0.1 m/s by some 0.03 m/s²
    Reading.PRINTED: 0.05,
    Reading.PRINTED_DISSIPATIVE: 0.05,
    Reading.COULOMB: 0.005,
    Reading.VISCOUS: 0.03,
}

_SAME_RADIUS = 1e-9  # relative difference of r and R
_DIVERGED_ERROR = 1e3  # error assigned to a diverged run, finite so that the fit can continue [m]


@dataclass(frozen=True)
class Combination:
    """One combination of model terms with its fitted parameters and errors.

    Attributes:
        radius: in the inertia, "R" or "r".
        eccentric: whether the α̈ term is included.
        level: whether α₀ was fitted; else it is 0.
        reading: of the friction law.
        level_angle: α₀ [rad].
        friction_coefficient: f_b in the reading's unit; 0 without friction.
        max_error, rms_error: over all runs [m].
        e_disp: ∫|e_s| dt over all runs [m s].
        position: of the ball at the stamps of the horizon, shape (k,) [m].
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
        """The levels of the four factors."""
        return self.radius, self.eccentric, self.level, self.reading


def ablate(setting: Setting, horizon: Horizon) -> dict[tuple[str, bool, bool, Reading], Combination]:
    """Fits and scores all combinations on the runs of `horizon`; by `Combination.key`.

    On a flat rail, where r = R, those of both radii are the same, and fitted once.
    """
    grid = Grid.over(setting.time)
    table = grid.tabulate(setting.motion)
    found: dict[tuple[str, bool, bool, Reading], Combination] = {}
    once = one_radius(setting.rig)
    for radius, eccentric, level, reading in itertools.product("Rr", (False, True), (False, True), Reading):
        if once and radius == "r":
            one = replace(found["R", eccentric, level, reading], radius="r")
        else:
            model = CUM.variant("", inertia_radius=radius, eccentric=eccentric, reading=reading)
            one = _fit(setting, horizon, grid, table, model, level)
        found[one.key] = one
    return found


def one_radius(rig: Rig) -> bool:
    """Whether the ball rolls on its own radius, as on a flat rail: r = R, so that the choice between them is none."""
    return math.isclose(rig.rolling_radius, rig.radius, rel_tol=_SAME_RADIUS)


def _fit(setting: Setting, horizon: Horizon, grid: Grid, table: FloatArray, model: Model, level: bool) -> Combination:
    rig = setting.rig.with_(level_angle=0.0)
    unit = rig.with_(friction_coefficient=1.0)
    base = setting.vector(model, unit)
    starts = setting.starts(horizon)
    use, measured = setting.ball.trusted[horizon.stamps], setting.recording.position[horizon.stamps]

    def vector(x: FloatArray) -> FloatArray:
        p = base.copy()
        rest = list(x)
        p[LEVEL] += rest.pop(0) if level else 0.0
        p[FRICTION_GAIN] *= rest.pop(0) if model.reading else 0.0
        return p

    def run(x: FloatArray) -> FloatArray:
        return integrate_windows(grid, table, vector(x), starts, horizon.first, horizon.last)[0]

    def errors(x: FloatArray) -> FloatArray:
        error = (run(x) - measured)[use]
        return np.nan_to_num(error, nan=_DIVERGED_ERROR).clip(-_DIVERGED_ERROR, _DIVERGED_ERROR)

    x = np.array([0.0] * level + ([_FRICTION_START[model.reading]] if model.reading else []))
    if len(x):
        bounds = ([-0.1] * level + [0.0] * bool(model.reading), [0.1] * level + [np.inf] * bool(model.reading))
        scale = [0.003] * level + ([_FRICTION_START[model.reading]] if model.reading else [])
        x = least_squares(errors, x, bounds=bounds, x_scale=scale).x
    # A copy, since the velocities beside it are not wanted: all combinations are kept until the report.
    position, error = np.ascontiguousarray(run(x)), errors(x)
    every = (np.abs(position - measured), setting.time[horizon.stamps], use)
    pieces = zip(*map(horizon.pieces, every), strict=True)
    e_disp = sum(float(np.trapezoid(size[judged], time[judged])) for size, time, judged in pieces)
    return Combination(
        radius=model.inertia_radius,
        eccentric=model.eccentric,
        level=level,
        reading=model.reading,
        level_angle=float(x[0]) if level else 0.0,
        friction_coefficient=float(x[-1]) if model.reading else 0.0,
        max_error=float(np.max(np.abs(error))),
        rms_error=rms(error),
        e_disp=e_disp,
        position=position,
    )
