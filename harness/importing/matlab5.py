"""MAT-files of version 4 to 7.2, by SciPy."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS, InputError
from harness.importing.matlab_tree import DEEPEST, Opaque

NAMELESS = "None"
"""Under which SciPy returns an object."""


def read_tree(path: Path) -> dict[str, Any]:
    """All variables of a file.

    Raises:
        InputError: the file is damaged, or no MAT-file.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on objects, which are told by name
            content = _load(str(path))
            objects = _objects(path) if NAMELESS in content else {}
    except INTERRUPTS:
        raise
    except Exception as error:  # SciPy raises whatever a damaged file leads to
        raise InputError(
            f"{path}: cannot be read as a MAT-file ({type(error).__name__}: {error}). Save it again from MATLAB."
        ) from None
    plain = {name: value for name, value in content.items() if not name.startswith("__") and name != NAMELESS}
    return {name: _node(value) for name, value in plain.items()} | objects


def _load(file: Any) -> dict[str, Any]:
    from scipy.io import loadmat

    return loadmat(file, struct_as_record=False, squeeze_me=False)


def _objects(path: Path) -> dict[str, Opaque]:
    """Objects by their own names; SciPy gives them all the same one, and keeps the last."""
    from scipy.io.matlab import varmats_from_mat

    made: dict[str, Opaque] = {}
    with path.open("rb") as stream:
        for name, part in varmats_from_mat(stream):
            if name in (None, NAMELESS):
                value = _load(part).get(NAMELESS)
                made[_field(value, "s0") or f"object {len(made) + 1}"] = Opaque(
                    _field(value, "s2") or "object", of_class=True
                )
    return made


def _node(value: Any, depth: int = 0) -> Any:
    from scipy.io.matlab import MatlabFunction, MatlabOpaque, mat_struct

    if depth > DEEPEST:
        return Opaque("nested too deeply")
    if isinstance(value, MatlabOpaque):
        return Opaque(_field(value, "s2") or "object", of_class=True)
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
        return Opaque("complex numbers" if value.dtype.kind == "c" else "an array of another type")
    return Opaque("sparse matrix" if hasattr(value, "toarray") else type(value).__name__)


def _field(value: Any, key: str) -> str:
    """A text of an object's header: its name (s0) or its class (s2); empty if it has none."""
    names = value.dtype.names if isinstance(value, np.ndarray) else None
    if key not in (names or ()):
        return ""
    found = value[key].ravel()[0]
    return found.decode(errors="replace") if isinstance(found, bytes) else str(found)
