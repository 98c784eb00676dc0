"""What can act in the virtual rig, by name.

The catalogue's effects have names, parameters and bounds from there (`analytic.effects`) and laws of the plant's own;
`UNLISTED` holds structures that no catalogue of a model under test has, each with the quantities it depends on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from analytic.effects import (
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_NONLINEARITY,
    ANGLE_SERVO,
    CATALOGUE,
    CONTACT_SLIP,
    ECCENTRIC_PIVOT,
    LEVEL_DRIFT,
    LEVEL_ERROR,
    LEVEL_PER_RECORDING,
    ROLLING_RESISTANCE,
    STRIBECK_FRICTION,
    Acting,
    EffectError,
    acting,
)
from analytic.effects.catalogue import check_values
from analytic.effects.parameter import Limits
from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.simulator.laws import Laws

Effects = Mapping[str, Mapping[str, float]]
"""What acts: name -> values of its parameters (SI)."""

DEPENDENCES = ("position", "velocity", "angle", "roll_angle", "time")


@dataclass(frozen=True)
class Entry:
    """One structure that no catalogue has.

    Attributes:
        law: one line; c, F, s_c … are the parameters.
        parameters: by name, in the order of the law.
        depends_on: on what, strongest first.
    """

    law: str
    parameters: Mapping[str, Limits]
    depends_on: tuple[str, ...]


_NUMBER = Limits("1", 0.0, 1.0)
_PLACE = Limits("m", -10.0, 10.0)
_LENGTH = Limits("m", 1e-3, 10.0)
_FORCE = Limits("N", -1.0, 1.0)
_INSTANT = Limits("s", -1e6, 1e6)

UNLISTED: Mapping[str, Entry] = {
    "gust": Entry("F from one instant to another", {"force": _FORCE, "start": _INSTANT, "end": _INSTANT}, ("time",)),
    "settling_force": Entry("F (1 − exp(−t/τ))", {"force": _FORCE, "time_constant": Limits("s", 1e-2, 1e6)}, ("time",)),
    "fading_resistance": Entry(
        "|F| <= c exp(−t/τ) N against rolling, set-valued",
        {"coefficient": _NUMBER, "time_constant": Limits("s", 1e-2, 1e6)},
        ("time", "velocity"),
    ),
    "rough_patch": Entry(
        "|F| <= c N against rolling between two places with edges of 2 mm, set-valued",
        {"coefficient": _NUMBER, "start": _PLACE, "end": _PLACE},
        ("position", "velocity"),
    ),
    "force_hill": Entry(
        "F sin²(π (s − s₁)/(s₂ − s₁)) between two places",
        {"force": _FORCE, "start": _PLACE, "end": _PLACE},
        ("position",),
    ),
    "ripple_force": Entry("F sin(2π s/λ)", {"force": _FORCE, "wavelength": Limits("m", 1e-3, 10.0)}, ("position",)),
    "magnet": Entry(
        "pull of a dipole beside the track at s_c, distance d, at most F; F < 0 repels",
        {"force": _FORCE, "centre": _PLACE, "distance": _LENGTH},
        ("position",),
    ),
    "cubic_spring": Entry(
        "F = −k (s − s_c)³", {"stiffness": Limits("N/m³", -1e3, 1e3), "centre": _PLACE}, ("position",)
    ),
    "cubic_drag": Entry("F = −c ṡ³", {"coefficient": Limits("N s³/m³", 0.0, 1e3)}, ("velocity",)),
    "cable_pull": Entry("F sin(p α)", {"force": _FORCE, "frequency": Limits("1/rad", 0.0, 1e3)}, ("angle",)),
    "sticky_spot": Entry(
        "|F| <= c exp((cos(φ + φ₀) − 1)/w²) N against rolling, set-valued, φ₀ free per recording",
        {"coefficient": _NUMBER, "width": Limits("rad", 0.05, 10.0)},
        ("roll_angle", "velocity"),
    ),
    "out_of_round": Entry(
        "torque T sin 2(φ + φ₀), φ₀ free per recording", {"torque": Limits("N m", -1e-3, 1e-3)}, ("roll_angle",)
    ),
}

_ORDERED = {
    "gust": ("start", "end"),
    "rough_patch": ("start", "end"),
    "force_hill": ("start", "end"),
    STRIBECK_FRICTION.name: ("kinetic_coefficient", "static_coefficient"),
}
"""Parameters of which the first may not exceed the second."""
_OF_THE_PLANT = (
    LEVEL_ERROR,
    ECCENTRIC_PIVOT,
    ROLLING_RESISTANCE,
    CONTACT_SLIP,
    ANGLE_NONLINEARITY,
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_SERVO,
    LEVEL_DRIFT,
    LEVEL_PER_RECORDING,
)
"""What is no field of `Laws` but of `Plant`."""


def checked(effects: Effects) -> dict[str, dict[str, float]]:
    """The same effects, their values as floats, after a check of names and values.

    Raises:
        InputError: unknown effect or parameter, a missing parameter, or a value that cannot be.
    """
    result: dict[str, dict[str, float]] = {}
    for name, values in effects.items():
        try:
            if name in UNLISTED:  # also where an effect of a user's own is called like one: the plant's law is its own
                check_values(name, UNLISTED[name].parameters, values)
            elif name in CATALOGUE:
                _refuse_without_law(acting(name, values))
            else:
                known = (*CATALOGUE, *UNLISTED)
                raise InputError(
                    f"the virtual rig has no effect {name!r}.{did_you_mean(name, known)} There are: {', '.join(known)}."
                )
        except EffectError as error:
            raise InputError(str(error)) from error
        low, high = _ORDERED.get(name, (None, None))
        if low is not None and high is not None and values[low] > values[high]:
            raise InputError(f"{name}: {low} is {values[low]:g}, more than {high} = {values[high]:g}; exchange them.")
        result[name] = {key: float(value) for key, value in values.items()}
    return result


def listed(effects: Effects) -> tuple[Acting, ...]:
    """Those of `effects` (already checked) that are the catalogue's and no unlisted structure."""
    return tuple(Acting(CATALOGUE[name], values) for name, values in effects.items() if name not in UNLISTED)


def _refuse_without_law(one: Acting) -> None:
    """Refuse an effect that is described only by what it does to the model's equation or to a given motion."""
    own = one.effect in _OF_THE_PLANT or all(f"{one.effect.name}_{name}" in Laws._fields for name in one.values)
    if not own and (any((one.effect.write, one.effect.turn, one.effect.tilting))):
        raise EffectError(
            f"the virtual rig has no law of its own for {one.effect.name}; of others it takes forces, and "
            "changes of the rig, the transmission or the sensor."
        )
