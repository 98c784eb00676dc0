"""Types of options: paths that a system can have, numbers that are finite and written plainly, states and angles."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from analytic.motion import State

_QUIET = "harness.quiet"
_LONGEST_NAME, _LONGEST_PATH = 255, 4095  # bytes; what Linux takes
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def number_in(text: str) -> float:
    """The finite number that a text is; Python's own `0.3_6` for 0.36, `nan` and `inf` are none.

    Raises:
        ValueError: it is none.
    """
    value = float(text) if _NUMBER.fullmatch(text.strip()) else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a finite number")
    return value


class PathType(click.Path):
    """A path, which need not exist."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Refuse what no file or folder can be called."""
        text = os.fspath(value)
        if not text:
            self.fail("is empty; name a file or folder", param, ctx)
        names = [len(os.fsencode(part)) for part in Path(text).parts]
        if max(names, default=0) > _LONGEST_NAME or len(os.fsencode(text)) > _LONGEST_PATH:
            self.fail(f"{text[:20]}…: this name is too long for a file system ({max(names)} bytes)", param, ctx)
        if "\0" in text:
            self.fail(f"{text!r}: no name holds a null character", param, ctx)
        return super().convert(value, param, ctx)


class CaseType(PathType):
    """A case: a path, or the name of a bundled one, which a shell completes, too."""

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Bundled cases that begin so, with files and folders here that do; else the shell completes paths itself.

        The request for paths makes bash and zsh drop names that are given beside it.
        """
        from harness.recording.case import BUILT_IN

        names = [name for name in BUILT_IN if name.startswith(incomplete)]
        if not names:
            return super().shell_complete(ctx, param, incomplete)
        here = sorted(one.name + "/" * one.is_dir() for one in Path().glob("[!.]*") if one.name.startswith(incomplete))
        return [CompletionItem(name) for name in (*names, *here)]


class FiniteRange(click.FloatRange):
    """A finite number within bounds."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Refuse what is no finite number before the bounds are looked at."""
        if isinstance(value, str):
            try:
                value = number_in(value)
            except ValueError as error:
                self.fail(f"{error}", param, ctx)
        return super().convert(value, param, ctx)


class Finite(click.ParamType):
    """A finite number."""

    name = "float"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Parse the option."""
        try:
            return number_in(str(value))
        except ValueError as error:
            self.fail(f"{error}", param, ctx)


class StateType(click.ParamType):
    """`0.36,0.0`: position [m] and velocity [m/s]; `estimate` for None."""

    name = "S,V"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> State | None:
        """Parse the option."""
        if value is None or isinstance(value, State) or value == "estimate":
            return None if value == "estimate" else value
        try:
            position, velocity = map(number_in, str(value).split(","))
        except ValueError:
            self.fail(f"{value!r} is not position,velocity in m and m/s, as in 0.36,0", param, ctx)
        return State(position, velocity)


class AngleType(click.ParamType):
    """`-0.16deg`, `-0.0028rad` or `-0.0028` (rad); `estimate`."""

    name = "ANGLE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Parse the option; radians."""
        if value is None or isinstance(value, float) or value == "estimate":
            return value
        found = re.fullmatch(r"(.*?)(deg|°|rad)?", str(value).strip())
        try:
            angle = (
                number_in(found[1]) * (1.0 if found[2] in (None, "rad") else math.radians(1.0)) if found else math.nan
            )
        except ValueError:
            angle = math.nan
        if not math.isfinite(angle):
            self.fail(f"{value!r} is not an angle; write -0.16deg, -0.0028rad or estimate", param, ctx)
        return angle


class Whole(click.IntRange):
    """A whole number within bounds, in plain digits."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Refuse `1_0` for 10."""
        if isinstance(value, str) and not re.fullmatch(r"[+-]?\d+", value.strip(), re.ASCII):
            self.fail(f"{value!r} is not a whole number", param, ctx)
        return super().convert(value, param, ctx)


quiet_option = click.option(
    "--quiet",
    "-q",
    is_flag=True,
    expose_value=False,
    callback=lambda ctx, param, value: ctx.meta.__setitem__(_QUIET, value),
    help="Show no progress; print only the result in a line or two, and errors.",
)
"""Of every command that makes something; `is_quiet` tells whether it was given."""


def is_quiet() -> bool:
    """Whether the command that runs was asked to be quiet."""
    ctx = click.get_current_context(silent=True)
    return ctx is not None and bool(ctx.meta.get(_QUIET))
