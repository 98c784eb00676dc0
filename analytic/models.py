"""The paper's models of the ball on the beam, as one family whose members differ in named choices.

All members are the equation of motion along the beam, divided by the ball's mass m,

    (1 + J/(m ρ²)) s̈ = g sin(α + α₀) + s α̇² − (h + r + J/(m r)) α̈ − F_f/m,

and differ in the radius ρ of the inertia term, in which of the terms they keep, and in the friction force F_f:

| model       | paper       | ρ | s α̇² | α̈   | gravity | friction |
|-------------|-------------|---|-------|------|---------|----------|
| CUM         | eq. 3, 18   | R | yes   | no   | sin α   | none     |
| linear CUM  | eq. 4       | R | no    | no   | α       | none     |
| CAM         | eq. 14, 19  | r | yes   | yes  | sin α   | none     |
| friction    | eq. 15–17   | r | no    | no   | sin α   | F_f      |

Four defects of the printed equations are resolved as follows (see docs/models.md and tests/analytic):

* sign — gravity is taken so that α > 0 accelerates towards +s, in every model;
* radius — eq. 16 prints J/r², its solution eq. 17 J/R²; `inertia_radius` chooses, with eq. 16 as the default;
* law and unit — eq. 15 admits four readings, see `Reading`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Literal

import numpy as np

from analytic import slots
from analytic.motion import FloatArray
from analytic.rig import Rig


class Reading(IntEnum):
    """The possible readings of eq. 15, F_f = f_b · tanh(ṡ/v_t) · m g cos α · ṡ."""

    NONE = 0
    PRINTED = 1  # as printed: even in ṡ, hence it drives the ball when ṡ < 0; f_b in s/m
    PRINTED_DISSIPATIVE = 2  # with |tanh|: dissipates in both directions; f_b in s/m
    COULOMB = 3  # F_f = f_b m g cos α tanh(ṡ/v_t); f_b a number
    VISCOUS = 4  # F_f = f_b ṡ; f_b in N s/m, the unit the paper prints

    @property
    def dissipates(self) -> bool:
        """Whether F_f ṡ >= 0 for every ṡ, given f_b >= 0 and a beam short of the vertical."""
        return self is not Reading.PRINTED

    @property
    def unit(self) -> str:
        """The unit f_b must have for F_f to be a force."""
        return ("", "s/m", "s/m", "1", "N s/m")[self]

    @property
    def consistent_with_print(self) -> bool:
        """Whether the unit printed for f_b, N s/m, makes F_f a force."""
        return self is Reading.VISCOUS


@dataclass(frozen=True)
class Model:
    """One member of the family.

    Attributes:
        name: as in results.
        equation: its number in the paper.
        inertia_radius: ρ of s̈'s factor, the ball's radius "R" or the rolling radius "r"; the α̈ term always has r.
        centrifugal: whether it has s α̇².
        eccentric: whether it has the α̈ term.
        linear: sin α → α.
        reading: friction force.
    """

    name: str
    equation: str
    inertia_radius: Literal["R", "r"]
    centrifugal: bool = True
    eccentric: bool = False
    linear: bool = False
    reading: Reading = Reading.NONE

    def variant(self, name: str, **changes: object) -> Model:
        """The same model with some choices changed, under another name.

        Raises:
            TypeError: there is no such choice.
        """
        return replace(self, name=name, **changes)  # type: ignore[arg-type]


CUM = Model("cum", "eq. 3, 18", "R")
CUM_LINEAR = Model("cum_linear", "eq. 4", "R", centrifugal=False, linear=True)
CAM = Model("cam", "eq. 14, 19", "r", eccentric=True)
FRICTION = {
    reading: Model(f"friction_{reading.name.lower()}", "eq. 15–17", "r", centrifugal=False, reading=reading)
    for reading in (Reading.PRINTED, Reading.PRINTED_DISSIPATIVE, Reading.COULOMB, Reading.VISCOUS)
}
MODELS = {model.name: model for model in (CUM, CUM_LINEAR, CAM, *FRICTION.values())}


def coefficients(model: Model, rig: Rig) -> FloatArray:
    """The kernel's parameter vector of `model` on `rig`, shape (SLOTS,).

    With k = 1/(1 + J/(m ρ²)) it holds k g [m/s²], k or 0 [1], k (h + r + J/(m r)) or 0 [m], α₀ [rad], a flag for
    sin α → α, the reading, the friction's gain (k f_b g, or k f_b/m for the viscous reading) and v_t [m/s]; then k,
    h + r, g, 1/r and r. No effect acts yet.
    """
    rho = rig.radius if model.inertia_radius == "R" else rig.rolling_radius
    k = 1.0 / (1.0 + rig.inertia / (rig.mass * rho**2))
    friction = 0.0
    if model.reading is Reading.VISCOUS:
        friction = k * rig.friction_coefficient / rig.mass
    elif model.reading is not Reading.NONE:
        friction = k * rig.friction_coefficient * rig.gravity
    vector = np.zeros(slots.SLOTS)
    vector[slots.GRAVITY] = k * rig.gravity
    vector[slots.CENTRIFUGAL] = k if model.centrifugal else 0.0
    vector[slots.ECCENTRIC] = k * rig.lever if model.eccentric else 0.0
    vector[slots.LEVEL] = rig.level_angle
    vector[slots.LINEAR] = float(model.linear)
    vector[slots.READING] = float(model.reading)
    vector[slots.FRICTION_GAIN] = friction
    vector[slots.TRANSITION] = rig.transition_velocity
    vector[slots.RESPONSE] = k
    vector[slots.HEIGHT] = rig.eccentricity + rig.rolling_radius
    vector[slots.WEIGHT] = rig.gravity
    vector[slots.ROLL] = 1.0 / rig.rolling_radius
    vector[slots.TURN] = rig.rolling_radius
    return vector
