"""What the ball itself may lack: balance, the declared rolling radius, grip; and the pivot that CUM leaves out."""

from __future__ import annotations

from analytic import slots
from analytic.effects.effect import Effect, EngineEntry, Relations, adding
from analytic.effects.force import Values
from analytic.effects.parameter import Parameter
from analytic.effects.source_code import Code
from analytic.motion import FloatArray
from analytic.rig import Rig


def _pivot(p: FloatArray, rig: Rig, values: Values) -> None:
    r = rig.rolling_radius
    p[slots.ECCENTRIC] = p[slots.RESPONSE] * (values["eccentricity"] + r + rig.inertia / (rig.mass * r))


BALL_IMBALANCE = Effect(
    "ball_imbalance",
    "torque m g e sin(φ + φ₀), φ the rolled angle, φ₀ free per recording",
    # an offset to the other side is a φ₀ half a turn away
    (Parameter("offset", "m", 0.0, 0.01, 5e-5, starts=(2e-5,), strength=True, shown=("µm", 1e6)),),
    "statics of a ball whose centre of mass lies e off its centre",
    write=adding(lambda k, rig, v: {slots.IMBALANCE: k * rig.gravity * v["offset"] / rig.rolling_radius}),
    turning=True,
    code=Code(force="GRAVITY * {offset} / ROLLING_RADIUS * sin(phi)"),
    phrase="a ball out of balance by {offset}",
    relations=Relations(once=True, nested_in=(("roll_angle", False),)),
)
ROLLING_RADIUS = Effect(
    "rolling_radius",
    "r differs from the declared one",
    (
        Parameter(
            "radius",
            "m",
            1e-4,
            1.0,
            0.011,
            neutral=lambda rig: rig.rolling_radius,
            # a ball cannot roll on more than its radius, nor deep in a groove that it falls through
            fitted=lambda visited, rig: (0.2 * rig.radius, rig.radius),
            shown=("mm", 1e3),
        ),
    ),
    "the paper, eq. 14",
    alter=lambda rig, values: rig.with_(rolling_radius=values["radius"]),
    phrase="a rolling radius of {radius} instead of {declared}",
    relations=Relations(once=True, hidden_by=("ratio",)),
)
CONTACT_SLIP = Effect(
    "contact_slip",
    "|F_t| ≤ μ N R/r; beyond it the ball slides and φ is a state of its own",
    # no value does nothing on every rig: where the ball grips depends on how the beam moves
    (Parameter("friction_coefficient", "1", 0.0, 2.0, 0.03, starts=(0.004, 0.008, 0.015, 0.03)),),
    "Coulomb, 1785; two contacts that lean carry N R/r together",
    write=adding(lambda k, rig, v: {slots.TRACTION: v["friction_coefficient"] * rig.radius / rig.rolling_radius}),
    code=Code(inner="slip"),
    phrase="a slip of the ball at a friction coefficient of {friction_coefficient}",
    relations=Relations(once=True),
    engine=EngineEntry(
        "the engine's own friction coefficient",
        # with limits that let the ball slide (see `harness run --help`)
        {
            "mujoco": lambda v: {
                "friction": v["friction_coefficient"],
                "friction_relaxation": 0.01,
                "slip_limit": 10.0,
            },
            "pybullet": lambda v: {
                "lateral_friction_ball": v["friction_coefficient"],
                "lateral_friction_rail": 1.0,
                "slip_limit": 10.0,
            },
        },
    ),
)
ECCENTRIC_PIVOT = Effect(
    "eccentric_pivot",
    "adds the α̈ term to CUM: −(h + r + J/(m r)) α̈",
    (
        Parameter(
            "eccentricity", "m", -1.0, 1.0, 0.035, starts=lambda visited, rig: [rig.eccentricity], shown=("mm", 1e3)
        ),
    ),
    "the paper, eq. 14 against eq. 3",
    write=_pivot,
    code=Code(lever="{eccentricity} + ROLLING_RADIUS + INERTIA / (MASS * ROLLING_RADIUS)"),
    phrase="a pivot eccentricity of {eccentricity}",
    relations=Relations(once=True, stands_for="lever", in_baseline=lambda model: model.eccentric),
)

BALL = (BALL_IMBALANCE, ROLLING_RADIUS, CONTACT_SLIP, ECCENTRIC_PIVOT)
