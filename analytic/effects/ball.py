"""What the ball itself may lack: balance, the declared rolling radius, grip; and the pivot that CUM leaves out."""

from __future__ import annotations

from analytic.effects.effect import Effect, Parameter
from analytic.effects.force import Values
from analytic.models import ECCENTRIC, IMBALANCE, PHASE, RESPONSE, TRACTION
from analytic.motion import FloatArray
from analytic.rig import Rig


def _imbalance(p: FloatArray, rig: Rig, values: Values) -> None:
    p[IMBALANCE] = p[RESPONSE] * rig.gravity * values["offset"] / rig.rolling_radius
    p[PHASE] = values.get("phase", 0.0)


def _radius(rig: Rig, values: Values) -> Rig:
    return rig.with_(rolling_radius=values["radius"])


def _slip(p: FloatArray, rig: Rig, values: Values) -> None:
    p[TRACTION] = values["friction_coefficient"] * rig.radius / rig.rolling_radius


def _pivot(p: FloatArray, rig: Rig, values: Values) -> None:
    r = rig.rolling_radius
    p[ECCENTRIC] = p[RESPONSE] * (values["eccentricity"] + r + rig.inertia / (rig.mass * r))


BALL = (
    Effect(
        "ball_imbalance",
        "torque m g e sin(φ + φ₀), φ the rolled angle, φ₀ free per recording",
        (Parameter("offset", "m", 0.0, 0.01, 5e-5),),
        "statics of a ball whose centre of mass lies e off its centre",
        _imbalance,
    ),
    Effect(
        "rolling_radius",
        "r differs from the declared one",
        (Parameter("radius", "m", 1e-4, 1.0, 0.011),),
        "the paper, eq. 14",
        alter=_radius,
    ),
    Effect(
        "contact_slip",
        "|F_t| ≤ μ N R/r; beyond it the ball slides and φ is a state of its own",
        (Parameter("friction_coefficient", "1", 0.0, 2.0, 0.03),),
        "Coulomb, 1785; two contacts that lean carry N R/r together",
        _slip,
    ),
    Effect(
        "eccentric_pivot",
        "adds the α̈ term to CUM: −(h + r + J/(m r)) α̈",
        (Parameter("eccentricity", "m", -1.0, 1.0, 0.035),),
        "the paper, eq. 14 against eq. 3",
        _pivot,
    ),
)
