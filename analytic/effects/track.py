"""What tilts the track where the recorded angle does not: level, curvature, a bump, a beam that bends."""

from __future__ import annotations

from analytic.effects.effect import Effect, Parameter
from analytic.effects.force import Values
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


TRACK = (
    Effect(
        "level_error",
        "gravity sees α + angle",
        (Parameter("angle", "rad", -0.2, 0.2, 0.003, starts=(0.0,)),),
        "the paper, eq. 18, 19",
        _level,
    ),
    Effect(
        "track_curvature",
        "tilt grows by κ (s_c − s); κ > 0 is a bowl",
        (Parameter("curvature", "1/m", -1.0, 1.0, 0.05), Parameter("centre", "m", -10.0, 10.0, 0.3)),
        "geometry of a circular track, small angles",
        _curvature,
    ),
    Effect(
        "track_bump",
        "rail height H exp(−½ ((s − s_c)/w)²); its descent adds to the tilt",
        (
            Parameter("height", "m", -0.01, 0.01, 2e-4),
            Parameter("centre", "m", -10.0, 10.0, 0.3),
            Parameter("width", "m", 1e-3, 1.0, 0.02),
        ),
        "geometry, small angles",
        _bump,
    ),
    Effect(
        "beam_compliance",
        "tilt grows by compliance · m g s",
        (Parameter("compliance", "rad/(N m)", -1.0, 1.0, 0.02, starts=(0.0,)),),
        "Timoshenko, Strength of Materials, 1930: end rotation under a moment",
        _compliance,
    ),
)
