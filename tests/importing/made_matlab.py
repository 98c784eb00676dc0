"""Objects of MATLAB with the properties that their classes declare as stored, written by mat-io."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matio import save_to_mat
from matio.utils import MatlabOpaque
from numpy.typing import ArrayLike

SIMULINK = "Simulink.SimulationData"
DATASET, STORAGE, SIGNAL = f"{SIMULINK}.Dataset", f"{SIMULINK}.Storage.RamDatasetStorage", f"{SIMULINK}.Signal"
EMPTY = np.empty((0, 0))
VERSIONS = ("v7", "v7.3")


def save(path: Path, variables: dict[str, Any], version: str = "v7", *, compressed: bool = True) -> Path:
    """A MAT-file of version `v7` or `v7.3`."""
    classes = [DATASET, STORAGE]
    save_to_mat(str(path), variables, version=version, saveobj_classes=classes, do_compression=compressed)
    return path


def text(value: str) -> Any:
    """A character vector."""
    return np.array([value])


def scalar(value: float) -> Any:
    """A number, which MATLAB has as a matrix."""
    return np.array([[float(value)]])


def cell(*values: Any) -> Any:
    """A row of cells."""
    made = np.empty((1, len(values)), dtype=object)
    made[0, :] = values
    return made


def struct(**values: Any) -> Any:
    """A struct."""
    made = np.empty((1, 1), dtype=[(name, object) for name in values])
    made[0, 0] = tuple(values.values())
    return made


def timeseries(
    data: ArrayLike,
    stamps: ArrayLike | None = None,
    *,
    uniform: tuple[float, float, float] | None = None,
    name: str = "",
    unit: Any = "",
    time_unit: str = "seconds",
    **changed: Any,
) -> MatlabOpaque:
    """A `timeseries`.

    Args:
        data: a vector becomes a column.
        stamps: stored one by one.
        uniform: start, increment and length that are stored instead.
        unit: a text or a `Simulink.SimulationData.Unit`.
        changed: other values of its properties.
    """
    values = np.asarray(data)
    stored = EMPTY if stamps is None else np.asarray(stamps, dtype=np.float64).reshape(-1, 1)
    start, increment, length = (EMPTY, EMPTY, scalar(stored.size)) if uniform is None else map(scalar, uniform)
    time = {
        "Units": text(time_unit), "UserData": EMPTY, "Format": text(""), "StartDate": text(""), "Length": length,
        "DuplicateTimes": EMPTY, "Time_": stored, "Start_": start, "Increment_": increment, "Version": scalar(10.1),
        "Initialized": np.array([[True]]),
    }  # fmt: skip
    information = {
        "Units": text(unit) if isinstance(unit, str) else unit, "UserData": EMPTY, "Version": scalar(10.1),
        "InterpretSingleRowDataAs3D": np.array([[False]]),
    }  # fmt: skip
    series = {
        "Events": EMPTY, "Name": text(name), "UserData": EMPTY,
        "DataInfo": MatlabOpaque(information, "tsdata.datametadata"),
        "TimeInfo": MatlabOpaque(time, "tsdata.timemetadata"),
        "TreatNaNasMissing": np.array([[True]]),
        "Data_": values.reshape(-1, 1) if values.ndim == 1 else values, "Time_": EMPTY, "Quality_": EMPTY,
        "IsTimeFirst_": np.array([[True]]), "Storage_": EMPTY, "Version": scalar(10.2),
        "BeingBuilt": np.array([[False]]),
    }  # fmt: skip
    return MatlabOpaque(series | changed, "timeseries")


def signal(name: str, values: Any, block: str = "model/Gain") -> MatlabOpaque:
    """A logged signal."""
    path = MatlabOpaque({"path": cell(text(block))}, f"{SIMULINK}.BlockPath")
    stored = {
        "Name": text(name), "PropagatedName": text(""), "BlockPath": path, "PortType": text("outport"),
        "PortIndex": scalar(1.0), "Values": values, "Version": scalar(1.0),
    }  # fmt: skip
    return MatlabOpaque(stored, SIGNAL)


def dataset(elements: Sequence[Any]) -> MatlabOpaque:
    """A Dataset as MATLAB saves it since R2015a: `saveobj` of the Dataset, and that of its storage."""
    storage = MatlabOpaque({"any": struct(Version=scalar(2.0), Elements=cell(*elements))}, STORAGE)
    return MatlabOpaque({"any": struct(Name=text("logsout"), Version=scalar(3.0), Storage=storage)}, DATASET)


def output(**variables: Any) -> MatlabOpaque:
    """What `sim` returns."""
    return MatlabOpaque({"Data": struct(**variables), "ErrorMessage": text("")}, "Simulink.SimulationOutput")
