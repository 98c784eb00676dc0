"""Effects of a user's own, as files or as objects, beside the catalogue while a call lasts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from harness.errors import InputError

if TYPE_CHECKING:
    from analytic.effects import Effect

Given: TypeAlias = "str | Path | Effect"
"""A Python file with effects in it (`docs/diagnosis.md`), or an effect."""


@contextmanager
def beside_catalogue(given: Sequence[Given]) -> Iterator[tuple[Effect, ...]]:
    """All effects of `given`, which the catalogue has as long as the context lasts.

    Raises:
        InputError: a file cannot be used, or a name is taken.
    """
    if not given:
        yield ()
        return
    from analytic.effects import CATALOGUE, EffectError, joined
    from harness.recording.user_effects import own_effects

    effects = tuple(one for one in given if not isinstance(one, str | Path))
    with ExitStack() as stack:
        read = stack.enter_context(own_effects(files_of(given)))
        try:
            stack.enter_context(joined(one for one in effects if CATALOGUE.get(one.name) is not one))
        except EffectError as error:
            raise InputError(f"{error}.") from error
        yield (*read, *effects)


def files_of(given: Sequence[Given]) -> tuple[Path, ...]:
    """The files among `given`."""
    return tuple(Path(one) for one in given if isinstance(one, str | Path))
