"""Effects of a user's own: a Python file read, checked, and set beside the catalogue while a command lasts."""

import functools
import itertools
import math
import runpy
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from analytic.effects import CATALOGUE, Effect, EffectError, Follower, Force, SensorLaw, Transmission, joined
from analytic.effects.force import Values
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.errors import INTERRUPTS, InputError
from harness.recording.source import read_source
from harness.time_limit import TimeLimit, time_limit

# Of the clock. A law is computed thousands of times in a search, and takes a tenth of a millisecond if it computes with
# arrays; reading a file may import large packages.
LONGEST_CALL = 1.0
LONGEST_READ = 8.0
# What the functions of an effect give; `write` changes what it is given, and a motion is whatever has its methods.
_GIVES: dict[str, type | None] = {
    "write": None,
    "alter": Rig,
    "turn": None,
    "follower": Follower,
    "tilting": float,
    "transmission": Transmission,
    "sensor": SensorLaw,
}


@dataclass(frozen=True)
class OwnForce(Force):
    """A force whose errors are the user's: they are told with `place`, its file and effect."""

    place: str = ""

    def sampled(self, rig: Rig, values: Values) -> FloatArray:
        """As of any force.

        Raises:
            InputError: the law gives no force that can be used.
        """
        try:
            return super().sampled(rig, values)
        except EffectError as error:
            raise InputError(f"{self.place}: {error}. Narrow the bounds, or correct the law.") from error


@contextmanager
def own_effects(given: Sequence[Path | Effect]) -> Iterator[tuple[Effect, ...]]:
    """Effects, also those of files, which the catalogue has at its end as long as the context lasts; files first.

    Raises:
        InputError: a file is missing or is no Python, has no effect in it or one that cannot be, or a name is taken.
    """
    objects = tuple(one for one in given if isinstance(one, Effect))
    groups = [(f"{one}: ", read_effects(one)) for one in given if not isinstance(one, Effect)]
    groups.append(("", tuple(one for one in objects if CATALOGUE.get(one.name) is not one)))
    with ExitStack() as stack:
        for place, effects in groups:
            try:
                stack.enter_context(joined(effects))
            except EffectError as error:
                raise InputError(f"{place}{error}.") from error
        yield tuple(one for _, effects in groups[:-1] for one in effects) + objects


def read_effects(file: Path) -> tuple[Effect, ...]:
    """The effects that a Python file defines, in its order; what goes wrong in them later names file and line too.

    Raises:
        InputError: as of `own_effects`, but for names.
    """
    read_source(file)  # says what is wrong with a file that cannot be read
    try:
        # Settings that the file makes for the whole program end with it.
        with np.errstate(), warnings.catch_warnings(), time_limit(LONGEST_READ):
            content = runpy.run_path(str(file))
    except INTERRUPTS:
        raise
    except BaseException as error:
        raise _blamed(file, error) from error
    values = [v for value in content.values() for v in (value if isinstance(value, list | tuple) else [value])]
    effects = {id(v): v for v in values if isinstance(v, Effect) and not any(v is one for one in CATALOGUE.values())}
    if not effects:
        raise InputError(f"{file}: has no effect in it. Write one down as NAME = Effect(…).")
    try:
        with time_limit(LONGEST_READ):
            return tuple(_checked(file, effect) for effect in effects.values())
    except (InputError, *INTERRUPTS):
        raise
    except BaseException as error:  # an attribute of another type than an effect has, or too many laws that are slow
        raise _blamed(file, error) from error


def _checked(file: Path, effect: Effect) -> Effect:
    """The same effect, whose errors are told with their place; its force has been computed all over its bounds."""
    guarded: dict[str, Any] = {
        name: _guarded(file, effect.name, getattr(effect, name), name, kind)
        for name, kind in _GIVES.items()
        if getattr(effect, name) is not None
    }
    typical = {one.name: one.typical for one in effect.parameters}
    corners = itertools.product(*({one.low, one.high, *one.fixed_starts} for one in effect.parameters))
    every = (typical, *(dict(zip(typical, corner, strict=True)) for corner in corners))
    if effect.sensor is not None:
        for values in every:
            _check_sensor(f"{file}: {effect.name}", guarded["sensor"](values), values)
    for values in every:
        if effect.alter is not None:
            guarded["alter"](Rig(), values)
        for name in {"tilting", "transmission", "follower"} & guarded.keys():
            guarded[name](values)
    if effect.force is not None:
        law = _guarded(file, effect.name, effect.force.law)
        force = guarded["force"] = OwnForce(effect.force.by, law, effect.force.over, f"{file}: {effect.name}")
        for values in every:
            force.sampled(Rig(), values)
    return replace(effect, **guarded)


def _check_sensor(place: str, law: SensorLaw, values: Values) -> None:
    """Refuse what the filter cannot take for a sensor."""
    given = ", ".join(f"{name} = {value:g}" for name, value in values.items())
    if not (
        all(map(math.isfinite, (law.gain, law.lag, law.delay, law.square, law.cube))) and law.gain and law.lag >= 0.0
    ):
        raise InputError(
            f"{place}: with {given} the sensor has the gain {law.gain:g}, the lag {law.lag:g} s and the delay "
            f"{law.delay:g} s. Narrow the bounds, or correct the law: no gain of 0, no negative lag."
        )


def _guarded(
    file: Path, name: str, function: Callable[..., Any], role: str = "", gives: type | None = None
) -> Callable[..., Any]:
    """The same function; an error in it is the user's, and says where, as is anything else than what it has to give."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            with time_limit(LONGEST_CALL):
                made = function(*arguments, **named)
        except INTERRUPTS:
            raise
        except BaseException as error:
            raise _blamed(file, error, name) from error
        if gives is not None and not isinstance(made, gives):
            raise InputError(f"{file}: {name}: {role} gives {made!r}. Let it give a {gives.__name__}.")
        return made

    return call


def _blamed(file: Path, error: BaseException, name: str = "") -> InputError:
    """An error in a user's file, or that it ends the program or does not end, as a message: file, line, what."""
    line = error.lineno if isinstance(error, SyntaxError) else None
    for frame in traceback.extract_tb(error.__traceback__):
        if frame.filename == str(file):
            line = frame.lineno
    where = f"{file}, line {line}" if line else str(file)
    what = f"{type(error).__name__}: " if not isinstance(error, EffectError) else ""
    message = error.msg if isinstance(error, SyntaxError) else error
    if isinstance(error, SystemExit):
        what, message = "", "ends the program by sys.exit"
    if isinstance(error, TimeLimit):
        what, message = "", f"takes more than {error.seconds:g} s"
    return InputError(f"{where}: {name and name + ': '}{what}{message}. Correct the file.")
