"""What variables of a MAT-file become: dictionaries, lists, arrays, texts, and objects that cannot be read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Opaque:
    """What is no array of real numbers.

    Attributes:
        kind: what it is; the class of an object, such as `timeseries`.
        of_class: whether it is an object, whose form in the file is not documented.
    """

    kind: str
    of_class: bool = False
