"""Warnings and notes on input that was read successfully."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

MAX_PLACES = 5  # rows or recordings named in one message

STOPPING: Mapping[str, str] = {
    "angle-sign": "the sign of angle or position is reversed",
    "swapped-columns": "angle and position are exchanged",
    "angle-unit": "the angle is in another unit",
    "wrapped-angle": "the angle is wrapped at a whole turn",
    "position-unit": "the position is in another unit",
    "time-unit": "the time is in another unit",
    "units": "the ball's acceleration does not fit the tilt, in no known units",
    "rate": "the time stamps are too fast or too slow for this rig",
    "undersampled-angle": "the beam turns faster than its angle is recorded",
    "density": "no ball has this mass and radius",
}
"""Codes of findings that make a verdict worthless, with their meaning: they stop a diagnosis unless accepted."""


@dataclass(frozen=True)
class DataFinding:
    """A warning or note on the input, shown with every result.

    Attributes:
        severity: `warning` if it may make a result wrong, else `note`.
        where: file, with row and column if they apply.
        text: what was found, and the remedy.
        code: short name of what was found, the same in every version.
    """

    severity: Literal["warning", "note"]
    where: str
    text: str
    code: str

    @property
    def stops(self) -> bool:
        """Whether a diagnosis of this input is worthless unless the finding is accepted."""
        return self.code in STOPPING

    def __str__(self) -> str:
        return f"{self.severity}: {self.where}: {self.text} [{self.code}]"


def warnings_of(findings: Iterable[DataFinding]) -> tuple[DataFinding, ...]:
    """Those that may make a result wrong; what stops a diagnosis comes first."""
    return tuple(
        sorted((one for one in findings if one.severity == "warning"), key=lambda one: one.code not in STOPPING)
    )


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


def abbreviated(texts: Sequence[str], most: int = MAX_PLACES) -> str:
    """`a, b, c`, or the first `most` and how many there are more."""
    more = f" and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def quoted(names: Sequence[str]) -> str:
    """`'a', 'b', 'c'`."""
    return ", ".join(f"'{name}'" for name in names)
