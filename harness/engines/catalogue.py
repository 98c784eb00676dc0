"""Engines by name, and their user settings: `mujoco.friction=0.3` or a TOML table."""

from __future__ import annotations

import importlib
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from analytic.naming import did_you_mean
from harness.engines.parameters import EngineParameters
from harness.errors import InputError
from harness.scene import Scene
from harness.toml_text import parse_toml

if TYPE_CHECKING:
    from analytic.rig import Rig
    from harness.engines.protocol import Engine

# Imported on demand: an engine that is not used need not be installed.
_CLASSES = {
    "mujoco": ("harness.engines.mujoco", "MuJoCo"),
    "pybullet": ("harness.engines.pybullet", "PyBullet"),
    "dart": ("harness.engines.dart", "Dart"),
}
_OWN_SCENE = {  # with a scene of the user's, named after the same engine
    "mujoco": ("harness.engines.own_scene.mujoco_engine", "MuJoCoScene"),
    "pybullet": ("harness.engines.own_scene.pybullet_engine", "PyBulletScene"),
}
ENGINES = tuple(_CLASSES)
GRAPHICS = "MUJOCO_GL"
"""Variable of the environment that says by which OpenGL MuJoCo draws."""
DEFAULT_ENGINES = ("mujoco", "pybullet")
RIG_TABLE = "rig"
"""Table of a settings file that is of the rig and no engine's (`harness.recording.rig_changes`)."""


class GraphicsVariable(InputError):
    """A variable of the environment names an OpenGL that MuJoCo cannot be loaded with."""


def engine_of(name: str, scene: Scene | None = None) -> Engine:
    """The engine with this name.

    Args:
        name: one of `ENGINES`.
        scene: of the user's own; the engine runs it if it names a file for this engine, else the built-in one.

    Raises:
        InputError: the name is unknown, the engine's package is not installed, or a variable is in its way.
    """
    if name not in _CLASSES:
        raise InputError(f"there is no engine {name!r}; engines are {', '.join(ENGINES)}")
    own = scene is not None and scene.file_of(name) is not None
    module, attribute = _OWN_SCENE[name] if own else _CLASSES[name]
    try:
        if name == "mujoco":
            load_mujoco()
        made = getattr(importlib.import_module(module), attribute)
        engine: Engine = made(scene) if own else made()
    except ImportError as error:  # not installed, or a system library is missing
        others = ", ".join(other for other in ENGINES if other != name)
        raise InputError(
            f"engine {name} cannot be loaded ({error}); install its requirements, or choose from {others} with --engine"
        ) from error
    return engine


def load_mujoco() -> None:
    """Import MuJoCo, which loads OpenGL if a variable says so.

    Raises:
        GraphicsVariable: the variable keeps it from being imported.
        ImportError: it is not installed.
    """
    try:
        importlib.import_module("mujoco")
    except Exception as error:  # whatever the bindings of the kind of OpenGL raise that the variable asks for
        kind = os.environ.get(GRAPHICS)
        if kind is None or (isinstance(error, ModuleNotFoundError) and error.name == "mujoco"):
            raise
        raise GraphicsVariable(
            f"MuJoCo cannot be loaded with {GRAPHICS}={kind} ({error}); unset this variable, or set it to egl, osmesa "
            "or glfw"
        ) from error


def try_scene(scene: Scene, rig: Rig) -> None:
    """Load and measure a user's scene in every engine that runs it.

    Args:
        scene: the files and names.
        rig: has what the files do not give.

    Raises:
        InputError: one of them cannot be driven.
    """
    for name in ENGINES:
        if scene.file_of(name) is not None:
            engine = engine_of(name, scene)
            engine.try_out(rig)


def read_settings(file: Path | None, assignments: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Settings per engine from a TOML file (one table per engine), overridden by `engine.name=value` texts.

    A table `[rig]` is left to `harness.recording.rig_changes`.

    Raises:
        InputError: unreadable file, unknown engine, or a text that is not an assignment.
    """
    settings: dict[str, dict[str, Any]] = {}
    if file is not None:
        try:
            tables = parse_toml(file.read_text(encoding="utf-8-sig"))
        except OSError as error:
            raise InputError(f"{file}: cannot be read ({error.strerror or error})") from error
        except ValueError as error:  # invalid TOML or invalid UTF-8
            raise InputError(f"{file}: not valid TOML: {error}") from error
        for engine, table in tables.items():
            if engine == RIG_TABLE:
                continue
            if not isinstance(table, Mapping):
                raise InputError(f"{file}: {engine} is not a table; write [{DEFAULT_ENGINES[0]}] above its settings")
            given = {name: None if value == "none" else value for name, value in table.items()}
            settings.setdefault(_known(engine), {}).update(given)
    for text in assignments:
        name, equals, value = text.partition("=")
        engine, dot, parameter = name.strip().partition(".")
        if not (equals and dot and parameter):
            raise InputError(f"--set {text}: write engine.parameter=value, as in mujoco.friction=0.3")
        if re.search(r"\d_\d", value):
            raise InputError(f"--set {text}: write the number without _")
        settings.setdefault(_known(engine), {})[parameter] = _value(value.strip())
    return settings


def parameters_of(engine: Engine, settings: Mapping[str, Any]) -> EngineParameters:
    """The engine's parameters with `settings` applied.

    Raises:
        InputError: unknown name (the message lists the valid ones), or a value out of bounds.
    """
    fields = engine.parameters.model_fields
    for name in settings:
        if name not in fields:
            hint = engine.elsewhere(name) or did_you_mean(name, fields)
            raise InputError(f"{engine.name} has no parameter {name!r}.{hint} Parameters are: {', '.join(fields)}.")
    try:
        return engine.parameters(**settings)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join((engine.name, *map(str, first["loc"])))
        given = "" if not first["loc"] else f" (given: {first['input']!r})"
        raise InputError(f"{name}: {first['msg'].removeprefix('Value error, ')}{given}") from error


def describe(engine: Engine) -> list[tuple[str, str, str]]:
    """Name, default and description of every parameter of `engine`, for help texts."""
    return [
        (f"{engine.name}.{name}", str(field.default), field.description or "")
        for name, field in engine.parameters.model_fields.items()
    ]


def _known(engine: str) -> str:
    if engine not in _CLASSES:
        raise InputError(f"there is no engine {engine!r} to set a parameter of; engines are {', '.join(ENGINES)}")
    return engine


def _value(text: str) -> Any:
    """A TOML value, `None` for `none`, or otherwise the text itself."""
    if text == "none":
        return None
    try:
        return parse_toml(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
