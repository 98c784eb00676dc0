"""What is said about data that could be read: where it stands, what is odd, what to do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

SHOWN = 5  # places named in one message; more would hide the message itself


@dataclass(frozen=True)
class Finding:
    """Something the reader of a result has to know about its input.

    Attributes:
        severity: `warning` when a result may be wrong because of it, `note` when it only has to be known.
        where: file, and row and column where they apply.
        text: what was found and what to do about it.
    """

    severity: Literal["warning", "note"]
    where: str
    text: str


def place(file: object, row: int | None = None, column: str | None = None) -> str:
    """`file, row 12, column 'time_s'` with the parts that are known."""
    parts = [str(file)]
    if row is not None:
        parts.append(f"row {row}")
    if column is not None:
        parts.append(f"column '{column}'")
    return ", ".join(parts)


def rows_text(rows: Iterable[int]) -> str:
    """`row 5`, `rows 5-7, 9` … of ascending row numbers, shortened after a few places."""
    runs: list[list[int]] = []
    numbers = [int(row) for row in rows]
    for row in numbers:
        if runs and row == runs[-1][-1] + 1:
            runs[-1][1:] = [row]
        else:
            runs.append([row])
    shown = [f"{run[0]}-{run[-1]}" if len(run) > 1 else f"{run[0]}" for run in runs[:SHOWN]]
    more = f" and {len(runs) - SHOWN} more places" if len(runs) > SHOWN else ""
    return f"row{'s' if len(numbers) > 1 else ''} {', '.join(shown)}{more}"


def quoted(names: Sequence[str]) -> str:
    """`'a', 'b', 'c'`."""
    return ", ".join(f"'{name}'" for name in names)
