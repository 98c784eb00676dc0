"""What resists the ball: drag, and the set-valued frictions that hold it at rest."""

from __future__ import annotations

from analytic.effects.effect import Effect, Parameter
from analytic.effects.force import Values
from analytic.models import (
    DAHL,
    DAHL_STIFFNESS,
    DRY_MINUS,
    DRY_PLUS,
    DRY_STATIC,
    QUADRATIC,
    RESPONSE,
    STRIBECK_VELOCITY,
    VISCOUS,
)
from analytic.motion import FloatArray
from analytic.rig import Rig


def _viscous(p: FloatArray, rig: Rig, values: Values) -> None:
    p[VISCOUS] += p[RESPONSE] * values["coefficient"] / rig.mass


def _quadratic(p: FloatArray, rig: Rig, values: Values) -> None:
    p[QUADRATIC] += p[RESPONSE] * values["coefficient"] / rig.mass


def _rolling(p: FloatArray, rig: Rig, values: Values) -> None:
    p[DRY_PLUS] += values["coefficient"]
    p[DRY_MINUS] += values["coefficient"]


def _directional(p: FloatArray, rig: Rig, values: Values) -> None:
    p[DRY_PLUS] += values["coefficient_plus"]
    p[DRY_MINUS] += values["coefficient_minus"]


def _stribeck(p: FloatArray, rig: Rig, values: Values) -> None:
    p[DRY_PLUS] += values["kinetic_coefficient"]
    p[DRY_MINUS] += values["kinetic_coefficient"]
    p[DRY_STATIC] = values["static_coefficient"] - values["kinetic_coefficient"]
    p[STRIBECK_VELOCITY] = values["stribeck_velocity"]


def _presliding(p: FloatArray, rig: Rig, values: Values) -> None:
    p[DAHL] = values["coefficient"]
    p[DAHL_STIFFNESS] = p[RESPONSE] * values["stiffness"] / rig.mass


RESISTANCES = (
    Effect(
        "viscous_damping",
        "F = −c ṡ",
        (Parameter("coefficient", "N s/m", 0.0, 10.0, 0.02),),
        "Stokes, Trans. Cambridge Phil. Soc. 9, 1851",
        _viscous,
    ),
    Effect(
        "quadratic_drag",
        "F = −c |ṡ| ṡ",
        (Parameter("coefficient", "N s²/m²", 0.0, 100.0, 0.1),),
        "Rayleigh, Phil. Mag. 2, 1876",
        _quadratic,
    ),
    Effect(
        "rolling_resistance",
        "|F| ≤ c N against rolling, set-valued",
        (Parameter("coefficient", "1", 0.0, 0.5, 0.003),),
        "Johnson, Contact Mechanics, 1985, section 9.1",
        _rolling,
        dry=True,
    ),
    Effect(
        "directional_resistance",
        "|F| ≤ c₊ N or c₋ N, by the direction of rolling",
        (Parameter("coefficient_plus", "1", 0.0, 0.5, 0.003), Parameter("coefficient_minus", "1", 0.0, 0.5, 0.003)),
        "as rolling resistance, on a surface with a lay",
        _directional,
        dry=True,
    ),
    Effect(
        "stribeck_friction",
        "|F| ≤ c(ṡ) N, c = c_k + (c_s − c_k) exp(−(ṡ/v_s)²)",
        (
            Parameter("static_coefficient", "1", 0.0, 0.5, 0.005),
            Parameter("kinetic_coefficient", "1", 0.0, 0.5, 0.003),
            Parameter("stribeck_velocity", "m/s", 1e-4, 1.0, 0.02),
        ),
        "Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30, 1994",
        _stribeck,
        dry=True,
    ),
    Effect(
        "presliding_hysteresis",
        "dF/ds = −σ (1 + F sign(ṡ)/(c N)): elastic micro-displacement before rolling",
        (Parameter("coefficient", "1", 0.0, 0.5, 0.003), Parameter("stiffness", "N/m", 0.1, 1e5, 20.0)),
        "Dahl, A Solid Friction Model, 1968",
        _presliding,
    ),
)
