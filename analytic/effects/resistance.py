"""What resists the ball: drag, and the set-valued frictions that hold it at rest."""

from __future__ import annotations

from analytic.effects.effect import Effect, Relations, TrialSize
from analytic.effects.force import Values
from analytic.effects.parameter import Parameter
from analytic.effects.track import LEVEL_ERROR
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


# A friction that acts wherever the ball is, however it lies and whenever, is a curve of any of these.
_OF_VELOCITY = (("velocity", False),)
_DRY = (("position", True), ("roll_angle", True), ("time", True))
_MOST = 0.5  # coefficient of a resistance to rolling [1]: the ball would stand on a slope of 27°

VISCOUS_DAMPING = Effect(
    "viscous_damping",
    "F = −c ṡ",
    (Parameter("coefficient", "N s/m", 0.0, 10.0, 0.02, starts=(0.006,), strength=True),),
    "Stokes, Trans. Cambridge Phil. Soc. 9, 1851",
    write=_viscous,
    phrase="a viscous damping of {coefficient}",
    relations=Relations(nested_in=_OF_VELOCITY),
    trial=TrialSize({"coefficient": 0.03}),
)
QUADRATIC_DRAG = Effect(
    "quadratic_drag",
    "F = −c |ṡ| ṡ",
    (Parameter("coefficient", "N s²/m²", 0.0, 100.0, 0.1, starts=(0.03,), strength=True),),
    "Rayleigh, Phil. Mag. 2, 1876",
    write=_quadratic,
    phrase="a quadratic drag of {coefficient}",
    relations=Relations(nested_in=_OF_VELOCITY),
    trial=TrialSize({"coefficient": 0.2}),
)
ROLLING_RESISTANCE = Effect(
    "rolling_resistance",
    "|F| ≤ c N against rolling, set-valued",
    (Parameter("coefficient", "1", 0.0, _MOST, 0.003, starts=(0.0009,), strength=True),),
    "Johnson, Contact Mechanics, 1985, section 9.1",
    write=_rolling,
    dry=True,
    phrase="a rolling resistance of {coefficient}",
    relations=Relations(nested_in=_DRY),
    trial=TrialSize({"coefficient": 0.004}),
)
DIRECTIONAL_RESISTANCE = Effect(
    "directional_resistance",
    "|F| ≤ c₊ N or c₋ N, by the direction of rolling",
    (
        Parameter("coefficient_plus", "1", 0.0, _MOST, 0.003, starts=(0.001,), strength=True),
        Parameter("coefficient_minus", "1", 0.0, _MOST, 0.003, starts=(0.001,), strength=True),
    ),
    "as rolling resistance, on a surface with a lay",
    write=_directional,
    dry=True,
    phrase="a rolling resistance of {coefficient_plus} towards +s, {coefficient_minus} towards −s",
    # on a beam that is not level a resistance differs by direction
    relations=Relations(nested_in=_DRY, splits_into=(ROLLING_RESISTANCE, LEVEL_ERROR)),
    trial=TrialSize({"coefficient_plus": 0.002, "coefficient_minus": 0.005}),
)
STRIBECK_FRICTION = Effect(
    "stribeck_friction",
    "|F| ≤ c(ṡ) N, c = c_k + (c_s − c_k) exp(−(ṡ/v_s)²)",
    (
        Parameter("static_coefficient", "1", 0.0, _MOST, 0.005, starts=(0.004,), strength=True),
        Parameter("kinetic_coefficient", "1", 0.0, _MOST, 0.003, starts=(0.002,), strength=True),
        # faster than any ball on the beam a friction is constant
        Parameter("stribeck_velocity", "m/s", 1e-4, 1.0, 0.02, starts=(0.01, 0.05), shown=("mm/s", 1e3)),
    ),
    "Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30, 1994",
    write=_stribeck,
    dry=True,
    phrase="a Stribeck friction that falls from {static_coefficient} at rest to {kinetic_coefficient}, "
    "within {stribeck_velocity},",
    # friction that grows with speed from what it is at rest is resistance and drag
    relations=Relations(once=True, nested_in=_DRY, splits_into=(ROLLING_RESISTANCE, QUADRATIC_DRAG)),
    trial=TrialSize(
        {"static_coefficient": 0.006, "kinetic_coefficient": 0.003}, fixed={"stribeck_velocity": (0.015, 0.03)}
    ),
)
PRESLIDING_HYSTERESIS = Effect(
    "presliding_hysteresis",
    "dF/ds = −σ (1 + F sign(ṡ)/(c N)): elastic micro-displacement before rolling",
    (
        Parameter("coefficient", "1", 0.0, _MOST, 0.003, starts=(0.002,), strength=True),
        # a softer spring than 0.1 N/m gives way by the length of the beam before it holds anything
        Parameter("stiffness", "N/m", 0.1, 1e5, 20.0, starts=(10.0, 100.0, 1000.0)),
    ),
    "Dahl, A Solid Friction Model, 1968",
    write=_presliding,
    phrase="a rolling resistance of {coefficient} with an elastic presliding of {stiffness}",
    relations=Relations(once=True, nested_in=_DRY),
    trial=TrialSize({"coefficient": 0.004}, fixed={"stiffness": (15.0, 50.0)}),
)

RESISTANCES = (
    VISCOUS_DAMPING,
    QUADRATIC_DRAG,
    ROLLING_RESISTANCE,
    DIRECTIONAL_RESISTANCE,
    STRIBECK_FRICTION,
    PRESLIDING_HYSTERESIS,
)
