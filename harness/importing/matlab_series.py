"""A `timeseries` and a `timetable` of MATLAB as signals with their time.

The properties of a `timeseries` are those that MATLAB's own `timeseries.m` and `+tsdata/timemetadata.m` declare as
stored: `Data_`, `DataInfo.Units`, and in `TimeInfo` either `Time_` or `Start_`, `Increment_` and `Length`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from harness.importing.cells import measured
from harness.importing.matlab_tree import FEWEST, MOST_SIGNALS, Opaque, Series
from harness.importing.matlab_values import number, numbers, properties, text
from harness.importing.signals import Signal

UNNAMED = "unnamed"
"""What MATLAB calls a timeseries that was given no name."""


def name_of(series: Any) -> str:
    """The name that a `timeseries` was given; empty if it was given none."""
    given = text(properties(series).get("Name"))
    return "" if given == UNNAMED else given


def of_timeseries(series: Any, name: str) -> Series | Opaque:
    """The signals of a `timeseries`; those of a vector or matrix are numbered in MATLAB's order.

    Args:
        name: of the signals.
    """
    stored = properties(series)
    data = numbers(stored.get("Data_"))
    if data is None:
        return _refused("its data are no real numbers")
    if not data.size:
        return _refused("it holds no data")
    information = properties(stored.get("TimeInfo"))
    stamps = _stamps(stored, information)
    count = number(information.get("Length")) if stamps is None else len(stamps)
    if count is None:
        return _refused("it holds no time")
    size = "-by-".join(map(str, data.shape))
    rows = _rows(data, count)
    if rows is None:
        return _refused(f"its time has {count:g} values and its data are {size}")
    if len(rows) < FEWEST or rows.shape[1] > MOST_SIGNALS:
        return _refused(f"its data are {size}; at least {FEWEST} samples of at most {MOST_SIGNALS} signals are read")
    if stamps is None:
        stamps = _even_stamps(information, len(rows))
    if stamps is None:
        return _refused("its time has neither stamps nor a start and an increment")
    unit = _unit(properties(stored.get("DataInfo")).get("Units"))
    time_unit = text(information.get("Units"))
    return Series(
        "timeseries",
        Signal("Time", stamps, time_unit, "TimeInfo.Units" if time_unit else ""),
        tuple(
            Signal(title, measured(rows[:, at]), unit, "DataInfo.Units" if unit else "")
            for at, title in enumerate(_titles(name, rows.shape[1]))
        ),
    )


def _stamps(stored: Any, information: Any) -> FloatArray | None:
    """Stamps that are stored one by one; before 2010 in the object itself."""
    for value in (information.get("Time_"), stored.get("Time_")):
        stamps = numbers(value)
        if stamps is not None and stamps.size:
            return stamps.ravel()
    return None


def _even_stamps(information: Any, count: int) -> FloatArray | None:
    """Stamps that are stored as start and increment, shape (count,); `None` if they are not."""
    start, step = number(information.get("Start_")), number(information.get("Increment_"))
    if start is None or step is None or step <= 0.0:
        return None
    return np.asarray(start + step * np.arange(count), dtype=np.float64)


def _rows(data: FloatArray, count: float) -> FloatArray | None:
    """One row a sample, shape (count, signals); `None` if no dimension is as long as the time.

    MATLAB's rule: the first dimension of a matrix is the time, the last one of an array of more dimensions.
    """
    if data.ndim == 2 and data.shape[0] == count:
        return data
    if data.shape[-1] == count:
        return data.reshape(-1, data.shape[-1], order="F").T
    return None


def _titles(name: str, count: int) -> list[str]:
    return [name] if count == 1 else [f"{name}({at + 1})" for at in range(count)]


def _unit(value: Any) -> str:
    """A unit, which is a text or a `Simulink.SimulationData.Unit`."""
    return text(value) or text(properties(value).get("Name"))


def _refused(reason: str) -> Opaque:
    return Opaque("timeseries", of_class=True, reason=reason)


def is_timetable(frame: Any) -> bool:
    """Whether a data frame has the row times of a timetable."""
    return frame.index.dtype.kind in "mM"


def of_timetable(frame: Any, name: str = "") -> Series | Opaque:
    """The columns of numbers of a `timetable`, which mat-io returns as a data frame.

    Args:
        name: of the column if there is only one; if empty, it has that of the timetable's variable.
    """
    columns = columns_of(frame, "varUnits")
    if name and len(columns) == 1:
        columns = (replace(columns[0], name=name),)
    if len(frame) < FEWEST or not columns:
        reason = (
            f"it has {len(frame)} rows and {len(columns)} columns of numbers; at least {FEWEST} rows of one are read"
        )
        return Opaque("timetable", of_class=True, reason=reason)
    return Series("timetable", Signal("Time", seconds(frame.index.to_numpy()), "s", "its row times"), columns)


def columns_of(frame: Any, units_in: str) -> tuple[Signal, ...]:
    """The columns of numbers, dates and durations of a data frame.

    Args:
        units_in: the attribute that holds the units, one a variable. Variables of several columns are split by mat-io,
            so that units belong to nothing where their number is not that of the columns.
    """
    units = frame.attrs.get(units_in, [])
    if len(units) != frame.shape[1]:
        units = [""] * frame.shape[1]
    made = []
    for at, unit in enumerate(units):
        name, column = str(frame.columns[at]), frame.iloc[:, at]
        if column.dtype.kind in "mM":
            made.append(Signal(name, seconds(column.to_numpy()), "s", "its type"))
        elif column.dtype.kind in "biuf":
            values = measured(column.to_numpy(dtype=np.float64))
            made.append(Signal(name, values, unit, "VariableUnits" if unit else ""))
    return tuple(made)


def seconds(stamps: Any) -> FloatArray:
    """Durations, or dates since the first, shape (n,) [s]; NaN where one is missing."""
    missing = np.isnat(stamps)
    if stamps.dtype.kind == "M":
        stamps = stamps - stamps[np.argmin(missing)] if len(stamps) else stamps.astype("timedelta64[ns]")
    return np.where(missing, np.nan, stamps / np.timedelta64(1, "s"))
