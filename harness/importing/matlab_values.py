"""Values within objects of MATLAB as mat-io returns them: texts, numbers, structs, properties; whatever they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from analytic.motion import FloatArray


def properties(value: Any) -> Mapping[str, Any]:
    """Properties of an object by name; those of a class with a `saveobj` are the fields of what that returned."""
    made = getattr(value, "properties", None)
    if not isinstance(made, dict):
        return {}
    return fields(made["any"]) if set(made) == {"any"} else made


def fields(value: Any) -> Mapping[str, Any]:
    """Fields of one struct by name; empty if the value is something else."""
    if not isinstance(value, np.ndarray) or value.dtype.names is None or value.size != 1:
        return {}
    return {name: value.flat[0][name] for name in value.dtype.names}


def cells(value: Any) -> Iterator[Any]:
    """Values of a cell array, in MATLAB's order."""
    if isinstance(value, np.ndarray) and value.dtype == object:
        yield from value.ravel(order="F")


def text(value: Any) -> str:
    """A text; empty if the value is none."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "UT" and value.size == 1:
        return str(value.ravel()[0]).strip()
    return value.strip() if isinstance(value, str) else ""


def number(value: Any) -> float | None:
    """A finite real number; `None` if the value is none."""
    made = numbers(value)
    return float(made.flat[0]) if made is not None and made.size == 1 and np.isfinite(made.flat[0]) else None


def numbers(value: Any) -> FloatArray | None:
    """An array of real numbers, of any shape; `None` if the value is none."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return np.asarray(value, dtype=np.float64)
    return None
