"""Section on the spline term: the estimated law of an unlisted effect."""

from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.formatting import number
from harness.identify.estimate.fit import TWO_SIDED
from harness.identify.filter.run import run_filter
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.validation.residual_acceleration import ResidualAcceleration, residual_acceleration
from harness.report.diagnosis.account import FOUND, Account
from harness.report.diagnosis.residual_acceleration import LEFT
from harness.report.page import Section
from harness.report.plots import Picture, band, dots, drawing, frame, means, picture, sample, style
from harness.report.tables import Column, Table
from harness.report.wording import DEPENDENCES

_PLOT_POINTS = 400  # of the spline
_MIN_ROLLING_SPEED = 0.03  # above which the sign of the velocity is certain [m/s]
_ABSCISSA = {  # name, unit, factor to it
    Regressor.POSITION: ("position $s$", "m", 1.0),
    Regressor.VELOCITY: (r"velocity $\dot s$", "m/s", 1.0),
    Regressor.ANGLE: (r"beam angle $\alpha$", "deg", float(np.degrees(1.0))),
    Regressor.ROLL_ANGLE: (r"rolled angle $\varphi$", "deg", float(np.degrees(1.0))),
    Regressor.TIME: ("time", "s", 1.0),
}
_ORDINATE = {  # by whether it is of friction, of the sensor
    (False, False): "force on the ball [mN]",
    (True, False): "added to the coefficient\nof dry friction [1]",
    (False, True): "error of the\nposition sensor [mm]",
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
    name, unit, scale = _ABSCISSA[spline.depends]
    where, left = (_misread if spline.sensor else _left)(account, spline)
    figure = drawing(3.4)
    axes = figure.add_subplot()
    first, last = spline.places[0], spline.places[-1] + (spline.step if spline.closed else 0.0)
    along = np.linspace(first, last, _PLOT_POINTS)
    y = factor * spline.at(along)
    dots(axes, scale * where, factor * left, LEFT)
    inside = (where >= first) & (where <= last)
    means(axes, scale * where[inside], factor * left[inside], layer=4)
    width = factor * np.interp(along, spline.places, reach, period=spline.period if spline.closed else None)
    band(axes, scale * along, y - width, y + width)
    axes.plot(scale * along, y, color=FOUND.colour, linewidth=1.6, zorder=5)
    axes.plot(scale * spline.places, factor * spline.nodes, "o", color=FOUND.colour, markersize=4.5, zorder=5)
    low, high = np.percentile(factor * left[inside], (2.0, 98.0))
    frame(axes, np.concatenate((y, [low, high])), margin=0.15, least=0.0)
    axes.set(
        xlim=(scale * first, scale * last),
        xlabel=f"{name}{' within a period' * spline.periodic} [{unit}]",
        ylabel=_ORDINATE[spline.friction, spline.sensor],
    )
    dotted = sample(LEFT, "reading less position of the model" if spline.sensor else "")
    figure.legend(handles=[dotted, sample(FOUND, "spline term")], loc="outside upper left", ncols=2)
    what = "friction" if spline.friction else "error of the position sensor" if spline.sensor else "force"
    return picture(
        figure,
        f"The unlisted {what} as a function of {DEPENDENCES[spline.depends]}.",
        f"Estimated spline term with {len(spline.nodes)} nodes over "
        f"{'one period' if spline.periodic else 'the range of the recordings'}, with 95 % "
        f"intervals of the nodes (grey). Dots: {_DOTS[spline.sensor]}; black: bin means with their standard errors."
        f"{' A negative total friction is set to zero.' if spline.friction else ''}",
    )


def _misread(account: Account, spline: SplineTerm) -> tuple[FloatArray, FloatArray]:
    """Where the model's filtered ball is [m], and what readings are more than a sensor without an error gives there."""
    diagnosis = account.diagnosis
    wheres, lefts = [], []
    for record in diagnosis.problem.recordings:
        run = run_filter(diagnosis.problem, record, diagnosis.found.terms, diagnosis.found.process_noise)
        known = np.isfinite(record.reading)
        lies = run.state[known, 3]
        wheres.append(lies)
        lefts.append(record.reading[known] - replace(run.sensor, error=None).curve(lies))
    return np.concatenate(wheres), np.concatenate(lefts)


def _left(account: Account, spline: SplineTerm) -> tuple[FloatArray, FloatArray]:
    """Residual of the model with the listed effects in the unit of the nodes, and its abscissa, at trusted readings."""
    diagnosis, k = account.diagnosis, account.diagnosis.problem.rig.rolling_ratio
    listed = replace(diagnosis.found, terms=replace(diagnosis.found.terms, spline=None))
    wheres, lefts = [], []
    each = zip(diagnosis.problem.recordings, account.residual_accelerations, diagnosis.found.terms.phases, strict=True)
    for record, seen, phase in each:
        explained = residual_acceleration(diagnosis.problem, listed, record, account.ball(record)).law
        where = _along(spline, record, seen, diagnosis.problem.rig, float(phase))
        left, use = (seen.residual - explained) / k, seen.trusted
        if spline.friction:
            normal = _normal(record, seen, diagnosis.problem.rig)
            use = use & (np.abs(seen.velocity) > _MIN_ROLLING_SPEED) & (normal > 0.0)
            left = -np.sign(seen.velocity) * left / np.where(normal > 0.0, normal, 1.0)
        wheres.append(where[use])
        lefts.append(left[use])
    return np.concatenate(wheres), np.concatenate(lefts)


def _along(
    spline: SplineTerm, record: PreparedRecording, seen: ResidualAcceleration, rig: Rig, phase: float
) -> FloatArray:
    """Argument of the spline term at the stamps of a recording; `phase` is the ball's initial roll phase [rad]."""
    match spline.depends:
        case Regressor.POSITION:
            return spline.low + (seen.position - spline.low) % spline.period if spline.periodic else seen.position
        case Regressor.VELOCITY:
            return seen.velocity
        case Regressor.ANGLE:
            return seen.angle
        case Regressor.ROLL_ANGLE:
            return ((seen.position - record.origin) / rig.rolling_radius + phase) % (2.0 * np.pi)
        case Regressor.TIME:
            return seen.time


def _normal(record: PreparedRecording, seen: ResidualAcceleration, rig: Rig) -> FloatArray:
    """N/m = g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇² at the stamps [m/s²]."""
    angle, rate, angular = record.drive.states.T
    arm = rig.eccentricity + rig.rolling_radius
    turning = 2.0 * seen.velocity * rate + seen.position * angular + arm * rate**2
    return np.asarray(rig.gravity * np.cos(angle) - turning)


def _table(spline: SplineTerm, factor: float, reach: FloatArray) -> Table:
    _, unit, scale = _ABSCISSA[spline.depends]
    unit_of_values = "1" if spline.friction else "mm" if spline.sensor else "mN"
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
