"""The curve of a law that no catalogue lists."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from harness.identify.fit import INFLATION
from harness.identify.shape import Depends, Shape
from harness.report.diagnosis.account import FOUND, Account
from harness.report.numbers import number
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import WIDTH, Picture, band, picture, style
from harness.report.tables import Column, Row, Table

_ABSCISSA = {  # name, unit, factor to it
    Depends.POSITION: ("position $s$", "m", 1.0),
    Depends.VELOCITY: (r"velocity $\dot s$", "m/s", 1.0),
    Depends.ANGLE: (r"beam angle $\alpha$", "deg", float(np.degrees(1.0))),
    Depends.ROLL_ANGLE: (r"rolled angle $\varphi$", "deg", float(np.degrees(1.0))),
    Depends.TIME: ("time", "s", 1.0),
}


def section(account: Account) -> Section | None:
    """The curve; none where the catalogue says it all."""
    shape = account.diagnosis.found.best.shape
    if shape is None:
        return None
    reach = 1.96 * INFLATION * np.sqrt(np.diag(account.diagnosis.found.covariance)[-len(shape.nodes) :])
    factor = 1.0 if shape.friction else 1e3 * account.diagnosis.problem.rig.mass
    context = {
        "friction": shape.friction,
        "depends": str(shape.depends).replace("_", " "),
        "picture": _picture(shape, factor, reach),
        "table": _table(shape, factor, reach),
    }
    return Section("curve", "The law that no catalogue lists", "Curve", "diagnosis/curve.html", context)


def _picture(shape: Shape, factor: float, reach: np.ndarray) -> Picture:
    name, unit, scale = _ABSCISSA[shape.depends]
    with style():
        figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
        axes = figure.add_subplot()
        x, y = scale * shape.places, factor * shape.nodes
        band(axes, x, y - factor * reach, y + factor * reach)
        axes.plot(x, y, color=FOUND.colour, marker="o", markersize=4.5, linewidth=1.6, zorder=5)
        axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        axes.set_xlabel(f"{name} [{unit}]")
        axes.set_ylabel("added to the coefficient\nof dry friction [1]" if shape.friction else "force on the ball [mN]")
        alt = f"The unlisted {'friction' if shape.friction else 'force'} as a function of {shape.depends}."
        caption = (
            "The curve that predicts the recordings best, linear between twelve nodes spread over what they visit, "
            "with 95 % intervals of the nodes (grey)."
        )
        return picture(figure, alt, caption)


def _table(shape: Shape, factor: float, reach: np.ndarray) -> Table:
    _, unit, scale = _ABSCISSA[shape.depends]
    columns = [
        Column(str(shape.depends).replace("_", " "), unit),
        Column("coefficient" if shape.friction else "force", "1" if shape.friction else "mN"),
        Column("± 95 %", "1" if shape.friction else "mN"),
    ]
    rows = [
        Row((number(scale * at), number(factor * value), number(factor * half, 2)))
        for at, value, half in zip(shape.places, shape.nodes, reach, strict=True)
    ]
    return Table("Nodes of the curve", columns, rows)
