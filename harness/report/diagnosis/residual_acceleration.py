"""Section on the residual acceleration of the declared model, compared with the effects found."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.motion import FloatArray
from harness.formatting import number
from harness.numerics import rms
from harness.report import plots
from harness.report.chart import MAX_ROWS, Chart, Panel, Trace
from harness.report.clouds import Cloud, Row, against_state, stamped
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.diagnosis.verdict import SIGMA, clock_of
from harness.report.page import Section
from harness.report.palette import Look

LEFT = Look("residual acceleration", MODEL.colour, None, 1.2, 3)
LAW = Look("effects found", FOUND.colour, None, 1.4, 6)
_MOST_ROWS, _FEWEST_ROWS = 12_000, 500  # of the charts of all recordings together, and of each
_LABEL = "residual acceleration\n[m/s²]"


def section(account: Account) -> Section:
    """The section."""
    residual, law, deviation = _trusted(account, "residual", "law", "deviation")
    context = {
        "changed": account.changed,
        "larger": rms(residual - law) > rms(residual),
        "before": number(rms(residual)),
        "after": number(rms(residual - law)),
        "uncertainty": number(rms(deviation), 2),
        "over_time": _over_time(account),
        "against": _against(account),
    }
    return Section("trace", "Residual acceleration", "Residual", "diagnosis/residual_acceleration.html", context)


def _trusted(account: Account, *names: str) -> list[FloatArray]:
    """These signals of all recordings, at trusted readings."""
    every = account.residual_accelerations
    return [np.concatenate([getattr(one, name)[one.trusted] for one in every]) for name in names]


def _legend(figure: Figure, account: Account) -> None:
    looks = [LEFT, LAW] if account.changed else [LEFT]
    figure.legend(handles=[plots.sample(look) for look in looks], loc="outside upper left", ncols=2)


def _in_newtons(axes: Axes, account: Account) -> None:
    rig = account.diagnosis.problem.rig
    factor = 1e3 * rig.mass / rig.rolling_ratio  # effective mass m (1 + J/(m r²)), in mN per m/s²
    right = axes.secondary_yaxis(
        "right",
        functions=(lambda acceleration: factor * np.asarray(acceleration), lambda force: np.asarray(force) / factor),
    )
    right.set_ylabel("force [mN]")


@plots.style()
def _over_time(account: Account) -> plots.Picture:
    every = account.residual_accelerations
    figure = plots.drawing(1.0 + 1.9 * len(every))
    grid = figure.subplots(len(every), 1, squeeze=False)[:, 0]
    for axes, one, record in zip(grid, every, account.diagnosis.problem.recordings, strict=True):
        plots.band(axes, one.time, one.residual - 2.0 * one.deviation, one.residual + 2.0 * one.deviation)
        plots.signal(axes, one.time, one.residual, LEFT)
        if account.changed:
            plots.signal(axes, one.time, one.law, LAW)
        plots.zero(axes)
        low, high = plots.middle(np.concatenate((one.residual, one.law)), 0.3)
        room = 2.0 * float(np.median(one.deviation))
        plots.frame(axes, np.array([low - room, high + room]), margin=0.1, least=0.0)
        axes.set(xlim=(one.time[0], one.time[-1]), title=record.name, ylabel=_LABEL)
        _in_newtons(axes, account)
    grid[-1].set_xlabel("time [s]")
    _legend(figure, account)
    return plots.picture(
        figure,
        "Residual acceleration over time, and the acceleration by the effects found.",
        "Residual acceleration: the ball's acceleration that the declared model does not explain, estimated from "
        "the recording alone, with its ± 2 σ band, and the acceleration by the effects found along the same "
        "path. The estimate is smoothed, the effects are not.",
        still_note="Right axis: the equivalent force.",
        beside=_charts(account, [axes.get_ylim() for axes in grid]),
    )


def _charts(account: Account, frames: list[tuple[float, float]]) -> tuple[Chart, ...]:
    """The same as data of the page, one chart a recording, as each has a time of its own."""
    every, records = account.residual_accelerations, account.diagnosis.problem.recordings
    most = min(MAX_ROWS, max(_FEWEST_ROWS, _MOST_ROWS // len(every)))
    charts = []
    for at, (one, record, frame) in enumerate(zip(every, records, frames, strict=True)):
        band = 2.0 * one.deviation
        traces = [
            Trace("sigma", SIGMA, one.time, one.residual + band, low=one.residual - band),
            Trace("residual", LEFT, one.time, one.residual),
        ]
        if account.changed:
            traces.append(Trace("law", LAW, one.time, one.law))
        panel = Panel("residual acceleration", "m/s²", traces, frame=frame, zero=True, title=record.name)
        charts.append(Chart(f"residual-acceleration-{at}", [panel], clock=clock_of(record), most=most))
    return tuple(charts)


@plots.style()
def _against(account: Account) -> plots.Picture:
    position, velocity, angle, residual, law = _trusted(account, "position", "velocity", "angle", "residual", "law")
    figure = plots.drawing(3.0)
    row = figure.subplots(1, 3, sharey=True)
    for axes, x in plots.against_state(row, position, velocity, angle):
        plots.dots(axes, x, residual, LEFT)
        if account.changed:
            plots.dots(axes, x, law, LAW)
        plots.means(axes, x, residual)
    plots.frame(row[0], plots.middle(np.concatenate((residual, law)), 1.0), margin=0.3, least=0.0)
    row[0].set_ylabel(_LABEL)
    _in_newtons(row[-1], account)
    _legend(figure, account)
    clouds = [Cloud("residual", LEFT, residual)]
    if account.changed:
        clouds.append(Cloud("law", LAW, law, averaged=False))
    data = Row("residual", "m/s²", clouds, _stamps(account), position, velocity, angle, frame=row[0].get_ylim())
    return plots.picture(
        figure,
        "Residual acceleration and that of the effects against position, velocity and beam angle.",
        "The same against position, velocity and beam angle, over all recordings. Joined points: bin means of the "
        "residual acceleration with their standard errors. A step at ṡ = 0 indicates dry friction, a slope in ṡ "
        "viscous damping, an offset a level error, a slope in s a curved track.",
        still_note="Right axis: the equivalent force.",
        beside=against_state("residual-against", [data]),
    )


def _stamps(account: Account) -> list[str]:
    """What the samples of all recordings at trusted readings are."""
    both = zip(account.residual_accelerations, account.diagnosis.problem.recordings, strict=True)
    return [note for one, record in both for note in stamped(one.time[one.trusted], record.name)]
