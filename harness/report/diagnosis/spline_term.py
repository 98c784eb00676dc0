"""Section on the spline term: the estimated law of an unlisted effect."""

from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.formatting import number
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.numerics import TWO_SIDED
from harness.report.chart import Chart, Panel, Trace
from harness.report.clouds import Cloud, traces_of
from harness.report.diagnosis.account import FOUND, Account
from harness.report.diagnosis.residual_acceleration import LEFT
from harness.report.diagnosis.spline_samples import samples_of
from harness.report.page import Section
from harness.report.palette import UNCERTAINTY_COLOUR, Look
from harness.report.plots import Picture, band, dots, drawing, frame, means, picture, sample, style
from harness.report.tables import Column, Table
from harness.report.wording import DEPENDENCES

TERM = Look("spline term", FOUND.colour, None, 1.6, 5)
NODES = Look("nodes", FOUND.colour, None, 4.0, 5)
INTERVAL = Look("95 % interval", UNCERTAINTY_COLOUR)
_NODE = ["± half of the 95 % interval"]
_PLOT_POINTS = 400  # of the spline
_ABSCISSA = {  # name, symbol, unit, factor to it
    Regressor.POSITION: ("position", "s", "m", 1.0),
    Regressor.VELOCITY: ("velocity", "ṡ", "m/s", 1.0),
    Regressor.ANGLE: ("beam angle", "α", "deg", float(np.degrees(1.0))),
    Regressor.ROLL_ANGLE: ("rolled angle", "φ", "deg", float(np.degrees(1.0))),
    Regressor.TIME: ("time", "", "s", 1.0),
}
_ORDINATE = {  # name, unit, by whether it is of friction, of the sensor
    (False, False): ("force on the ball", "mN"),
    (True, False): ("added to the coefficient\nof dry friction", "1"),
    (False, True): ("error of the\nposition sensor", "mm"),
}
_DOTS = {  # by whether it is of the sensor
    False: "residual acceleration of the model, estimated from the recordings alone",
    True: "readings less the position at which the filtered ball of the model is",
}


def section(account: Account) -> Section | None:
    """The section; `None` without a spline term."""
    spline = account.diagnosis.found.terms.spline
    if spline is None:
        return None
    reach = TWO_SIDED * spline.deviations(account.diagnosis.found.covariance)
    factor = 1.0 if spline.friction else 1e3 if spline.sensor else 1e3 * account.diagnosis.problem.rig.mass
    first, *others = account.diagnosis.depends_on
    context = {
        "friction": spline.friction,
        "sensor": spline.sensor,
        "depends": DEPENDENCES[first],
        "turning": spline.turning,
        "period": _period(account, spline),
        "others": [DEPENDENCES[one] for one in others],
        "picture": _picture(account, spline, factor, reach),
        "table": _table(spline, factor, reach),
    }
    return Section("spline", "The law that no catalogue lists", "Spline term", "diagnosis/spline_term.html", context)


def _period(account: Account, spline: SplineTerm) -> str:
    """Period of a periodic spline term with its 95 % interval; empty for another."""
    if not spline.periodic:
        return ""
    variance = account.diagnosis.found.covariance[-len(spline.numbers), -len(spline.numbers)]
    half = TWO_SIDED * float(np.sqrt(max(variance, 0.0)))
    return f"{number(1e3 * spline.period, 4)} ± {number(1e3 * half, 2)} mm"


@style()
def _picture(account: Account, spline: SplineTerm, factor: float, reach: FloatArray) -> Picture:
    name, symbol, unit, scale = _ABSCISSA[spline.depends]
    quantity, unit_of_values = _ORDINATE[spline.friction, spline.sensor]
    first, last = spline.places[0], spline.places[-1] + (spline.step if spline.closed else 0.0)
    inside = samples_of(account, spline).within(first, last)
    x, left = scale * inside.where, factor * inside.left
    along = np.linspace(first, last, _PLOT_POINTS)
    y = factor * spline.at(along)
    width = factor * np.interp(along, spline.places, reach, period=spline.period if spline.closed else None)
    figure = drawing(3.4)
    axes = figure.add_subplot()
    dots(axes, x, left, LEFT)
    means(axes, x, left, layer=4)
    band(axes, scale * along, y - width, y + width)
    axes.plot(scale * along, y, color=FOUND.colour, linewidth=1.6, zorder=5)
    axes.plot(scale * spline.places, factor * spline.nodes, "o", color=FOUND.colour, markersize=4.5, zorder=5)
    frame(axes, np.concatenate((y, np.percentile(left, (2.0, 98.0)))), margin=0.15, least=0.0)
    abscissa = f"{name}{' within a period' * spline.periodic}"
    axes.set(
        xlim=(scale * first, scale * last),
        xlabel=f"{abscissa} {symbol} [{unit}]",
        ylabel=f"{quantity} [{unit_of_values}]",
    )
    dotted = replace(LEFT, label="reading less position of the model") if spline.sensor else LEFT
    figure.legend(handles=[sample(dotted), sample(FOUND, TERM.label)], loc="outside upper left", ncols=2)
    what = "friction" if spline.friction else "error of the position sensor" if spline.sensor else "force"
    traces = [
        Trace("interval", INTERVAL, scale * along, y + width, low=y - width),
        *traces_of([Cloud("residual", dotted, left)], inside.notes, x),
        Trace("term", TERM, scale * along, y),
        Trace("nodes", NODES, scale * spline.places, factor * spline.nodes, notes=_NODE * len(spline.nodes), dots=True,
              spread=factor * reach),
    ]  # fmt: skip
    panel = Panel(quantity.replace("\n", " "), unit_of_values, traces, frame=axes.get_ylim(), zero=True)
    return picture(
        figure,
        f"The unlisted {what} as a function of {DEPENDENCES[spline.depends]}.",
        f"Estimated spline term with {len(spline.nodes)} nodes over "
        f"{'one period' if spline.periodic else 'the range of the recordings'}, with 95 % "
        f"intervals of the nodes (band). Dots: {_DOTS[spline.sensor]}; joined points: means of bins with their "
        f"standard errors.{' A negative total friction is set to zero.' if spline.friction else ''}",
        Chart("spline-term", [panel], abscissa, unit.replace("deg", "°")),
    )


def _table(spline: SplineTerm, factor: float, reach: FloatArray) -> Table:
    _, _, unit, scale = _ABSCISSA[spline.depends]
    _, unit_of_values = _ORDINATE[spline.friction, spline.sensor]
    quantity = f"{'coefficient' if spline.friction else 'error' if spline.sensor else 'force'} [{unit_of_values}]"
    rows = [
        (number(scale * at), number(factor * value), number(factor * half, 2))
        for at, value, half in zip(spline.places, spline.nodes, reach, strict=True)
    ]
    columns: list[Column | str] = [
        Column(str(spline.depends).replace("_", " "), unit),
        quantity,
        f"± 95 % [{unit_of_values}]",
    ]
    return Table("Nodes of the spline term", columns, rows)
