"""The identified model as C99 and as Python, with an example each."""

from __future__ import annotations

from harness.exports.model import ExportModel
from harness.exports.source import context_of, render

C_FILES = ("ball_beam.h", "ball_beam.c", "main.c")
PYTHON_FILE = "ball_beam.py"


def c_files(model: ExportModel) -> dict[str, str]:
    """Text by name of the C files: header, model, example.

    Raises:
        InputError: an effect cannot be written as source code.
    """
    context = context_of(model, "C")
    return {name: render(name, context) for name in C_FILES}


def python_files(model: ExportModel) -> dict[str, str]:
    """Text by name of the Python file, which is model and example.

    Raises:
        InputError: an effect cannot be written as source code.
    """
    return {PYTHON_FILE: render("ball_beam.py.jinja", context_of(model, "Python"))}
