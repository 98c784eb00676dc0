"""The curve of a law that no catalogue lists, over what the model leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.formatting import number
from harness.identify.estimate.fit import TWO_SIDED
from harness.identify.problem.problem import Record
from harness.identify.problem.spline_term import Depends, Shape
from harness.identify.validation.residual_acceleration import Trace, trace
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.diagnosis.residual_acceleration import LEFT
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import WIDTH, Picture, band, binned, frame, picture, sample, style
from harness.report.tables import Column, Row, Table
from harness.report.wording import DEPENDENCES

_DOTS = 2000  # more only blacken the picture
_FINE = 400  # places at which a curve is drawn
_ROLLS = 0.03  # from which on the sign of the velocity is sure [m/s]
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
    inflation = account.diagnosis.problem.settings.inflation
    reach = TWO_SIDED * inflation * np.sqrt(np.diag(account.diagnosis.found.covariance)[-len(shape.nodes) :])
    factor = 1.0 if shape.friction else 1e3 * account.diagnosis.problem.rig.mass
    first, *others = account.diagnosis.depends_on
    context = {
        "friction": shape.friction,
        "depends": DEPENDENCES[first],
        "turning": shape.turning,
        "others": [DEPENDENCES[one] for one in others],
        "picture": _picture(account, shape, factor, reach),
        "table": _table(shape, factor, reach),
    }
    return Section("spline", "The law that no catalogue lists", "Spline term", "diagnosis/spline_term.html", context)


def _picture(account: Account, shape: Shape, factor: float, reach: FloatArray) -> Picture:
    name, unit, scale = _ABSCISSA[shape.depends]
    where, left = _left(account, shape)
    with style():
        figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
        axes = figure.add_subplot()
        first, last = shape.places[0], shape.places[-1] + (shape.step if shape.turning else 0.0)
        along = np.linspace(first, last, _FINE)
        y = factor * shape.at(along)
        thin = slice(None, None, max(1, len(where) // _DOTS))
        axes.plot(
            scale * where[thin],
            factor * left[thin],
            ".",
            color=MODEL.colour,
            alpha=0.3,
            markersize=3,
            markeredgewidth=0,
            rasterized=True,
        )
        inside = (where >= first) & (where <= last)
        centre, mean, error = binned(scale * where[inside], factor * left[inside])
        axes.errorbar(centre, mean, yerr=error, color=INK, marker="o", markersize=3.5, linewidth=1.0, zorder=4)
        width = factor * np.interp(along, shape.places, reach, period=last - first if shape.turning else None)
        band(axes, scale * along, y - width, y + width)
        axes.plot(scale * along, y, color=FOUND.colour, linewidth=1.6, zorder=5)
        axes.plot(scale * shape.places, factor * shape.nodes, "o", color=FOUND.colour, markersize=4.5, zorder=5)
        axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        low, high = np.percentile(factor * left[inside], (2.0, 98.0))
        frame(axes, np.concatenate((y, [low, high])), margin=0.15, least=0.0)
        axes.set_xlim(scale * first, scale * last)
        axes.set_xlabel(f"{name} [{unit}]")
        axes.set_ylabel("added to the coefficient\nof dry friction [1]" if shape.friction else "force on the ball [mN]")
        looks = (LEFT, replace(FOUND, label="the curve"))
        figure.legend(handles=[sample(look, look.label) for look in looks], loc="outside upper left", ncols=2)
        alt = f"The unlisted {'friction' if shape.friction else 'force'} as a function of {DEPENDENCES[shape.depends]}."
        caption = (
            f"The curve that predicts the recordings best, a spline through {len(shape.nodes)} nodes spread over what "
            "they visit, with 95 % intervals of the nodes (grey). Below it what the model leaves, estimated from the "
            "recordings alone, and in black the means of its bins with their standard errors."
            f"{' Dry friction that is negative in sum counts as none.' if shape.friction else ''}"
        )
        return picture(figure, alt, caption)


def _left(account: Account, shape: Shape) -> tuple[FloatArray, FloatArray]:
    """What the model with the listed effects leaves, in the unit of the nodes, and where; trusted readings only."""
    diagnosis, k = account.diagnosis, account.diagnosis.problem.rig.rolling_ratio
    listed = replace(diagnosis.found, best=replace(diagnosis.found.best, shape=None))
    wheres, lefts = [], []
    each = zip(diagnosis.problem.records, account.traces, diagnosis.found.best.phases, strict=True)
    for record, seen, phase in each:
        explained = trace(diagnosis.problem, listed, record, account.ball(record)).law
        where = _along(shape, record, seen, diagnosis.problem.rig, float(phase))
        left, use = (seen.residual - explained) / k, seen.trusted
        if shape.friction:
            normal = _normal(record, seen, diagnosis.problem.rig)
            use = use & (np.abs(seen.velocity) > _ROLLS) & (normal > 0.0)
            left = -np.sign(seen.velocity) * left / np.where(normal > 0.0, normal, 1.0)
        wheres.append(where[use])
        lefts.append(left[use])
    return np.concatenate(wheres), np.concatenate(lefts)


def _along(shape: Shape, record: Record, seen: Trace, rig: Rig, phase: float) -> FloatArray:
    """What the curve depends on, at the stamps of a recording; `phase` is how the ball lay at its start [rad]."""
    match shape.depends:
        case Depends.POSITION:
            return seen.position
        case Depends.VELOCITY:
            return seen.velocity
        case Depends.ANGLE:
            return seen.angle
        case Depends.ROLL_ANGLE:
            return ((seen.position - record.origin) / rig.rolling_radius + phase) % (2.0 * np.pi)
        case Depends.TIME:
            return seen.time


def _normal(record: Record, seen: Trace, rig: Rig) -> FloatArray:
    """N/m = g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇² at the stamps [m/s²]."""
    angle, rate, angular = record.drive.states.T
    arm = rig.eccentricity + rig.rolling_radius
    turning = 2.0 * seen.velocity * rate + seen.position * angular + arm * rate**2
    return np.asarray(rig.gravity * np.cos(angle) - turning)


def _table(shape: Shape, factor: float, reach: FloatArray) -> Table:
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
