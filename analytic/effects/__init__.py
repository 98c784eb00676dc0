"""What a model may lack: every effect by name, with its law, parameters, units and bounds."""

from analytic.effects.catalogue import (
    CATALOGUE,
    acting,
    joined,
    motion_with,
    parameters_with,
    recorded_with,
    rig_with,
)
from analytic.effects.effect import Acting, Effect, Parameter
from analytic.effects.force import EffectError, Force

__all__ = [
    "CATALOGUE",
    "Acting",
    "Effect",
    "EffectError",
    "Force",
    "Parameter",
    "acting",
    "joined",
    "motion_with",
    "parameters_with",
    "recorded_with",
    "rig_with",
]
