"""What variables of a MAT-file become: dictionaries, lists, arrays, texts, and objects that cannot be read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Opaque:
    """A MATLAB object whose data only MATLAB reads; `kind` is its class, such as `timeseries`."""

    kind: str
