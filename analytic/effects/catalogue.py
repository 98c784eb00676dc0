"""Every effect by name, and the kernel vector of a model with effects acting."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping

from analytic.effects.effect import Acting, Effect
from analytic.effects.resistance import RESISTANCES
from analytic.effects.track import TRACK
from analytic.models import Model, coefficients
from analytic.motion import FloatArray
from analytic.rig import Rig

CATALOGUE: Mapping[str, Effect] = {effect.name: effect for effect in (*RESISTANCES, *TRACK)}


class EffectError(ValueError):
    """An effect that the catalogue does not have, or values that it cannot take; the text says what exists."""


def acting(name: str, values: Mapping[str, float]) -> Acting:
    """The effect of this name with these values.

    Raises:
        EffectError: unknown effect or parameter, a missing parameter, or a value out of bounds.
    """
    if name not in CATALOGUE:
        near = difflib.get_close_matches(name, CATALOGUE, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise EffectError(f"there is no effect {name!r}.{hint} There are: {', '.join(CATALOGUE)}.")
    effect = CATALOGUE[name]
    needed = {parameter.name: parameter for parameter in effect.parameters}
    if set(values) != set(needed):
        raise EffectError(f"{name} has the parameters {', '.join(needed)}; given: {', '.join(values) or 'none'}.")
    for key, value in values.items():
        low, high = needed[key].low, needed[key].high
        if not low <= value <= high:
            raise EffectError(
                f"{name}: {key} is {value:g}; it must lie between {low:g} and {high:g} {needed[key].unit}."
            )
    return Acting(effect, dict(values))


def parameters_with(model: Model, rig: Rig, effects: Iterable[Acting]) -> FloatArray:
    """The kernel vector of `model` on `rig` with `effects` acting, shape (SLOTS,)."""
    vector = coefficients(model, rig)
    for one in effects:
        one.effect.write(vector, rig, one.values)
    return vector
