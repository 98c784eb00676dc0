"""Every effect by name, and what a rig with effects acting comes to: kernel vector, beam motion, sensor."""

from __future__ import annotations

import copyreg
import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType

import numpy as np

from analytic import slots
from analytic.effects.ball import BALL
from analytic.effects.drive import DRIVE, transmitted
from analytic.effects.effect import Acting, Effect, Follower, Transmission
from analytic.effects.force import EffectError
from analytic.effects.parameter import Limits, Parameter
from analytic.effects.resistance import RESISTANCES
from analytic.effects.sensor import SENSOR
from analytic.effects.sensor_law import SensorLaw
from analytic.effects.track import TRACK
from analytic.models import Model, coefficients
from analytic.motion import BeamMotion, FloatArray, TiltingMotion
from analytic.naming import did_you_mean
from analytic.rig import Rig

_EFFECTS = {effect.name: effect for effect in (*RESISTANCES, *TRACK, *BALL, *DRIVE, *SENSOR)}
_LEAST_LAG = 1e-5  # [s]: a shorter one lets an error pass as it is
CATALOGUE: Mapping[str, Effect] = MappingProxyType(_EFFECTS)


def _of_name(name: str) -> Effect:
    return _EFFECTS[name]


def _by_name(effect: Effect) -> tuple[Callable[[str], Effect], tuple[str]]:
    """How an effect goes from process to process: by its name, as laws are functions without one.

    Raises:
        pickle.PicklingError: it is not in the catalogue.
    """
    if _EFFECTS.get(effect.name) is not effect:
        raise pickle.PicklingError(f"the effect {effect.name!r} is not that of the catalogue")
    return _of_name, (effect.name,)


copyreg.pickle(Effect, _by_name)


@contextmanager
def joined(effects: Iterable[Effect]) -> Iterator[None]:
    """The catalogue with `effects` at its end, as long as the context lasts.

    Raises:
        EffectError: a name is taken.
    """
    names = []
    try:
        for effect in effects:
            if effect.name in _EFFECTS:
                raise EffectError(f"the name {effect.name!r} is taken; choose another")
            _EFFECTS[effect.name] = effect
            names.append(effect.name)
        yield
    finally:
        for name in names:
            del _EFFECTS[name]


def acting(name: str, values: Mapping[str, float]) -> Acting:
    """The effect of this name with these values.

    Raises:
        EffectError: unknown effect or parameter, a missing parameter, or a value out of bounds.
    """
    if name not in CATALOGUE:
        hint = did_you_mean(name, CATALOGUE)
        raise EffectError(f"there is no effect {name!r}.{hint} There are: {', '.join(CATALOGUE)}.")
    effect = CATALOGUE[name]
    check_values(name, {parameter.name: parameter for parameter in effect.parameters}, values)
    return Acting(effect, dict(values))


def check_values(name: str, needed: Mapping[str, Parameter | Limits], values: Mapping[str, float]) -> None:
    """Refuse `values` of `name` that are not those needed, or that lie out of their bounds.

    Raises:
        EffectError: they are or do.
    """
    if set(values) != set(needed):
        raise EffectError(f"{name} has the parameters {', '.join(needed)}; given: {', '.join(values) or 'none'}.")
    for key, value in values.items():
        low, high = needed[key].low, needed[key].high
        if not low <= value <= high:
            raise EffectError(
                f"{name}: {key} is {value:g}; it must lie between {low:g} and {high:g} {needed[key].unit}."
            )


def rig_with(rig: Rig, effects: Iterable[Acting]) -> Rig:
    """The rig as it is when `effects` act; it is `rig` unless one of them alters it."""
    for one in effects:
        if one.effect.alter is not None:
            rig = one.effect.alter(rig, one.values)
    return rig


def parameters_with(model: Model, rig: Rig, effects: Sequence[Acting], *, phase: float = 0.0) -> FloatArray:
    """The kernel vector of `model` on `rig` with `effects` acting, shape (SLOTS + laws · LAW_SLOTS,).

    Args:
        phase: φ₀, how the ball lies at the start, where that matters to one of them [rad].

    Raises:
        EffectError: a force law gives no numbers over its range.
    """
    rig = rig_with(rig, effects)
    vector = coefficients(model, rig)
    for one in effects:
        if one.effect.write is not None:
            one.effect.write(vector, rig, one.values)
    if any(one.effect.turning for one in effects):
        vector[slots.PHASE] = phase
    laws = [one.effect.force.sampled(rig, one.values) for one in effects if one.effect.force is not None]
    return np.concatenate((vector, *laws)) if laws else vector


def transmission_with(effects: Iterable[Acting]) -> Transmission:
    """Gain and play of all of `effects` between measured angle and beam: gains multiply, plays add up."""
    gain, play = 1.0, 0.0
    for one in effects:
        if one.effect.transmission is not None:
            each = one.effect.transmission(one.values)
            gain, play = gain * each.gain, play + each.play
    return Transmission(gain, play)


def followers_with(effects: Iterable[Acting]) -> tuple[Follower, ...]:
    """How an error of the angle passes through those of `effects` that smooth it, one behind the other."""
    each = (one.effect.follower(one.values) for one in effects if one.effect.follower is not None)
    return tuple(follower for follower in each if follower.lag >= _LEAST_LAG)


def motion_with(motion: BeamMotion, stamps: FloatArray, effects: Iterable[Acting]) -> BeamMotion:
    """The beam's motion when `effects` act between it and the measured one; `stamps`, shape (n,) [s].

    The rig tilts with all of that.
    """
    tilting = 0.0
    for one in effects:
        if one.effect.transmission is not None:
            motion = transmitted(motion, stamps, one.effect.transmission(one.values))
        if one.effect.turn is not None:
            motion = one.effect.turn(motion, stamps, one.values)
        if one.effect.tilting is not None:
            tilting += one.effect.tilting(one.values)
    return TiltingMotion(motion, tilting, float(stamps[0])) if tilting else motion


def sensor_with(effects: Iterable[Acting]) -> SensorLaw:
    """What `effects` do to the recorded position, all of them one behind the other."""
    law = SensorLaw()
    for one in effects:
        if one.effect.sensor is not None:
            law = law.behind(one.effect.sensor(one.values))
    return law
