"""Cells of text as numbers: decimal commas, missing values."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from analytic.motion import FloatArray
from harness.recording.table import MAX_VALUE, MISSING

_NUMBER = re.compile(r"[+\-−]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)


def is_number(cell: str) -> bool:
    """Whether a cell is one number."""
    return bool(_NUMBER.fullmatch(cell)) or cell.casefold() in ("inf", "-inf", "+inf")


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
