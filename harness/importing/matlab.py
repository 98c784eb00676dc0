"""MAT-files of every version, and which groups of signals the variables in them are.

Version 5 and older are read by SciPy, version 7.3 (HDF5) by h5py, and variables with objects in them by mat-io; all
become the same tree of dictionaries (structs), lists (struct arrays and cells), arrays, texts, signals, `Series` and
`Opaque`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.importing.bytes import sha256_of
from harness.importing.cells import measured
from harness.importing.matlab5 import read_tree as read_tree_5
from harness.importing.matlab73 import read_tree as read_tree_73
from harness.importing.matlab_objects import Unreadable, read_objects
from harness.importing.matlab_tree import FEWEST, MOST_SIGNALS, Opaque, Series
from harness.importing.signals import Group, Signal, SourceFile, group_of, unique_names

HDF5 = b"\x89HDF\r\n\x1a\n"
ROUNDING = 1e-6  # of stamps, in steps between them


def read_matlab(path: Path) -> SourceFile:
    """Reads the numeric signals of a MAT-file.

    Raises:
        InputError: it cannot be read, or holds no signals that can be read outside MATLAB.
    """
    with path.open("rb") as stream:
        head = stream.read(1024)
    version = "7.3" if HDF5 in head else "5"
    tree = read_tree_73(path) if version == "7.3" else read_tree_5(path)
    tree, fault = _with_objects(path, tree)
    unread = list(_opaque("", tree))
    objects = _objects_left_out([(name, one) for name, one in unread if one.of_class], fault)
    others = [f"{name} ({one.kind})" for name, one in unread if not one.of_class]
    groups, kinds = [], []
    for group, kind in _groups("", tree):
        groups.append(group)
        kinds.append(kind)
    if not groups:
        raise InputError(f"{path}: {objects}." if objects else f"{path}: a MAT-file without numeric signals in it.")
    words = ", ".join(dict.fromkeys(kinds))
    return SourceFile(
        path,
        sha256_of(path),
        f"MAT-file, version {version}: {words}",
        _top_level_joined(groups),
        (
            *((f"left out: {objects}",) if objects else ()),
            *((f"left out: {', '.join(others)}",) if others else ()),
        ),
    )


def _with_objects(path: Path, tree: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The tree with the objects in it, and why they could not be read; empty if they could."""
    held = {name: node for name, node in tree.items() if any(one.of_class for _, one in _opaque("", node))}
    if not held:
        return tree, ""
    try:
        return tree | read_objects(path, held), ""
    except Unreadable as error:
        return tree, str(error)


def _objects_left_out(objects: Sequence[tuple[str, Opaque]], fault: str) -> str:
    """Objects that could not be read, why, and what to type in MATLAB; empty if there are none."""
    if not objects:
        return ""
    named: dict[str, list[str]] = {}
    for name, one in objects:
        why = one.reason or fault or "no timeseries, timetable, table or Dataset"
        named.setdefault(why, []).append(f"{name} ({one.kind})")
    listed = "; ".join(f"{', '.join(names)}: {why}" for why, names in named.items())
    lines = [line for kind, line in _PLAIN.items() if any(one.kind.startswith(kind) for _, one in objects)]
    typed = "; ".join((*lines, "save('plain.mat','t','y')"))
    return f"{listed}. To save plain arrays instead, type in MATLAB: {typed}"


_PLAIN = {
    "Simulink.": "for a logged signal, x = out.logsout.get('NAME').Values; t = x.Time; y = x.Data",
    "timeseries": "for a timeseries x, t = x.Time; y = x.Data",
    "timetable": "for a timetable x, t = seconds(x.Time - x.Time(1)); y = x.NAME",
}
"""What makes plain arrays of an object, by the beginning of its class."""


def _opaque(name: str, node: Any) -> Iterator[tuple[str, Opaque]]:
    if isinstance(node, Opaque):
        yield name, node
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from _opaque(f"{name}.{key}" if name else key, value)
    elif isinstance(node, list):
        for number, value in enumerate(node, start=1):
            yield from _opaque(f"{name}({number})", value)


def _groups(name: str, node: Any) -> Iterator[tuple[Group, str]]:
    """Groups below a node, with their kind in words."""
    if isinstance(node, dict):
        simulink = _structure_with_time(name, node)
        if simulink is not None:
            yield simulink, "Simulink structure with time"
            return
        series = _series(name, node)
        if series is not None:
            yield series, "structure of time and data"
            return
        plain: dict[int, list[Signal]] = {}
        for key, value in node.items():
            full = f"{name}.{key}" if name else key
            if isinstance(value, np.ndarray):
                for signal in _columns(full, value):
                    plain.setdefault(len(signal.values), []).append(signal)
            elif isinstance(value, Signal):
                if len(value.values) >= FEWEST:
                    plain.setdefault(len(value.values), []).append(value)
            elif not isinstance(value, Series):
                yield from _groups(full, value)
        for signals in plain.values():
            titles = unique_names([one.name for one in signals])
            yield group_of(name, [replace(one, name=to) for to, one in zip(titles, signals, strict=True)]), "variables"
        yield from _by_stamps(name, [one for one in node.values() if isinstance(one, Series)])
    elif isinstance(node, list):
        for number, value in enumerate(node, start=1):
            if isinstance(value, dict | list):
                yield from _groups(f"{name}({number})", value)
            elif isinstance(value, np.ndarray | Signal):
                yield from _groups("", {f"{name}{{{number}}}": value})
        yield from _by_stamps(name, [one for one in node if isinstance(one, Series)])


def _by_stamps(name: str, series: Sequence[Series]) -> Iterator[tuple[Group, str]]:
    """A group for all series that share their stamps; the names of their signals are of their own in all of them."""
    titles = iter(unique_names([one.name for each in series for one in each.columns]))
    made: list[tuple[Series, list[Signal]]] = []
    for each in series:
        signals = next((known for one, known in made if _same_stamps(one.time, each.time)), None)
        if signals is None:
            signals = []
            made.append((each, signals))
        signals += [replace(one, name=next(titles)) for one in each.columns]
    for first, signals in made:
        time = unique_names([*(one.name for one in signals), first.time.name])[-1]
        yield group_of(name, [replace(first.time, name=time), *signals], time=time), first.kind


def _same_stamps(one: Signal, other: Signal) -> bool:
    """Whether stamps are equal but for rounding: some are stored one by one, and some as start and increment."""
    if one.unit != other.unit or len(one.values) != len(other.values):
        return False
    step = float(np.ptp(one.values)) / len(one.values)
    return bool(np.allclose(one.values, other.values, rtol=0.0, atol=ROUNDING * step, equal_nan=True))


def _structure_with_time(name: str, node: dict[str, Any]) -> Group | None:
    """What To Workspace and Scope blocks save: `time`, and `signals(k).values` with `.label`."""
    signals, time = node.get("signals"), node.get("time")
    parts = [signals] if isinstance(signals, dict) else signals
    if not isinstance(parts, list) or not all(isinstance(one, dict) and "values" in one for one in parts) or not parts:
        return None
    made: list[Signal] = []
    count = int(np.size(time)) if isinstance(time, np.ndarray) and np.size(time) else None
    for number, part in enumerate(parts, start=1):
        values = part["values"]
        if not isinstance(values, np.ndarray):
            continue
        if values.ndim == 3:  # scalars by time along the third dimension
            values = values.reshape(-1, values.shape[2]).T
        if count is not None and values.shape[0] != count and values.shape[-1] == count:
            values = values.T
        label = next((str(part[key]) for key in ("label", "title", "blockName") if part.get(key)), f"signal {number}")
        columns = values.reshape(values.shape[0], -1)
        for column in range(columns.shape[1]):
            title = label if columns.shape[1] == 1 else f"{label}({column + 1})"
            made.append(Signal(title, measured(np.asarray(columns[:, column], dtype=np.float64))))
    if count is not None and isinstance(time, np.ndarray):
        made = [Signal("time", np.ravel(time).astype(np.float64), "s", "Simulink")] + [
            one for one in made if len(one.values) == count
        ]
    made = [one for one in made if len(one.values) == len(made[0].values) >= FEWEST]
    if len(made) < 2:
        return None
    titles = unique_names([one.name for one in made])
    named = [Signal(title, one.values, one.unit, one.unit_from) for title, one in zip(titles, made, strict=True)]
    return group_of(name, named, time="time" if count is not None else None)


def _series(name: str, node: dict[str, Any]) -> Group | None:
    """A struct that a timeseries was converted to: `Time` and `Data`."""
    keys = {key.casefold(): key for key in node}
    time, data = (node.get(keys.get(one, "")) for one in ("time", "data"))
    if not isinstance(time, np.ndarray) or not isinstance(data, np.ndarray) or np.size(time) < FEWEST:
        return None
    columns = _columns(str(node.get(keys.get("name", ""), "") or "Data"), data)
    if not columns or any(len(one.values) != np.size(time) for one in columns):
        return None
    return group_of(
        name, [Signal("Time", np.ravel(time).astype(np.float64), "s", "MATLAB timeseries"), *columns], time="Time"
    )


def _columns(name: str, values: Any) -> list[Signal]:
    """The signals of a numeric array: a vector, the columns of a matrix, or its rows where it is wider than high."""
    if not np.issubdtype(values.dtype, np.number) or np.iscomplexobj(values):
        return []
    matrix = np.squeeze(np.asarray(values, dtype=np.float64))
    if matrix.ndim == 1:
        return [Signal(name, measured(matrix))] if len(matrix) >= FEWEST else []
    if matrix.ndim != 2 or min(matrix.shape) > MOST_SIGNALS:
        return []
    along = matrix if matrix.shape[0] >= matrix.shape[1] else matrix.T
    return [Signal(f"{name}({at + 1})", measured(along[:, at])) for at in range(along.shape[1])]


def _top_level_joined(groups: Sequence[Group]) -> tuple[Group, ...]:
    """Groups without a name and a time are plain variables of the workspace: those of one length belong together."""
    own = [group for group in groups if group.name or group.time]
    plain: dict[int, list[Signal]] = {}
    for group in groups:
        if not (group.name or group.time):
            plain.setdefault(len(group.rows), []).extend(group.signals)
    return (*(group_of("", signals) for signals in plain.values()), *own)
