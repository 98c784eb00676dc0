"""MAT-files of every version, and which groups of signals the variables in them are.

Version 5 and older are read by SciPy, version 7.3 (HDF5) by h5py; both become the same tree of dictionaries (structs),
lists (struct arrays and cells), arrays, texts and `Opaque` objects.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.importing.bytes import sha256_of
from harness.importing.cells import measured
from harness.importing.matlab5 import read_tree as read_tree_5
from harness.importing.matlab73 import read_tree as read_tree_73
from harness.importing.matlab_tree import Opaque
from harness.importing.signals import Group, Signal, SourceFile, group_of, unique_names

HDF5 = b"\x89HDF\r\n\x1a\n"
MOST_SIGNALS = 64  # of a matrix, along its shorter side
FEWEST = 3  # values of a signal


def read_matlab(path: Path) -> SourceFile:
    """Reads the numeric signals of a MAT-file.

    Raises:
        InputError: it cannot be read, or holds no signals that can be read outside MATLAB.
    """
    with path.open("rb") as stream:
        head = stream.read(1024)
    version = "7.3" if HDF5 in head else "5"
    tree = read_tree_73(path) if version == "7.3" else read_tree_5(path)
    unread = list(_opaque("", tree))
    objects = [f"{name} ({one.kind})" for name, one in unread if one.of_class]
    others = [f"{name} ({one.kind})" for name, one in unread if not one.of_class]
    groups, kinds = [], []
    for group, kind in _groups("", tree):
        groups.append(group)
        kinds.append(kind)
    advice = (
        f"{', '.join(objects)}: a MATLAB object, whose data are stored in a form that MATLAB does not document. For "
        "a timeseries x, save plain arrays there: t = x.Time; y = x.Data; save('plain.mat','t','y'). For "
        "logged Simulink signals: x = out.logsout.get('NAME').Values. Or let To Workspace blocks save 'Structure With "
        "Time'"
    )
    if not groups:
        raise InputError(f"{path}: {advice}." if objects else f"{path}: a MAT-file without numeric signals in it.")
    words = ", ".join(dict.fromkeys(kinds))
    return SourceFile(
        path,
        sha256_of(path),
        f"MAT-file, version {version}: {words}",
        _top_level_joined(groups),
        (
            *((f"left out: {advice}",) if objects else ()),
            *((f"left out: {', '.join(others)}",) if others else ()),
        ),
    )


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
            else:
                yield from _groups(full, value)
        for signals in plain.values():
            titles = unique_names([one.name for one in signals])
            named = [Signal(title, one.values) for title, one in zip(titles, signals, strict=True)]
            yield group_of(name, named), "variables"
    elif isinstance(node, list):
        for number, value in enumerate(node, start=1):
            if isinstance(value, dict | list):
                yield from _groups(f"{name}({number})", value)
            elif isinstance(value, np.ndarray):
                yield from _groups("", {f"{name}{{{number}}}": value})


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
    """Groups without a name are the variables of the workspace: those of one length belong together."""
    named = [group for group in groups if group.name]
    plain: dict[int, list[Signal]] = {}
    for group in groups:
        if not group.name:
            plain.setdefault(len(group.rows), []).extend(group.signals)
    return (*(group_of("", signals) for signals in plain.values()), *named)
