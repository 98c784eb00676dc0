"""Parameters of MuJoCo that have a meaning in any scene; what is not set stays as the scene has it."""

from __future__ import annotations

from typing import Literal

import mujoco
import numpy as np
from pydantic import Field

from harness.engines.mujoco_parameters import MAX_IMPEDANCE, MIN_FRICTION, MIN_IMPEDANCE
from harness.engines.parameters import EngineParameters


class MuJoCoSceneParameters(EngineParameters):
    """Of a user's scene, under the names that the built-in scene has for them."""

    friction: float | None = Field(
        None, ge=MIN_FRICTION, le=10.0, description="sliding friction coefficient of ball and beam [1]"
    )
    torsional_friction: float | None = Field(None, ge=0.0, le=0.1, description="friction against spinning [m]")
    rolling_friction: float | None = Field(None, ge=0.0, le=0.1, description="friction against rolling [m]")
    condim: Literal[1, 3, 4, 6] | None = Field(None, description="contact dimension of ball and beam")
    solref_timeconst: float | None = Field(None, gt=0.0, le=1.0, description="time constant of the contact [s]")
    solref_dampratio: float | None = Field(None, gt=0.0, le=100.0, description="damping ratio of the contact [1]")
    solimp_dmin: float | None = Field(
        None, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance of the contact at zero penetration [1]"
    )
    solimp_dmax: float | None = Field(
        None, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance at and beyond the width [1]"
    )
    solimp_width: float | None = Field(None, gt=0.0, le=0.1, description="depth over which the impedance changes [m]")
    impratio: float | None = Field(None, gt=0.0, le=1e6, description="frictional over normal impedance [1]")
    cone: Literal["elliptic", "pyramidal"] | None = Field(None, description="friction cone")
    solver: Literal["Newton", "CG", "PGS"] | None = Field(None, description="constraint solver")
    iterations: int | None = Field(None, ge=1, le=10_000, description="maximum solver iterations per step [1]")

    def apply(self, model: mujoco.MjModel, geoms: list[int], pairs: list[int]) -> None:
        """Write what is set into a model.

        Args:
            model: changed in place.
            geoms: of ball and beam; a contact mixes the values of both.
            pairs: explicit pairs of them, which have values of their own.
        """
        kinds = {"elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC, "pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL}
        solvers = {
            "Newton": mujoco.mjtSolver.mjSOL_NEWTON,
            "CG": mujoco.mjtSolver.mjSOL_CG,
            "PGS": mujoco.mjtSolver.mjSOL_PGS,
        }
        option = model.opt
        option.timestep = self.time_step
        if self.impratio is not None:
            option.impratio = self.impratio
        if self.cone is not None:
            option.cone = kinds[self.cone]
        if self.solver is not None:
            option.solver = solvers[self.solver]
        option.iterations = self.iterations or max(option.iterations, 50)
        for place, value in enumerate((self.friction, self.torsional_friction, self.rolling_friction)):
            if value is not None:
                _set(model.geom_friction, geoms, [place], value)
                _set(model.pair_friction, pairs, ([0, 1], [2], [3, 4])[place], value)
        for place, value in enumerate((self.solref_timeconst, self.solref_dampratio)):
            if value is not None:
                _set(model.geom_solref, geoms, [place], value)
                _set(model.pair_solref, pairs, [place], value)
        for place, value in enumerate((self.solimp_dmin, self.solimp_dmax, self.solimp_width)):
            if value is not None:
                _set(model.geom_solimp, geoms, [place], value)
                _set(model.pair_solimp, pairs, [place], value)
        if self.condim is not None:
            model.geom_condim[geoms] = self.condim
            model.pair_dim[pairs] = self.condim


def _set(table: np.ndarray, rows: list[int], columns: list[int], value: float) -> None:
    if rows:
        table[np.ix_(rows, columns)] = value
