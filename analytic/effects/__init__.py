"""What a model may lack: every effect by name, with its law, parameters, units and bounds."""

from analytic.effects.catalogue import CATALOGUE, EffectError, acting, parameters_with
from analytic.effects.effect import Acting, Effect, Parameter

__all__ = ["CATALOGUE", "Acting", "Effect", "EffectError", "Parameter", "acting", "parameters_with"]
