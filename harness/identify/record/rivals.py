"""Effects that the recordings do not tell from one that was found: single ones, and sets that act together."""

from __future__ import annotations

from collections.abc import Sequence


def rival_sets(names: Sequence[str], together: Sequence[tuple[str, ...]]) -> tuple[tuple[str, ...], ...]:
    """Each rival as the set of effects that it is: single ones first.

    Args:
        names: of all effects that are rivals, alone or together.
        together: the sets that are so only together.
    """
    among = {name for one in together for name in one}
    return (*((name,) for name in names if name not in among), *together)
