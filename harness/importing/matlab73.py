"""MAT-files of version 7.3, which are HDF5 with MATLAB's attributes, by h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS, InputError
from harness.importing.matlab_tree import DEEPEST, Opaque

_NUMERIC = {"double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}


def read_tree(path: Path) -> dict[str, Any]:
    """All variables of a file; arrays have MATLAB's order of dimensions.

    Raises:
        InputError: h5py is missing, or the file is damaged.
    """
    try:
        import h5py
    except ImportError:
        raise InputError(
            f"{path}: MAT-files of version 7.3 need the package h5py. Install it: "
            "pip install 'ball-beam-harness[files]', or save the file in MATLAB with save(..., '-v7')."
        ) from None
    try:
        with h5py.File(path, "r") as file:
            return {name: _node(file, file[name], 0) for name in file if not name.startswith("#")}
    except INTERRUPTS:
        raise
    except Exception as error:  # h5py raises whatever a damaged file leads to
        raise InputError(
            f"{path}: cannot be read as a MAT-file of version 7.3 ({type(error).__name__}: {error}). Save it again "
            "from MATLAB."
        ) from None


def _node(file: Any, item: Any, depth: int) -> Any:
    import h5py

    if depth > DEEPEST:
        return Opaque("nested too deeply")
    kind = _text(item.attrs.get("MATLAB_class", b""))
    if "MATLAB_object_decode" in item.attrs:
        return Opaque(kind or "object", of_class=True)
    if isinstance(item, h5py.Group):
        return _struct({name: _node(file, item[name], depth + 1) for name in item}, item)
    if "MATLAB_empty" in item.attrs:
        return "" if kind == "char" else np.empty(0)
    if item.dtype == h5py.ref_dtype:
        made = [_node(file, file[one], depth + 1) for one in np.ravel(item[()]) if one]
        return made
    if kind == "char":
        return "".join(map(chr, np.ravel(item[()]))).strip("\0 ")
    if kind in _NUMERIC or (not kind and item.dtype.kind in "biuf"):
        return np.asarray(item[()]).T
    return Opaque(kind or "an array of another type")


def _struct(fields: dict[str, Any], item: Any) -> Any:
    """A struct; an array of structs, whose fields are references to one value each, as a list of structs."""
    import h5py

    arrays = [
        name for name in fields if isinstance(item[name], h5py.Dataset) and item[name].dtype == h5py.ref_dtype
        and "MATLAB_class" not in item[name].attrs
    ]  # fmt: skip
    if not arrays or len(arrays) != len(fields):
        return fields
    count = max(len(fields[name]) for name in arrays)
    return [{name: values[at] for name, values in fields.items() if at < len(values)} for at in range(count)]


def _text(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)
