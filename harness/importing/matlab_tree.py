"""What variables of a MAT-file become: dictionaries, lists, arrays, texts, signals, series, and what cannot be read."""

from __future__ import annotations

from dataclasses import dataclass

from harness.importing.signals import Signal

DEEPEST = 12  # structs within structs
FEWEST = 3  # values of a signal
MOST_SIGNALS = 64  # of one array


@dataclass(frozen=True)
class Opaque:
    """What is no array of real numbers.

    Attributes:
        kind: what it is; the class of an object, such as `timeseries`.
        of_class: whether it is an object.
        reason: why its data cannot be read, in words; empty if its kind says so.
    """

    kind: str
    of_class: bool = False
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Series:
    """Signals with the time that belongs to them.

    Attributes:
        kind: the class of the object that holds them.
        time: of the rows; columns: at least one; shape (n,) each.
    """

    kind: str
    time: Signal
    columns: tuple[Signal, ...]
