"""What a reader finds in a file: groups of signals of the same length, before anybody knows what they mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.importing.words import read_name


@dataclass(frozen=True, eq=False)
class Signal:
    """A column of numbers.

    Attributes:
        name: as the file has it; of its own within a group.
        values: NaN where a cell is blank, shape (n,), in the file's unit.
        unit: as written; empty if the file has none.
        unit_from: where the unit is written, such as `Y_Unit_Label`; empty if it is in the name or nowhere.
        written: the file's own name, if it was replaced by a plainer one.
    """

    name: str
    values: FloatArray
    unit: str = ""
    unit_from: str = ""
    written: str = ""


def is_known(signal: Signal) -> bool:
    """Whether any of its values is known."""
    return bool(np.isfinite(signal.values).any())


def unit_of(signal: Signal) -> tuple[str, str]:
    """The unit as written, empty if nothing says it, and where it is written."""
    return (signal.unit, signal.unit_from) if signal.unit else (read_name(signal.name).unit, "its name")


def counts_rows(values: FloatArray) -> bool:
    """Whether readings, shape (n,), only count the rows."""
    return len(values) > 2 and bool(np.all(np.diff(values) == 1.0))


@dataclass(frozen=True, eq=False)
class Group:
    """Signals that share their rows.

    Attributes:
        name: of a sheet, a topic, a structure; empty where the file has only one group.
        signals: in the file's order.
        rows: row number of each value in the file, counted from 1 as in an editor, shape (n,).
        time: name of the signal that the format itself says is the time; `None` if it says none.
        step: sampling interval according to the file [s]; `None` if it has none.
        start: time of the first row according to the file [s], where `step` is given.
        step_from: where the sampling interval is written.
        words: columns of words by name, n each, such as the state of a controller.
        places: number of each row among those that were sampled, shape (n,); `None` where all are there.
    """

    name: str
    signals: tuple[Signal, ...]
    rows: NDArray[np.intp]
    time: str | None = None
    step: float | None = None
    start: float = 0.0
    step_from: str = ""
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    places: NDArray[np.intp] | None = None

    def qualified(self, signal: Signal) -> str:
        """The name of a signal with that of its group."""
        return f"{self.name}/{signal.name}" if self.name else signal.name

    def own_name(self, signal: Signal) -> str:
        """The name of a signal without that of its structure: `x` for `log.x` of `log`."""
        return signal.name.removeprefix(f"{self.name}.") if self.name else signal.name


@dataclass(frozen=True, eq=False)
class SourceFile:
    """A file that was read.

    Attributes:
        path: of the file.
        sha256: of its bytes.
        kind: what it is, in words.
        groups: what is in it.
        notes: what was left out or assumed when it was read, in words.
    """

    path: Path
    sha256: str
    kind: str
    groups: tuple[Group, ...]
    notes: tuple[str, ...] = field(default=())


def group_of(name: str, signals: Sequence[Signal], *, first_row: int = 1, time: str | None = None) -> Group:
    """A group whose values stand in consecutive rows."""
    return Group(name, tuple(signals), np.arange(first_row, first_row + len(signals[0].values)), time)


def unique_names(names: Sequence[str]) -> list[str]:
    """The same names, `column 3` for one that is empty, and numbered where one occurs again."""
    made: list[str] = []
    for number, given in enumerate(names, start=1):
        name = base = given.strip() or f"column {number}"
        again = 2
        while name in made:
            name = f"{base} ({again})"
            again += 1
        made.append(name)
    return made
