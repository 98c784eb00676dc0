"""A hint for a name that does not exist: what was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def did_you_mean(name: str, known: Iterable[str], *, likeness: float = 0.6) -> str:
    """` Did you mean 'friction'?` with the nearest of the `known` names, or nothing where none is near.

    Args:
        likeness: least ratio of what both have in common, 0 … 1 (`difflib.SequenceMatcher.ratio`).
    """
    near = difflib.get_close_matches(name, list(known), n=1, cutoff=likeness)
    return f" Did you mean {near[0]!r}?" if near else ""
