"""Warnings and notes on input that was read successfully."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

MAX_PLACES = 5  # rows named in one message


@dataclass(frozen=True)
class DataFinding:
    """A warning or note on the input, shown with every result.

    Attributes:
        severity: `warning` if it may make a result wrong, else `note`.
        where: file, with row and column if they apply.
        text: what was found, and the remedy.
    """

    severity: Literal["warning", "note"]
    where: str
    text: str


def place(file: object, row: int | None = None, column: str | None = None) -> str:
    """`file, row 12, column 'time_s'` ; row and column are optional."""
    parts = [str(file)]
    if row is not None:
        parts.append(f"row {row}")
    if column is not None:
        parts.append(f"column '{column}'")
    return ", ".join(parts)


def rows_text(rows: Iterable[int]) -> str:
    """`row 5`, `rows 5-7, 9` … from ascending row numbers, abbreviated after `MAX_PLACES` runs."""
    runs: list[list[int]] = []
    numbers = [int(row) for row in rows]
    for row in numbers:
        if runs and row == runs[-1][-1] + 1:
            runs[-1][1:] = [row]
        else:
            runs.append([row])
    shown = [f"{run[0]}-{run[-1]}" if len(run) > 1 else f"{run[0]}" for run in runs[:MAX_PLACES]]
    more = f" and {len(runs) - MAX_PLACES} more places" if len(runs) > MAX_PLACES else ""
    return f"row{'s' if len(numbers) > 1 else ''} {', '.join(shown)}{more}"


def quoted(names: Sequence[str]) -> str:
    """`'a', 'b', 'c'`."""
    return ", ".join(f"'{name}'" for name in names)
