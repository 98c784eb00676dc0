"""What resists the ball: drag, and the set-valued frictions that hold it at rest."""

from __future__ import annotations

from analytic import slots
from analytic.effects.effect import Effect, Relations, adding
from analytic.effects.parameter import Parameter
from analytic.effects.source_code import Code
from analytic.effects.track import LEVEL_ERROR
from analytic.rig import Rig

# A friction that acts wherever the ball is, however it lies and whenever, is a curve of any of these.
_OF_VELOCITY = (("velocity", False),)
_DRY = (("position", True), ("roll_angle", True), ("time", True))


STEEP = 0.05
"""A friction, as a share of the normal force, that holds a ball on a slope of 3°: where one rolls it is implausible."""
# as in the kernel: a friction that falls with the velocity
_STRIBECK = (
    "{kinetic_coefficient} + fmax({static_coefficient} - {kinetic_coefficient}, 0.0)"
    " * exp(-(v / {stribeck_velocity}) * (v / {stribeck_velocity}))"
)
_USUAL = 0.002  # a friction of usual size, as a share of the normal force [1]
_SLOW = 0.1  # a drag is implausible if it lets the ball roll no faster down that slope [m/s]
_GIVES = (3e-4, 3e-5, 3e-6)  # by how much a usual friction gives way before it holds, where fits begin [m]
_RIGID = 3e-7  # what gives way by less is rigid for any sensor of the position [m]


def _stiffness(give: float, rig: Rig) -> float:
    """Stiffness of the presliding [N/m] with which a friction of usual size gives way by `give` [m]."""
    return _USUAL * rig.mass * rig.gravity / give


def _coefficient(name: str, start: float, typical: float = 0.003) -> Parameter:
    """A coefficient of resistance to rolling; with the greatest the ball would stand on a slope of 27°."""
    return Parameter(name, "1", 0.0, 0.5, typical, starts=(start,), strength=True, usual=(0.0, STEEP))


VISCOUS_DAMPING = Effect(
    "viscous_damping",
    "F = −c ṡ",
    (
        Parameter(
            "coefficient",
            "N s/m",
            0.0,
            10.0,
            0.02,
            starts=(0.006,),
            strength=True,
            usual=lambda rig: (0.0, STEEP * rig.mass * rig.gravity / _SLOW),
        ),
    ),
    "Stokes, Trans. Cambridge Phil. Soc. 9, 1851",
    write=adding(lambda k, rig, v: {slots.VISCOUS: k * v["coefficient"] / rig.mass}),
    code=Code(force="-({coefficient} / MASS * v)"),
    phrase="a viscous damping of {coefficient}",
    relations=Relations(common=True, nested_in=_OF_VELOCITY),
)
QUADRATIC_DRAG = Effect(
    "quadratic_drag",
    "F = −c |ṡ| ṡ",
    (
        Parameter(
            "coefficient",
            "N s²/m²",
            0.0,
            100.0,
            0.1,
            starts=(0.03,),
            strength=True,
            usual=lambda rig: (0.0, STEEP * rig.mass * rig.gravity / _SLOW**2),
        ),
    ),
    "Rayleigh, Phil. Mag. 2, 1876",
    write=adding(lambda k, rig, v: {slots.QUADRATIC: k * v["coefficient"] / rig.mass}),
    code=Code(force="-({coefficient} / MASS * fabs(v) * v)"),
    phrase="a quadratic drag of {coefficient}",
    relations=Relations(nested_in=_OF_VELOCITY),
)
ROLLING_RESISTANCE = Effect(
    "rolling_resistance",
    "|F| ≤ c N against rolling, set-valued",
    (_coefficient("coefficient", 0.0009),),
    "Johnson, Contact Mechanics, 1985, section 9.1",
    write=adding(lambda k, rig, v: {slots.DRY_PLUS: v["coefficient"], slots.DRY_MINUS: v["coefficient"]}),
    dry=True,
    code=Code(dry=("{coefficient}", "{coefficient}")),
    phrase="a rolling resistance of {coefficient}",
    relations=Relations(common=True, nested_in=_DRY),
)
DIRECTIONAL_RESISTANCE = Effect(
    "directional_resistance",
    "|F| ≤ c₊ N or c₋ N, by the direction of rolling",
    (_coefficient("coefficient_plus", 0.001), _coefficient("coefficient_minus", 0.001)),
    "as rolling resistance, on a surface with a lay",
    write=adding(lambda k, rig, v: {slots.DRY_PLUS: v["coefficient_plus"], slots.DRY_MINUS: v["coefficient_minus"]}),
    dry=True,
    code=Code(dry=("{coefficient_plus}", "{coefficient_minus}")),
    phrase="a rolling resistance of {coefficient_plus} towards +s, {coefficient_minus} towards −s",
    # on a beam that is not level a resistance differs by direction
    relations=Relations(nested_in=_DRY, splits_into=(ROLLING_RESISTANCE, LEVEL_ERROR)),
)
STRIBECK_FRICTION = Effect(
    "stribeck_friction",
    "|F| ≤ c(ṡ) N, c = c_k + (c_s − c_k) exp(−(ṡ/v_s)²)",
    (
        _coefficient("static_coefficient", 0.004, typical=0.005),
        _coefficient("kinetic_coefficient", 0.002),
        # faster than any ball on the beam a friction is constant
        Parameter("stribeck_velocity", "m/s", 1e-4, 1.0, 0.02, starts=(0.01, 0.05), shown=("mm/s", 1e3)),
    ),
    "Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30, 1994",
    write=adding(
        lambda k, rig, v: {
            slots.DRY_PLUS: v["kinetic_coefficient"],
            slots.DRY_MINUS: v["kinetic_coefficient"],
            # A friction that falls with the velocity is Stribeck's; without that it is the kinetic one alone.
            slots.DRY_STATIC: max(v["static_coefficient"] - v["kinetic_coefficient"], 0.0),
            slots.STRIBECK_VELOCITY: v["stribeck_velocity"],
        }
    ),
    dry=True,
    code=Code(dry=(_STRIBECK, _STRIBECK), falling=True),
    phrase="a Stribeck friction that falls from {static_coefficient} at rest to {kinetic_coefficient}, "
    "within {stribeck_velocity},",
    # friction that grows with speed from what it is at rest is resistance and drag
    relations=Relations(once=True, nested_in=_DRY, splits_into=(ROLLING_RESISTANCE, QUADRATIC_DRAG)),
)
PRESLIDING_HYSTERESIS = Effect(
    "presliding_hysteresis",
    "dF/ds = −σ (1 + F sign(ṡ)/(c N)): elastic micro-displacement before rolling",
    (
        _coefficient("coefficient", _USUAL),
        # a softer spring than 0.1 N/m gives way by the length of the beam before it holds anything
        Parameter(
            "stiffness",
            "N/m",
            0.1,
            1e5,
            20.0,
            starts=lambda visited, rig: [_stiffness(give, rig) for give in _GIVES],
            fitted=lambda visited, rig: (0.1, min(max(_stiffness(_RIGID, rig), 1.0), 1e5)),
        ),
    ),
    "Dahl, A Solid Friction Model, 1968",
    write=adding(lambda k, rig, v: {slots.DAHL: v["coefficient"], slots.DAHL_STIFFNESS: k * v["stiffness"] / rig.mass}),
    code=Code(inner="dahl"),
    phrase="a rolling resistance of {coefficient} with an elastic presliding of {stiffness}",
    relations=Relations(once=True, nested_in=_DRY),
)

RESISTANCES = (
    VISCOUS_DAMPING,
    QUADRATIC_DRAG,
    ROLLING_RESISTANCE,
    DIRECTIONAL_RESISTANCE,
    STRIBECK_FRICTION,
    PRESLIDING_HYSTERESIS,
)
