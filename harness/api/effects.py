"""Effects of a user's own, as files or as objects, beside the catalogue while a call lasts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

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
    from harness.recording.user_effects import own_effects

    with own_effects([Path(one) if isinstance(one, str) else one for one in given]) as effects:
        yield effects


def files_of(given: Sequence[Given]) -> tuple[Path, ...]:
    """The files among `given`."""
    return tuple(Path(one) for one in given if isinstance(one, str | Path))
