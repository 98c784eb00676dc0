"""Effects of a user's own: a Python file read, checked, and set beside the catalogue while a command lasts."""

from __future__ import annotations

import functools
import itertools
import runpy
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analytic.effects import CATALOGUE, Effect, EffectError, Force, joined
from analytic.effects.force import Values
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.errors import InputError
from harness.recording.source import read_source


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
def own_effects(files: Sequence[Path]) -> Iterator[tuple[Effect, ...]]:
    """The effects of `files`, which the catalogue has at its end as long as the context lasts.

    Raises:
        InputError: a file is missing or is no Python, has no effect in it or one that cannot be, or a name is taken.
    """
    with ExitStack() as stack:
        found: list[Effect] = []
        for file in files:
            effects = read_effects(file)
            try:
                stack.enter_context(joined(effects))
            except EffectError as error:
                raise InputError(f"{file}: {error}.") from error
            found += effects
        yield tuple(found)


def read_effects(file: Path) -> tuple[Effect, ...]:
    """The effects that a Python file defines, in its order; what goes wrong in them later names file and line too.

    Raises:
        InputError: as of `own_effects`, but for names.
    """
    read_source(file)  # says what is wrong with a file that cannot be read
    try:
        content = runpy.run_path(str(file))
    except Exception as error:
        raise _blamed(file, error) from error
    values = [v for value in content.values() for v in (value if isinstance(value, list | tuple) else [value])]
    effects = {id(v): v for v in values if isinstance(v, Effect) and not any(v is one for one in CATALOGUE.values())}
    if not effects:
        raise InputError(f"{file}: has no effect in it. Write one down as NAME = Effect(…).")
    return tuple(_checked(file, effect) for effect in effects.values())


def _checked(file: Path, effect: Effect) -> Effect:
    """The same effect, whose errors are told with their place; its force has been computed all over its bounds."""
    if effect.sense is not None:
        raise InputError(
            f"{file}: {effect.name}: an effect of your own cannot act on the sensor, for the filter knows its sensors "
            "by name. Leave out `sense`; it can be a force, or alter, turn or write."
        )
    guarded: dict[str, Any] = {
        name: _guarded(file, effect.name, getattr(effect, name))
        for name in ("write", "alter", "turn")
        if getattr(effect, name) is not None
    }
    if effect.force is not None:
        law = _guarded(file, effect.name, effect.force.law)
        force = guarded["force"] = OwnForce(effect.force.by, law, effect.force.over, f"{file}: {effect.name}")
        rig = Rig()
        typical = {one.name: one.typical for one in effect.parameters}
        corners = itertools.product(*({one.low, one.high, *one.starts} for one in effect.parameters))
        for values in (typical, *(dict(zip(typical, corner, strict=True)) for corner in corners)):
            force.sampled(rig, values)
    return replace(effect, **guarded)


def _guarded(file: Path, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """The same function; an error in it is the user's, and says where."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except Exception as error:
            raise _blamed(file, error, name) from error

    return call


def _blamed(file: Path, error: Exception, name: str = "") -> InputError:
    """An error in a user's file as a message: file, line, what."""
    line = error.lineno if isinstance(error, SyntaxError) else None
    for frame in traceback.extract_tb(error.__traceback__):
        if frame.filename == str(file):
            line = frame.lineno
    where = f"{file}, line {line}" if line else str(file)
    what = f"{type(error).__name__}: " if not isinstance(error, EffectError) else ""
    message = error.msg if isinstance(error, SyntaxError) else error
    return InputError(f"{where}: {name and name + ': '}{what}{message}. Correct the file.")
