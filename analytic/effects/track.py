"""What tilts the track where the recorded angle does not: level, its drift, curvature, a bump, a beam that bends."""

from __future__ import annotations

import numpy as np

from analytic import slots
from analytic.effects.effect import Effect, EngineEntry, Relations, adding
from analytic.effects.parameter import Parameter
from analytic.effects.source_code import Code
from analytic.motion import FloatArray
from analytic.rig import Rig

_WIDEST = 0.1  # bump [m]
_PLACE = "((s - {centre}) / {width})"  # on a bump, in source code
_OF_POSITION = (("position", False),)


def _middle(visited: FloatArray, rig: Rig) -> list[float]:
    return [float(np.percentile(visited, 50))]


def _along(visited: FloatArray, rig: Rig) -> list[float]:
    low, high = np.percentile(visited, [2, 98])
    return [float(place) for place in np.linspace(low, high, 13)]


def _near(visited: FloatArray, rig: Rig) -> tuple[float, float]:
    """Bounds of a bump's place: one where the ball has not been, or as wide as the track, is any curve at all."""
    first, last = np.percentile(visited, [0.5, 99.5])
    return float(first) - _WIDEST, float(last) + _WIDEST


LEVEL_ERROR = Effect(
    "level_error",
    "gravity sees α + angle",
    (Parameter("angle", "rad", -0.2, 0.2, 0.003, starts=(0.0,), strength=True, shown=("°", float(np.degrees(1.0)))),),
    "the paper, eq. 18, 19",
    write=adding(lambda k, rig, v: {slots.LEVEL: v["angle"]}),
    code=Code(tilt="{angle}"),
    phrase="a level error of {angle}",
    relations=Relations(stands_for="level", nested_in=_OF_POSITION),
    engine=EngineEntry("force on the ball, as a tilt of gravity gives it"),
)
LEVEL_PER_RECORDING = Effect(
    "level_per_recording",
    "gravity sees α + αᵢ, αᵢ of recording i; spread is their standard deviation",
    (
        Parameter(
            "spread",
            "rad",
            -0.2,
            0.2,
            0.003,
            strength=True,
            by_recording=True,
            shown=("°", float(np.degrees(1.0))),
        ),
    ),
    "the paper, eq. 18, 19; a rig that is put up anew, or whose angle is counted from another zero",
    write=adding(lambda k, rig, v: {slots.LEVEL: v["spread"]}),
    code=Code(tilt="{spread}"),
    phrase="a level that differs between recordings by {spread}",
    relations=Relations(once=True),
    engine=EngineEntry("force on the ball, as a tilt of gravity gives it"),
)
LEVEL_DRIFT = Effect(
    "level_drift",
    "the whole rig tilts by rate · t, t from the start of a recording on",
    (
        Parameter(
            "rate",
            "rad/s",
            -0.02,
            0.02,
            5e-4,
            starts=(0.0,),
            strength=True,
            shown=("°/min", 60.0 * float(np.degrees(1.0))),
        ),
    ),
    "geometry: a support that gives way, or warms up",
    tilting=lambda values: values["rate"],
    code=Code(stage="drift"),
    phrase="a level that drifts by {rate} in each recording",
    relations=Relations(nested_in=(("time", False),)),
)
BEAM_COMPLIANCE = Effect(
    "beam_compliance",
    "tilt grows by compliance · m g s",
    # no load lifts a beam; a ball of 0.1 kg at 0.3 m bends one of 0.2 by 3.4°, which is to be seen
    (Parameter("compliance", "rad/(N m)", -1.0, 1.0, 0.02, starts=(0.0,), strength=True, usual=(0.0, 0.2)),),
    "Timoshenko, Strength of Materials, 1930: end rotation under a moment",
    write=adding(lambda k, rig, v: {slots.COMPLIANCE: v["compliance"] * rig.mass * rig.gravity}),
    code=Code(tilt="{compliance} * MASS * GRAVITY * s"),
    phrase="a beam compliance of {compliance}",
    # κ (s_c − s) is a level of κ s_c and a compliance of −κ/(m g): a hill is a beam that bends
    relations=Relations(
        common=True,
        nested_in=_OF_POSITION,
        same_beside={"track_curvature": ("level_error", "level_per_recording")},
    ),
)
TRACK_CURVATURE = Effect(
    "track_curvature",
    "tilt grows by κ (s_c − s); κ > 0 is a bowl",
    (
        Parameter("curvature", "1/m", -1.0, 1.0, 0.05, starts=(0.005, -0.02, 0.02), strength=True),
        Parameter("centre", "m", -10.0, 10.0, 0.3, starts=_middle, place=True),
    ),
    "geometry of a circular track, small angles",
    write=adding(lambda k, rig, v: {slots.CURVATURE: v["curvature"], slots.CURVATURE_CENTRE: v["centre"]}),
    code=Code(tilt="{curvature} * ({centre} - s)"),
    phrase="a track curvature of {curvature} about s = {centre}",
    # a beam that bends is a bowl with its centre elsewhere
    relations=Relations(once=True, nested_in=_OF_POSITION, splits_into=(LEVEL_ERROR, BEAM_COMPLIANCE)),
)
TRACK_BUMP = Effect(
    "track_bump",
    "rail height H exp(−½ ((s − s_c)/w)²); its descent adds to the tilt",
    (
        Parameter("height", "m", -0.01, 0.01, 2e-4, starts=(1e-4, -1e-4), strength=True, shown=("mm", 1e3)),
        Parameter("centre", "m", -10.0, 10.0, 0.3, starts=_along, place=True, fitted=_near),
        # wider than the beam is a slope
        Parameter(
            "width",
            "m",
            1e-3,
            1.0,
            0.02,
            starts=(0.015, 0.04),
            fitted=lambda visited, rig: (1e-3, _WIDEST),
            shown=("mm", 1e3),
        ),
    ),
    "geometry, small angles",
    write=adding(
        lambda k, rig, v: {slots.BUMP_HEIGHT: v["height"], slots.BUMP_CENTRE: v["centre"], slots.BUMP_WIDTH: v["width"]}
    ),
    code=Code(tilt=f"{{height}} / {{width}} * {_PLACE} * exp(-0.5 * {_PLACE} * {_PLACE})"),
    phrase="a bump of the track of {height} at s = {centre}, {width} wide,",
    relations=Relations(once=True, nested_in=_OF_POSITION),
)

TRACK = (LEVEL_ERROR, LEVEL_PER_RECORDING, LEVEL_DRIFT, TRACK_CURVATURE, TRACK_BUMP, BEAM_COMPLIANCE)
