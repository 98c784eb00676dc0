"""What tilts the track where the recorded angle does not: level, curvature, a bump, a beam that bends."""

from __future__ import annotations

import numpy as np

from analytic.effects.effect import Effect, EngineEntry, Relations, TrialSize
from analytic.effects.force import Values
from analytic.effects.parameter import Parameter
from analytic.models import (
    BUMP_CENTRE,
    BUMP_HEIGHT,
    BUMP_WIDTH,
    COMPLIANCE,
    CURVATURE,
    CURVATURE_CENTRE,
    LEVEL,
)
from analytic.motion import FloatArray
from analytic.rig import Rig


def _level(p: FloatArray, rig: Rig, values: Values) -> None:
    p[LEVEL] += values["angle"]


def _curvature(p: FloatArray, rig: Rig, values: Values) -> None:
    p[CURVATURE], p[CURVATURE_CENTRE] = values["curvature"], values["centre"]


def _bump(p: FloatArray, rig: Rig, values: Values) -> None:
    p[BUMP_HEIGHT], p[BUMP_CENTRE], p[BUMP_WIDTH] = values["height"], values["centre"], values["width"]


def _compliance(p: FloatArray, rig: Rig, values: Values) -> None:
    p[COMPLIANCE] += values["compliance"] * rig.mass * rig.gravity


_WIDEST = 0.1  # bump [m]
_AMID = (0.28, 0.38)  # where the ball passes most often in blind trials [m]
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
    write=_level,
    phrase="a level error of {angle}",
    relations=Relations(stands_for="level", nested_in=_OF_POSITION),
    engine=EngineEntry("force on the ball, as a tilt of gravity gives it"),
    trial=TrialSize({"angle": 0.005}, signed=True),
)
BEAM_COMPLIANCE = Effect(
    "beam_compliance",
    "tilt grows by compliance · m g s",
    (Parameter("compliance", "rad/(N m)", -1.0, 1.0, 0.02, starts=(0.0,), strength=True),),
    "Timoshenko, Strength of Materials, 1930: end rotation under a moment",
    write=_compliance,
    phrase="a beam compliance of {compliance}",
    relations=Relations(nested_in=_OF_POSITION),
    trial=TrialSize({"compliance": 0.02}),
)
TRACK_CURVATURE = Effect(
    "track_curvature",
    "tilt grows by κ (s_c − s); κ > 0 is a bowl",
    (
        Parameter("curvature", "1/m", -1.0, 1.0, 0.05, starts=(0.005, -0.02, 0.02), strength=True),
        Parameter("centre", "m", -10.0, 10.0, 0.3, starts=_middle, place=True),
    ),
    "geometry of a circular track, small angles",
    write=_curvature,
    phrase="a track curvature of {curvature} about s = {centre}",
    # a beam that bends is a bowl with its centre elsewhere
    relations=Relations(once=True, nested_in=_OF_POSITION, splits_into=(LEVEL_ERROR, BEAM_COMPLIANCE)),
    trial=TrialSize({"curvature": 0.06}, fixed={"centre": _AMID}, signed=True),
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
    write=_bump,
    phrase="a bump of the track of {height} at s = {centre}, {width} wide,",
    relations=Relations(once=True, nested_in=_OF_POSITION),
    trial=TrialSize({"height": 2e-4}, fixed={"centre": _AMID, "width": (0.015, 0.025)}, signed=True),
)

TRACK = (LEVEL_ERROR, TRACK_CURVATURE, TRACK_BUMP, BEAM_COMPLIANCE)
