"""JSON: a list of records, lists side by side, or a record a line."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from harness.errors import InputError
from harness.importing.grid import FEWEST_ROWS, Sheet, group_of_sheet
from harness.importing.signals import Group, SourceFile, unique_names
from harness.recording.findings import place
from harness.recording.source import read_source

NAMES = (".json", ".jsonl", ".ndjson")
_DEEPEST = 20  # levels of objects in each other


def read_json(path: Path) -> SourceFile:
    """Reads every table of a file of JSON, or of JSON lines.

    Raises:
        InputError: it is damaged, or holds no table.
    """
    source = read_source(path)
    content, kind = _content(path, source.text)
    groups: list[Group] = []
    notes: list[str] = []
    for name, table in _tables(content):
        sheet = _sheet(table)
        try:
            group, left_out = group_of_sheet(path, sheet, name)
        except InputError as error:
            notes.append(f"{name or 'table'} left out: {error}".removeprefix(f"{path}: "))
            continue
        groups.append(group)
        notes += left_out
    if not groups:
        raise InputError(
            f"{path}: no table of numbers in it. Write a list of records, such as "
            '[{"t": 0.0, "angle": 0.01, "x": 0.2}, …], or lists of the same length by name.'
        )
    if len(groups) == 1:
        groups = [replace(groups[0], name="")]
    return SourceFile(path, source.sha256, kind, tuple(groups), tuple(notes))


def _content(path: Path, text: str) -> tuple[Any, str]:
    """What a file holds, and what it is in words."""
    try:
        return json.loads(text), "JSON"
    except RecursionError:
        raise InputError(f"{path}: JSON of too many levels. Write a list of records.") from None
    except ValueError as error:  # also where an integer has thousands of digits
        first = error
    lines = [(number, line) for number, line in enumerate(text.split("\n"), start=1) if line.strip()]
    records = []
    for number, line in lines:
        try:
            records.append(json.loads(line))
        except (ValueError, RecursionError):
            if number == lines[-1][0] and len(records) >= FEWEST_ROWS:
                break  # a program that was stopped leaves its last line incomplete
            where = place(path, number if records else getattr(first, "lineno", number))
            raise InputError(f"{where}: no JSON ({first}). Check that the file was saved completely.") from None
    return records, "JSON lines"


def _tables(content: Any, name: str = "", depth: int = 0) -> list[tuple[str, pd.DataFrame]]:
    """Tables by where they are, in the file's order."""
    if depth > _DEEPEST:
        return []
    if isinstance(content, Sequence) and not isinstance(content, str):
        if len(content) < FEWEST_ROWS:
            return []
        if all(isinstance(one, Mapping) for one in content):
            return [(name, pd.json_normalize(list(content), max_level=_DEEPEST))]
        if all(isinstance(one, Sequence) and not isinstance(one, str) for one in content):
            return [(name, pd.DataFrame(list(content)).rename(columns=lambda at: f"column {at + 1}"))]
        return []
    if not isinstance(content, Mapping):
        return []
    columns = {str(key): value for key, value in content.items() if _is_column(value)}
    made: list[tuple[str, pd.DataFrame]] = []
    for length in dict.fromkeys(map(len, columns.values())):  # lists of one length are side by side
        same = {key: value for key, value in columns.items() if len(value) == length}
        made.append(
            (
                name if len(same) == len(columns) else f"{name}{'.' if name else ''}{next(iter(same))}",
                pd.DataFrame(same),
            )
        )
    for key, value in content.items():
        if not _is_column(value):
            made += _tables(value, f"{name}.{key}" if name else str(key), depth + 1)
    return made


def _is_column(value: Any) -> bool:
    """Whether something is a list of numbers, words or missing values."""
    listed = isinstance(value, list) and len(value) >= FEWEST_ROWS
    return listed and not any(isinstance(one, Mapping | list) for one in value)


def _sheet(table: pd.DataFrame) -> Sheet:
    names = tuple(unique_names([str(one) for one in table.columns]))
    cells = tuple([_cell(value) for value in row] for row in table.itertuples(index=False, name=None))
    return Sheet((), names, ("",) * len(names), cells, np.arange(1, len(cells) + 1), ())


def _cell(value: Any) -> str:
    """A value as a cell of text has it."""
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return ""
    if isinstance(value, int | float):  # repr of NumPy's numbers has the name of their type
        return repr(float(value) if isinstance(value, float) else int(value))
    return str(value)
