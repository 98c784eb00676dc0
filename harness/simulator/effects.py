"""What can act in the virtual rig, by name: the parameters of every effect, their units and bounds.

The names, laws and parameters of `CATALOGUE` are a public contract; `UNLISTED` holds structures that no catalogue of a
model under test has, each with the quantities it depends on.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass

from harness.errors import InputError

Effects = Mapping[str, Mapping[str, float]]
"""What acts: name -> values of its parameters (SI)."""

DEPENDENCES = ("position", "velocity", "angle", "roll_angle", "time")


@dataclass(frozen=True)
class Bounds:
    """Unit and bounds, both included, of one parameter."""

    unit: str
    low: float
    high: float


@dataclass(frozen=True)
class Entry:
    """One effect.

    Attributes:
        law: one line; c, F, s_c … are the parameters.
        parameters: by name, in the order of the law.
        depends_on: what an unlisted force depends on, strongest first; empty for the catalogue's own.
    """

    law: str
    parameters: Mapping[str, Bounds]
    depends_on: tuple[str, ...] = ()


_NUMBER = Bounds("1", 0.0, 1.0)
_PLACE = Bounds("m", -10.0, 10.0)
_LENGTH = Bounds("m", 1e-3, 10.0)
_FORCE = Bounds("N", -1.0, 1.0)
_INSTANT = Bounds("s", -1e6, 1e6)

CATALOGUE: Mapping[str, Entry] = {
    "viscous_damping": Entry("F = −c ṡ", {"coefficient": Bounds("N s/m", 0.0, 10.0)}),
    "quadratic_drag": Entry("F = −c |ṡ| ṡ", {"coefficient": Bounds("N s²/m²", 0.0, 100.0)}),
    "rolling_resistance": Entry("|F| <= c N against rolling, set-valued", {"coefficient": _NUMBER}),
    "directional_resistance": Entry(
        "|F| <= c₊ N or c₋ N by the direction of rolling, set-valued",
        {"coefficient_plus": _NUMBER, "coefficient_minus": _NUMBER},
    ),
    "stribeck_friction": Entry(
        "|F| <= c N, c = c_k + (c_s − c_k) exp(−(ṡ/v_s)²), set-valued",
        {
            "static_coefficient": _NUMBER,
            "kinetic_coefficient": _NUMBER,
            "stribeck_velocity": Bounds("m/s", 1e-4, 10.0),
        },
    ),
    "level_error": Entry("gravity sees α + angle", {"angle": Bounds("rad", -0.2, 0.2)}),
    "track_curvature": Entry("tilt grows by κ (s_c − s)", {"curvature": Bounds("1/m", -1.0, 1.0), "centre": _PLACE}),
    "track_bump": Entry(
        "the descent of H exp(−½ ((s − s_c)/w)²) adds to the tilt",
        {"height": Bounds("m", -0.01, 0.01), "centre": _PLACE, "width": _LENGTH},
    ),
    "ball_imbalance": Entry("torque m g e sin(φ + φ₀), φ₀ free per recording", {"offset": Bounds("m", -0.005, 0.005)}),
    "rolling_radius": Entry("r differs from the declared one", {"radius": Bounds("m", 1e-4, 1.0)}),
    "contact_slip": Entry("|F_t| <= μ N R/r; beyond it the ball slides", {"friction_coefficient": _NUMBER}),
    "angle_gain": Entry("beam angle = gain × measured angle", {"gain": Bounds("1", 0.1, 10.0)}),
    "linkage_backlash": Entry(
        "play of total width b between measured angle and beam", {"width": Bounds("rad", 0, 0.2)}
    ),
    "beam_compliance": Entry("tilt grows by compliance × m g s", {"compliance": Bounds("rad/(N m)", -1.0, 1.0)}),
    "channel_delay": Entry("the position at t is recorded at t + delay", {"delay": Bounds("s", -1.0, 1.0)}),
    "position_gain": Entry("recorded position = gain × position", {"gain": Bounds("1", 0.1, 10.0)}),
    "position_lag": Entry("first-order lag of the position", {"time_constant": Bounds("s", 0.0, 5.0)}),
    "presliding_hysteresis": Entry(
        "F = −σ z, dz/dt = ṡ − |ṡ| z σ/(c N)",
        {"coefficient": _NUMBER, "stiffness": Bounds("N/m", 1e-2, 1e5)},
    ),
    "eccentric_pivot": Entry("the pivot lies h below the edges", {"eccentricity": Bounds("m", -1.0, 1.0)}),
}

UNLISTED: Mapping[str, Entry] = {
    "gust": Entry("F from one instant to another", {"force": _FORCE, "start": _INSTANT, "end": _INSTANT}, ("time",)),
    "drifting_force": Entry("F = q t", {"rate": Bounds("N/s", -0.1, 0.1)}, ("time",)),
    "fading_resistance": Entry(
        "|F| <= c exp(−t/τ) N against rolling, set-valued",
        {"coefficient": _NUMBER, "time_constant": Bounds("s", 1e-2, 1e6)},
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
    "magnet": Entry(
        "pull of a dipole beside the track at s_c, distance d, at most F; F < 0 repels",
        {"force": _FORCE, "centre": _PLACE, "distance": _LENGTH},
        ("position",),
    ),
    "cubic_spring": Entry(
        "F = −k (s − s_c)³", {"stiffness": Bounds("N/m³", -1e3, 1e3), "centre": _PLACE}, ("position",)
    ),
    "cubic_drag": Entry("F = −c ṡ³", {"coefficient": Bounds("N s³/m³", 0.0, 1e3)}, ("velocity",)),
    "cable_pull": Entry("F sin(p α)", {"force": _FORCE, "frequency": Bounds("1/rad", 0.0, 1e3)}, ("angle",)),
    "sticky_spot": Entry(
        "|F| <= c exp((cos(φ + φ₀) − 1)/w²) N against rolling, set-valued, φ₀ free per recording",
        {"coefficient": _NUMBER, "width": Bounds("rad", 0.05, 10.0)},
        ("roll_angle", "velocity"),
    ),
    "out_of_round": Entry(
        "torque T sin 2(φ + φ₀), φ₀ free per recording", {"torque": Bounds("N m", -1e-3, 1e-3)}, ("roll_angle",)
    ),
}

_ORDERED = {
    "gust": ("start", "end"),
    "rough_patch": ("start", "end"),
    "force_hill": ("start", "end"),
    "stribeck_friction": ("kinetic_coefficient", "static_coefficient"),
}
"""Parameters of which the first may not exceed the second."""


def checked(effects: Effects) -> dict[str, dict[str, float]]:
    """The same effects, their values as floats, after a check of names and values.

    Raises:
        InputError: unknown effect or parameter, a missing parameter, or a value that cannot be.
    """
    known = {**CATALOGUE, **UNLISTED}
    result: dict[str, dict[str, float]] = {}
    for name, values in effects.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            raise InputError(f"the virtual rig has no effect {name!r}.{hint} There are: {', '.join(known)}.")
        parameters = known[name].parameters
        if set(values) != set(parameters):
            raise InputError(
                f"{name} has the parameters {', '.join(parameters)}; given: {', '.join(values) or 'none'}."
            )
        for key, bounds in parameters.items():
            value = values[key]
            if not (math.isfinite(value) and bounds.low <= value <= bounds.high):
                raise InputError(
                    f"{name}: {key} is {value:g}; it must lie between {bounds.low:g} and {bounds.high:g} {bounds.unit}."
                )
        low, high = _ORDERED.get(name, (None, None))
        if low is not None and high is not None and values[low] > values[high]:
            raise InputError(f"{name}: {low} is {values[low]:g}, more than {high} = {values[high]:g}; exchange them.")
        result[name] = {key: float(values[key]) for key in parameters}
    return result
