"""Which rows the user wants: those in which a column has a value, such as the state of a controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.importing.cells import numbers
from harness.importing.distinct import known_values
from harness.importing.signals import Group, Signal
from harness.recording.findings import abbreviated, quoted

_MOST_SHOWN = 12  # values of a column in a message
_SINGLE = float(np.finfo(np.float32).eps)  # relative rounding of a column in single precision


def only_where(path: Path, groups: Sequence[Group], where: Sequence[str]) -> tuple[tuple[Group, ...], tuple[str, ...]]:
    """The groups with the rows wanted, and notes on how many these are.

    A group without the column keeps all its rows. Rows left out leave a gap in time.

    Args:
        where: each `COLUMN=VALUE`; of several values of a column one is enough, of several columns each counts.

    Raises:
        InputError: no group has the column, or no row the value.
    """
    wanted: dict[str, list[str]] = {}
    for text in where:
        column, sign, value = text.partition("=")
        if not sign or not column.strip():
            raise InputError(f"--where '{text}': write COLUMN=VALUE, such as state=RUNNING.")
        wanted.setdefault(column.strip(), []).append(value.strip())
    made, notes = tuple(groups), []
    for column, values in wanted.items():
        masks = [_mask(group, column, values) for group in made]
        if all(mask is None for mask in masks):
            names = [name for group in groups for name in (*(one.name for one in group.signals), *group.words)]
            hint = did_you_mean(column, names) or f" It has {quoted(names[:20])}."
            raise InputError(f"{path}: --where: there is no column '{column}'.{hint}")
        kept = sum(int(mask.sum()) for mask in masks if mask is not None)
        if not kept:
            seen = dict.fromkeys(value for group in made for value in _texts(group, column))
            has = abbreviated([f"'{value}'" for value in seen], most=_MOST_SHOWN)
            raise InputError(f"{path}: --where: no row has {column} = {' or '.join(values)}; it has {has}.")
        every = sum(len(mask) for mask in masks if mask is not None)
        notes.append(f"{kept} of {every} rows have {column} = {' or '.join(values)}; the others are left out")
        made = tuple(group if mask is None else _only(group, mask) for group, mask in zip(made, masks, strict=True))
    return made, tuple(notes)


def _signal(group: Group, column: str) -> Signal | None:
    return next((one for one in group.signals if column in (one.name, group.qualified(one))), None)


def _texts(group: Group, column: str) -> Sequence[str]:
    """The column's values as a message shows them, none if the group does not have it."""
    signal = _signal(group, column)
    return group.words.get(column, ()) if signal is None else [f"{value:g}" for value in known_values(signal)]


def _mask(group: Group, column: str, values: Sequence[str]) -> NDArray[np.bool_] | None:
    """Which rows have one of the values, shape (n,); `None` if the group does not have the column."""
    if column in group.words:
        same = {value.casefold() for value in values}
        return np.array([cell.casefold() in same for cell in group.words[column]])
    signal = _signal(group, column)
    if signal is None:
        return None
    asked = [number for value in values if (number := numbers([value])) is not None]
    matches = np.isclose(signal.values, np.reshape(asked, (-1, 1)), rtol=_SINGLE, atol=0.0)
    return np.asarray(matches.any(axis=0), dtype=np.bool_)


def _only(group: Group, mask: NDArray[np.bool_]) -> Group:
    places = np.arange(len(mask)) if group.places is None else group.places
    signals = tuple(replace(one, values=one.values[mask]) for one in group.signals)
    words = {name: tuple(np.array(cells, dtype=object)[mask]) for name, cells in group.words.items()}
    return replace(group, signals=signals, rows=group.rows[mask], words=words, places=places[mask])
