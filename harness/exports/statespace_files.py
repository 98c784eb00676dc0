"""A linear model as JSON, as a .mat file, and as Python that makes a StateSpace of python-control."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from scipy.io import savemat

from harness.exports.linear import Linear
from harness.exports.source import render

JSON_FILE, MAT_FILE, PYTHON_FILE = "statespace.json", "statespace.mat", "statespace.py"
_MATRICES = ("A", "B", "C", "D")
# The text that a .mat file begins with, which scipy gives the time: the same model is to give the same file.
_HEADER, _HEADER_LENGTH = b"MATLAB 5.0 MAT-file", 116


def content_of(linear: Linear, pade: int | None) -> dict[str, Any]:
    """What statespace.json holds.

    Args:
        linear: the model.
        pade: order of the Padé approximation of the delay, `None` for none.

    Raises:
        InputError: there is no such approximation.
    """
    ends = {name: linear.interval(name) for name in _MATRICES}
    content: dict[str, Any] = {
        "schema": 1,
        "operating_point": {"position_m": linear.point.position, "angle_rad": linear.point.angle, "velocity_m_s": 0.0},
        "input": "beam angle [rad], deviation from the operating point",
        "output": "recorded position [m], deviation from the operating point",
        "states": list(linear.states),
        **{name: getattr(linear, name).tolist() for name in _MATRICES},
        "intervals": {name: {"low": low.tolist(), "high": high.tolist()} for name, (low, high) in ends.items()},
        "delay_s": linear.delay,
        "delay_standard_deviation_s": linear.delay_deviation,
        "offset_m_s2": linear.offset,
        "physical": {
            "states": list(linear.physical),
            "B_angle": linear.B_angle.tolist(),
            "B_rate": linear.B_rate.tolist(),
            "B_acceleration": linear.B_acceleration.tolist(),
        },
        "left_out": list(linear.left_out),
    }
    if pade is not None:
        joined = dict(zip(_MATRICES, linear.with_pade(pade), strict=True))
        content["pade"] = {"order": pade, **{name: value.tolist() for name, value in joined.items()}}
    return content


def statespace_files(linear: Linear, pade: int | None, content: str) -> dict[str, str | bytes]:
    """Files by name.

    Args:
        linear, pade: as of `content_of`.
        content: statespace.json as text.

    Raises:
        InputError: there is no such approximation of the delay.
    """
    fields: dict[str, Any] = {name: getattr(linear, name) for name in _MATRICES}
    for name in _MATRICES:
        fields[f"{name}_low"], fields[f"{name}_high"] = linear.interval(name)
    names = np.array(linear.states, dtype=object)
    fields |= {"states": names, "input_unit": "rad", "output_unit": "m", "delay": linear.delay}
    fields |= {"position": linear.point.position, "angle": linear.point.angle, "offset": linear.offset}
    if pade is not None:
        for name, value in zip(_MATRICES, linear.with_pade(pade), strict=True):
            fields[f"{name}_pade"] = value
    file = io.BytesIO()
    savemat(file, fields, oned_as="column")  # type: ignore[arg-type] # its stubs know no open files
    mat = _HEADER.ljust(_HEADER_LENGTH) + file.getvalue()[_HEADER_LENGTH:]
    snippet = render("statespace.py.jinja", {"linear": linear, "matrices": _MATRICES, "file": JSON_FILE})
    return {JSON_FILE: content, MAT_FILE: mat, PYTHON_FILE: snippet}
