"""Objects in MAT-files of version 7 and 7.3, by mat-io: `timeseries`, `timetable`, `table`, and what Simulink logs.

Properties are those that the classes declare as stored in MATLAB's own files: a `Simulink.SimulationData.Dataset` is
saved as its name and a storage object, which holds the elements in a cell array; an element has a `Name` and `Values`.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS
from harness.importing.matlab_series import (
    UNNAMED,
    columns_of,
    is_timetable,
    name_of,
    of_timeseries,
    of_timetable,
    seconds,
)
from harness.importing.matlab_tree import DEEPEST, Opaque
from harness.importing.matlab_values import cells, properties, text
from harness.importing.signals import Signal, unique_names

MOST_PARTS = 10_000  # of one variable: an object may hold another one many times, and that again
DAMAGED = "the data it refers to are missing or damaged"
_REFERENCE = 0xDD000000  # begins what stands in the place of an object
_DATASET = "Simulink.SimulationData.Dataset"
_IN_RECORDS = "Simulink.SimulationData.Storage.MatFileDatasetStorage"


class Unreadable(Exception):
    """Why the objects of a file cannot be read, in words."""


def read_objects(path: Path, known: Mapping[str, Any]) -> dict[str, Any]:
    """Variables that are objects or hold some.

    Args:
        known: what they are by name, as far as it can be told without mat-io.

    Raises:
        Unreadable: mat-io is missing, or the file is damaged.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what could not be read is told by name
            from matio import load_from_mat

            content = load_from_mat(str(path), variable_names=list(known), add_table_attrs=True, spmatrix=False)
    except INTERRUPTS:
        raise
    except ImportError:
        raise Unreadable(
            "objects, which need the package mat-io. Install it: pip install 'ball-beam-harness[matlab]'"
        ) from None
    except Exception as error:  # mat-io raises whatever a damaged file leads to
        raise Unreadable(f"objects that cannot be read ({type(error).__name__}: {error})") from None
    return {name: _tree(content[name], name, before) for name, before in known.items() if name in content}


def _tree(value: Any, name: str, before: Any) -> Any:
    kind = before.kind if isinstance(before, Opaque) else "object"
    try:
        return _Tree(kind).node(value, name)
    except INTERRUPTS:
        raise
    except Exception as error:  # the parts of a damaged file are of any type
        return Opaque(kind, of_class=True, reason=f"it cannot be read ({type(error).__name__}: {error})")


class _Tree:
    """Converts one variable."""

    def __init__(self, kind: str) -> None:
        self.kind = kind  # of an object whose class mat-io does not say
        self.parts = 0

    def node(self, value: Any, name: str, depth: int = 0, *, named: bool = False) -> Any:
        """A value that mat-io returned.

        Args:
            name: under which it is stored.
            named: whether it is called so even if it has a name of its own.
        """
        from matio.utils import MatlabOpaque, MatlabOpaqueArray

        self.parts += 1
        if self.parts > MOST_PARTS:
            raise ValueError(f"more than {MOST_PARTS} parts")
        if depth > DEEPEST:
            return Opaque("nested too deeply")
        if isinstance(value, MatlabOpaque):
            return self._object(value, name, depth, named=named)
        if isinstance(value, MatlabOpaqueArray):
            return [self.node(one, f"{name}({at})", depth + 1) for at, one in enumerate(value.ravel("F"), start=1)]
        if hasattr(value, "columns") and hasattr(value, "iloc"):  # a data frame; to ask pandas takes a second
            if not is_timetable(value):
                return {one.name: one for one in columns_of(value, "VariableUnits")}
            made = of_timetable(value, name if named else "")
            return made if named or isinstance(made, Opaque) else {name: made}
        if isinstance(value, np.ndarray):
            return self._array(value, name, depth)
        return Opaque(type(value).__name__)

    def _object(self, value: Any, name: str, depth: int, *, named: bool) -> Any:
        kind = str(value.classname or self.kind)
        if not isinstance(value.properties, dict):
            empty, ours = isinstance(value.properties, tuple), value.type_system == "MCOS"
            return Opaque(kind, of_class=True, reason="it is empty" if empty else DAMAGED if ours else "")
        stored = properties(value)
        if kind == "timeseries":
            return of_timeseries(value, name if named else name_of(value) or name)
        if kind == _DATASET:
            return self._dataset(stored, depth)
        if kind == "Simulink.SimulationOutput":
            return self.node(stored.get("Data"), name, depth + 1)
        if kind.startswith("Simulink.SimulationData.") and "Values" in stored:
            return self.node(stored["Values"], name, depth + 1, named=named)
        return Opaque(kind, of_class=True)

    def _dataset(self, stored: Mapping[str, Any], depth: int) -> Any:
        """Elements by name. Before R2015a a Dataset held them itself."""
        storage = stored.get("Storage")
        if getattr(storage, "classname", "") == _IN_RECORDS:
            reason = "in version 7.3 Simulink keeps it in records of its own. Save it with save(FILE, 'NAME', '-v7')"
            return Opaque(_DATASET, of_class=True, reason=reason)
        elements = list(cells(properties(storage).get("Elements", stored.get("Elements"))))
        if not elements:
            return Opaque(_DATASET, of_class=True, reason="it holds no elements")
        names = unique_names([_name_of(one) or f"signal {at}" for at, one in enumerate(elements, start=1)])
        return {name: self.node(one, name, depth + 1, named=True) for name, one in zip(names, elements, strict=True)}

    def _array(self, value: Any, name: str, depth: int) -> Any:
        from matio.utils import MatlabFunction, MatlabObject

        if isinstance(value, MatlabFunction | MatlabObject):
            return Opaque("function handle" if isinstance(value, MatlabFunction) else "object of an old class")
        if value.dtype.names and value.dtype.hasobject:
            each = [
                {key: self.node(one[key], key, depth + 1) for key in value.dtype.names}
                for one in value.ravel(order="F")
            ]
            return each[0] if len(each) == 1 else each
        if value.dtype == object:
            return [self.node(one, f"{name}{{{at}}}", depth + 1) for at, one in enumerate(cells(value), start=1)]
        if value.dtype == np.uint32 and value.size and value.flat[0] == _REFERENCE:
            return Opaque(self.kind, of_class=True, reason=DAMAGED)
        if value.dtype.kind in "UT":
            return text(value)
        if value.dtype.kind in "mM" and value.size == max(value.shape):
            return Signal(name, seconds(value.ravel()), "s", "its type")
        return value if value.dtype.kind in "biuf" else Opaque("an array of another type")


def _name_of(element: Any) -> str:
    """The name of an element of a Dataset, or else of its signal, its series or its block; empty if it has none."""
    stored = properties(element)
    paths = [text(one) for one in cells(properties(stored.get("BlockPath")).get("path"))]
    # A slash within a block's name is written twice.
    block = re.split(r"(?<!/)/(?!/)", paths[-1])[-1].replace("//", "/") if paths else ""
    given = (text(stored.get("Name")), text(stored.get("PropagatedName")), name_of(stored.get("Values")), block)
    return next((one for one in given if one and one != UNNAMED), "")
