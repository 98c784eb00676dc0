"""Cells of text as numbers: decimal commas, missing values, dates and clock times."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from analytic.motion import FloatArray
from harness.recording.table import MAX_VALUE, MISSING

_NUMBER = re.compile(r"[+\-−]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)
# A date, a clock time, or both, as loggers and spreadsheets write them.
_STAMP = re.compile(
    r"(\d{4}-\d{1,2}-\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{2,4})?[T ]?\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?(Z|[+-]\d{2}:?\d{2})?"
)
_DATE = re.compile(r"\d{4}-\d{1,2}-\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{2,4}|\d{4}/\d{1,2}/\d{1,2}")


def is_number(cell: str) -> bool:
    """Whether a cell is one number."""
    return bool(_NUMBER.fullmatch(cell)) or cell.casefold() in ("inf", "-inf", "+inf")


def is_stamp(cell: str) -> bool:
    """Whether a cell is a date with a time, or a clock time."""
    return ":" in cell and bool(_STAMP.fullmatch(cell))


def is_date(cell: str) -> bool:
    """Whether a cell is a date without a time, which loggers write in a column of its own."""
    return bool(_DATE.fullmatch(cell))


def is_missing(cell: str) -> bool:
    """Whether a cell stands for a value that is not known."""
    return cell.casefold() in MISSING


def numbers(cells: Sequence[str]) -> FloatArray | None:
    """The cells as numbers, shape (n,), NaN where one is missing; `None` if one is something else.

    Numbers too large to be measured, which loggers write for "no value", are missing.
    """
    texts = [cell.replace(",", ".").replace("−", "-").replace("D", "e").replace("d", "e") for cell in cells]
    values = np.full(len(cells), np.nan)
    for index, (cell, text) in enumerate(zip(cells, texts, strict=True)):
        if is_number(cell):
            values[index] = float(text)
        elif not is_missing(cell):
            return None
    return measured(values)


def measured(values: FloatArray) -> FloatArray:
    """The values, NaN where one is infinite or too large to be measured."""
    return np.where(np.abs(values) < MAX_VALUE, values, np.nan)


def seconds(cells: Sequence[str]) -> FloatArray | None:
    """Dates or clock times as seconds since the first, shape (n,); `None` if a cell is none of these.

    A clock that passes midnight goes on.
    """
    import pandas as pd  # takes a second, which only files with dates are worth

    known = [cell for cell in cells if not is_missing(cell)]
    if not known or not all(map(is_stamp, known)):
        return None
    texts = pd.Series([None if is_missing(cell) else cell.replace(",", ".") for cell in cells], dtype="object")
    clock = bool(re.match(r"\d{1,2}:", known[0]))
    dotted = bool(re.match(r"\d{1,2}[./]", known[0]))
    try:
        if clock:
            padded = texts.map(lambda one: None if one is None else one if one.count(":") == 2 else f"{one}:00")
            made = pd.to_timedelta(padded).dt.total_seconds().to_numpy(dtype=np.float64)
        else:
            stamps = pd.to_datetime(texts, dayfirst=dotted, format="mixed", utc=True)
            made = (stamps - stamps.dropna().iloc[0]).dt.total_seconds().to_numpy(dtype=np.float64)
    except (ValueError, OverflowError):
        return None
    if clock:
        midnight = np.concatenate(([0.0], np.cumsum(np.where(np.diff(made) < -43200.0, 86400.0, 0.0))))
        made = made + midnight
        made -= made[np.isfinite(made)][0]
    return np.asarray(made, dtype=np.float64)
