"""What a model may lack: every effect by name, with its law, parameters, units and bounds."""

from analytic.effects.catalogue import (
    CATALOGUE,
    EffectError,
    acting,
    motion_with,
    parameters_with,
    recorded_with,
    rig_with,
)
from analytic.effects.effect import Acting, Effect, Parameter

__all__ = [
    "CATALOGUE",
    "Acting",
    "Effect",
    "EffectError",
    "Parameter",
    "acting",
    "motion_with",
    "parameters_with",
    "recorded_with",
    "rig_with",
]
