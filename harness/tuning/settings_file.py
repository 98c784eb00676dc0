"""The settings file of a tuned engine: what `--parameters` reads, one table an engine and one of the rig."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.engines.catalogue import RIG_TABLE

FILE = "tuned.toml"


def settings_text(engine: str, settings: Mapping[str, Any], scene: Mapping[str, float], head: str) -> str:
    """TOML text.

    Args:
        engine: name of the engine.
        settings: of it, by name.
        scene: quantities of the rig, by their keys in rig.toml.
        head: comment at the top, possibly of several lines.
    """
    lines = [f"# {line}" for line in head.splitlines()]
    if settings:
        lines += ["", f"[{engine}]", *(f"{name} = {_value(value)}" for name, value in settings.items())]
    if scene:
        lines += ["", f"[{RIG_TABLE}]", *(f"{name} = {_value(value)}" for name, value in scene.items())]
    return "\n".join(lines) + "\n"


def _value(value: Any) -> str:
    """A value as TOML writes it; `None`, which TOML does not have, as the text that `--set` takes for it."""
    if value is None:
        return '"none"'
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)
