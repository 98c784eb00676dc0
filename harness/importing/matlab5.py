"""MAT-files of version 4 to 7.2, by SciPy."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS, InputError
from harness.importing.matlab_tree import Opaque

DEEPEST = 12  # structs within structs


def read_tree(path: Path) -> dict[str, Any]:
    """All variables of a file.

    Raises:
        InputError: the file is damaged, or no MAT-file.
    """
    from scipy.io import loadmat

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on objects, which are told by name
            content = loadmat(path, struct_as_record=False, squeeze_me=False)
    except INTERRUPTS:
        raise
    except Exception as error:  # SciPy raises whatever a damaged file leads to
        raise InputError(
            f"{path}: cannot be read as a MAT-file ({type(error).__name__}: {error}). Save it again from MATLAB."
        ) from None
    return {name: _node(value) for name, value in content.items() if not name.startswith("__") or name == "__"}


def _node(value: Any, depth: int = 0) -> Any:
    from scipy.io.matlab import MatlabFunction, MatlabOpaque, mat_struct

    if depth > DEEPEST:
        return Opaque("nested too deeply")
    if isinstance(value, MatlabOpaque):
        return Opaque(_class_of(value))
    if isinstance(value, MatlabFunction):
        return Opaque("function handle")
    if isinstance(value, mat_struct):
        names = getattr(value, "_fieldnames", [])
        return {str(name): _node(getattr(value, name), depth + 1) for name in names}
    if isinstance(value, np.ndarray):
        if value.dtype == object:
            made = [_node(one, depth + 1) for one in value.ravel(order="F")]
            return made[0] if len(made) == 1 and isinstance(made[0], dict) else made
        if value.dtype.kind in "US":
            return str(value.ravel()[0]).strip() if value.size else ""
        if value.dtype.kind in "biuf":
            return value
    return Opaque(type(value).__name__)


def _class_of(value: Any) -> str:
    names = value.dtype.names or ()
    for key in ("s2", "_Class", "classname"):
        if key in names:
            found = value[key].ravel()[0]
            return found.decode(errors="replace") if isinstance(found, bytes) else str(found)
    return "object"
