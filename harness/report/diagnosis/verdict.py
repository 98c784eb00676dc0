"""First section: the verdict in a sentence, the effects found, and predictions without and with them."""

import math
from dataclasses import astuple

import numpy as np
from matplotlib.figure import Figure

from analytic.effects import CATALOGUE
from analytic.motion import FloatArray
from harness.formatting import NONE, brief, number
from harness.identify.design import proposal
from harness.identify.estimate.fit import Estimator
from harness.identify.estimate.forecast import Forecast, forecast
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import known_first
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Line
from harness.identify.validation.beam_dependence import SIGNIFICANT
from harness.numerics import TWO_SIDED, rms
from harness.recording.findings import warnings_of
from harness.report import plots
from harness.report.chart import Chart, Mark, Panel, Trace
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.palette import LEFT_OUT_COLOUR, MEASURED_COLOUR, UNCERTAINTY_COLOUR, Look
from harness.report.tables import Row, Table, texts
from harness.report.wording import error_size, sentence, words

RECORDED = Look("recording", MEASURED_COLOUR, None, 2.0, 4)
SIGMA = Look("± 2 σ", UNCERTAINTY_COLOUR)
LEFT_OUT = Look("left out of all fits", LEFT_OUT_COLOUR)
_MAX_BAND = 3.0  # of the uncertainty band in the figure, times the largest error
_LEAST_SPREAD = 0.02  # of the readings in a picture [m]


def section(account: Account) -> Section:
    """The verdict."""
    context = {
        "sentence": sentence(account.diagnosis),
        "glance": _glance(account),
        "found": _found(account) if account.diagnosis.effects else None,
        # Beside a spline term no candidate was tried again, and without it the process noise hides what is small.
        "unseen": () if account.diagnosis.found.terms.spline is not None else account.diagnosis.unseen,
        "implausible": _implausible(account),
        "failed": bool(account.diagnosis.failures),
        "hidden": account.diagnosis.hidden,
        "picture": _picture(account),
        "warnings": warnings_of(one.finding() for one in account.record.findings),
    }
    return Section("verdict", "Verdict", "Verdict", "diagnosis/verdict.html", context)


def _glance(account: Account) -> list[tuple[str, str, str]]:
    """Summaries of later sections: anchor, name, text."""
    diagnosis = account.diagnosis
    said = []
    if account.changed:
        said.append(("rivals", "Rivals", _nearest(account)))
    said.append(("errors", "Innovations", _independence(account)))
    kept = sum(one.kept for one in diagnosis.ledger)
    said.append(("ledger", "Ledger", f"{len(diagnosis.ledger)} entries, {kept} kept at first"))
    if diagnosis.next_experiment is not None:
        said.append(("experiment", "Next experiment", words(proposal.sentence(diagnosis.next_experiment))))
    return said


def _nearest(account: Account) -> str:
    """What comes closest to what was found: as many other effects, any that are not told from it, a spline term."""
    found, criterion = account.diagnosis.found, Criterion(account.diagnosis.problem.settings)
    if found.estimator is Estimator.FREE_RUNS:
        return "chosen by held-out errors, which the ledger lists: likelihoods of fits to free runs are not compared"

    def other(one: Line) -> bool:
        """Not the same spline term with more or fewer nodes, or with an effect that it contains."""
        ours, theirs = found.hypothesis, one.fit.hypothesis
        if one.kept or one.rule in (Rule.REFINE, Rule.ABSORB):
            return False
        if ours.spline is None or theirs.spline is None:
            mine, its = set(ours.names), set(theirs.names)
            comparable = len(its) == len(mine) or criterion.rivals(one.fit, found)
            return ours.spline is theirs.spline and comparable and not (its <= mine or mine <= its)
        return theirs.spline.kind != ours.spline.kind

    others = [one for one in account.diagnosis.ledger if other(one)]
    if not others:
        return "nothing else was fitted in the same place"
    nearest = min(others, key=lambda one: criterion.gain(found, one.fit))
    behind = criterion.gain(found, nearest.fit)
    told = "not told apart" if criterion.rivals(nearest.fit, found) else "told apart"
    return f"the nearest is {words(nearest.title)}, {number(behind)} behind in BIC: {told}"


def _independence(account: Account) -> str:
    """Whether held-out innovations are independent of the beam's motion."""
    tests = account.diagnosis.heldout.after.beam
    if not any(one.freedom for one in tests.values()):
        return "too few readings to test"
    least = min(one.p for one in tests.values())
    size = number(account.diagnosis.heldout.after.innovation_over_noise)
    relation = "independent of" if least >= SIGNIFICANT else "not independent of"
    return f"held out, {size} times the reading noise, {relation} the beam's motion (smallest p = {brief(least, 2)})"


def _found(account: Account) -> Table:
    rows, settings = [], account.diagnosis.problem.settings
    if account.diagnosis.found.estimator is Estimator.FREE_RUNS:
        within = f"{100.0 * math.expm1(settings.held_out_rival):.0f} % of the held-out error"
    else:
        within = f"{settings.rival:g} in BIC"
    for one in account.diagnosis.effects:
        rivals = ", ".join(map(" + ".join, one.rivals)) or f"nothing within {within}"
        for key, estimate in (*one.parameters.items(), *one.by_recording.items()):
            value, low, high, unit = astuple(estimate)
            first = key == next(iter(one.parameters))
            head = (f"`{one.name}`", CATALOGUE[one.name].law) if first else ("", "")
            digits = _digits(value, high - low)
            interval = f"{number(low, digits)} … {number(high, digits)}"
            cells = (*head, f"`{key}`", number(value, digits), interval, unit, rivals if first else "")
            rows.append(Row(cells, "best" if first else ""))
    rows += _along(account)
    columns = [*texts("effect", "law", "parameter"), "value", "95 % interval", *texts("unit", "indistinguishable from")]
    return Table("Effects found (± above is half the width of these intervals)", columns, rows)


def _along(account: Account) -> list[Row]:
    """What is estimated along with the effects because the rig file does not give it."""
    found, rows = account.diagnosis.found, []
    values, deviations = found.values(), found.deviations()
    for name in account.diagnosis.problem.unknown:
        for one in CATALOGUE[name].parameters:
            value, half = values[name, one.name], TWO_SIDED * float(deviations[name, one.name])
            digits = _digits(value, 2.0 * half)
            interval = f"{number(value - half, digits)} … {number(value + half, digits)}"
            head = (f"`{name}`", CATALOGUE[name].law, f"`{one.name}`")
            why = "estimated along: stands for what is unknown of the rig"
            rows.append(Row((*head, number(value, digits), interval, one.unit, why)))
    return rows


def _implausible(account: Account) -> list[tuple[str, str, str]]:
    """Effect, parameter and usual range of every value outside of it."""
    rig, said = account.diagnosis.problem.rig, []
    for finding in account.diagnosis.effects:
        for parameter in CATALOGUE[finding.name].parameters:
            usual = parameter.usual_on(rig)
            if parameter.name in finding.implausible and usual is not None:
                unit = "" if parameter.unit == "1" else f" {parameter.unit}"
                said.append((finding.name, parameter.name, f"{number(usual[0])} … {number(usual[1])}{unit}"))
    return said


def _digits(value: float, width: float) -> int:
    """Significant digits of a value at which an interval of this width has two."""
    if not (value and width > 0.0):
        return 3
    return int(np.clip(np.floor(np.log10(abs(value))) - np.floor(np.log10(width)) + 2, 2, 6))


Runs = list[tuple[Forecast, Look]]


def _known(account: Account) -> float:
    """From the positions of how many seconds the shown recording is predicted [s]."""
    return known_first(float(account.shown.time[-1] - account.shown.time[0]))


def _runs(account: Account) -> Runs:
    """A recording predicted from its first seconds, without and with what was found."""
    diagnosis, shown = account.diagnosis, account.shown
    given = np.where(shown.time - shown.time[0] < _known(account), shown.reading, np.nan)
    fits = [(diagnosis.base, MODEL), (diagnosis.found, FOUND)]
    return [(forecast(diagnosis.problem, fit, shown, given), look) for fit, look in fits[: 2 if account.changed else 1]]


@plots.style()
def before_after(account: Account, runs: Runs | None = None) -> Figure:
    """Predictions of the shown recording and their errors, without and with what was found."""
    time, reading = account.shown.time, account.shown.reading
    runs = _runs(account) if runs is None else runs
    closest = runs[-1][0]
    figure = plots.drawing(4.3)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1.0))
    plots.band(top, time, closest.position - 2.0 * closest.deviation, closest.position + 2.0 * closest.deviation)
    left_out = account.left_out(account.shown)
    known = np.isfinite(reading)
    drawn = known | np.isin(time, left_out[:, 0])  # with gaps where readings are left out
    plots.signal(top, time[drawn], reading[drawn], RECORDED)
    near = _near(reading[known], closest.position)
    plots.frame(top, np.concatenate((reading[known], near)), margin=0.25)
    errors = [(1e3 * (one.position - reading), look) for one, look in runs]
    # The difference contains the noise of the reading.
    reach = 2e3 * np.sqrt(closest.deviation**2 + account.diagnosis.problem.reading_variance)
    plots.band(bottom, time, -reach, reach)
    plots.zero(bottom)
    seen = 1e3 * (near - reading)[known]
    most = _MAX_BAND * float(np.max(np.abs(seen)))
    plots.frame(bottom, np.concatenate((seen, np.clip(-reach, -most, most), np.clip(reach, -most, most))), margin=0.2)
    for axes, lines, label in (
        (top, [(one.position, look) for one, look in runs], "position s [m]"),
        (bottom, errors, "prediction − reading\n[mm]"),
    ):
        for values, look in lines:
            plots.signal(axes, time, values, look)
            plots.mark_exits(axes, time, values, look)
        axes.set_ylabel(label)
        axes.axvspan(time[0], time[0] + _known(account), color="#eef1f4", linewidth=0.0, zorder=0)
    whole = np.concatenate((time, left_out[:, 0]))
    plots.over_time(bottom, float(whole.min()), float(whole.max()))
    entries = [plots.sample(RECORDED, account.measured), *(plots.sample(look) for _, look in runs)]
    entries += plots.left_out(top, left_out)
    figure.legend(handles=entries, loc="outside upper left", ncols=3, handlelength=2.6)
    return figure


@plots.style()
def _picture(account: Account) -> plots.Picture:
    shown, runs = account.shown, _runs(account)
    judged = (shown.time - shown.time[0] >= _known(account)) & np.isfinite(shown.reading)
    ends = [
        f"{look.label} {error_size(rms((one.position - shown.reading)[judged])) if judged.any() else NONE}"
        for one, look in runs
    ]
    others = "" if account.diagnosis.forecasting is None else "; predictions of other recordings use others"
    return plots.picture(
        before_after(account, runs),
        f"Recorded and predicted position of {shown.name} without and with the effects found; differences.",
        f"{shown.name}, predicted from the recorded angle and the positions of the first {brief(_known(account))} s "
        f"alone (shaded). RMS error after them: {', '.join(ends)}. Band: ± 2 σ of the last of them, below including "
        "reading noise. Parameters are those of the verdict, fitted to this recording "
        f"too{others}; for held-out errors see below.{_kept(account)}",
        chart(account, runs),
        "Triangles: a line leaves the frame.",
    )


def _kept(account: Account) -> str:
    """What is told of where predictions are kept, if they are."""
    ends = account.diagnosis.found.travel.ends
    if ends is None or not account.changed:
        return ""
    low, high = map(number, ends)
    return f" Predictions with the effects found are kept between {low} and {high} m, where the ball was recorded."


CHART = "before-after"


def clock_of(record: PreparedRecording) -> str:
    """Of all charts over the time of one recording."""
    return f"recording {record.name}"


def chart(account: Account, runs: Runs) -> Chart:
    """The same as data of the page."""
    shown, closest = account.shown, runs[-1][0]
    time, reading, left_out = shown.time, shown.reading, account.left_out(account.shown)
    drawn = np.isfinite(reading) | np.isin(time, left_out[:, 0])
    recorded = Look(account.measured, RECORDED.colour, None, RECORDED.width)
    reach = 2e3 * np.sqrt(closest.deviation**2 + account.diagnosis.problem.reading_variance)
    band = 2.0 * closest.deviation
    top = [
        Trace("uncertainty", SIGMA, time, closest.position + band, low=closest.position - band),
        Trace("recorded", recorded, time[drawn], reading[drawn]),
        *(Trace(look.label, look, time, one.position) for one, look in runs),
    ]
    if len(left_out):
        top.append(Trace("left_out", LEFT_OUT, left_out[:, 0], left_out[:, 1], dots=True))
    bottom = [
        Trace("uncertainty", SIGMA, time, reach, low=-reach),
        *(Trace(look.label, look, time, 1e3 * (one.position - reading)) for one, look in runs),
    ]
    known = np.isfinite(reading)
    near = _near(reading[known], closest.position)
    most = _MAX_BAND * 1e3 * float(np.max(np.abs(near - reading)[known]))
    panels = [
        Panel("position s", "m", top, frame=_framed(np.concatenate((reading[known], near)))),
        Panel("prediction − reading", "mm", bottom, frame=(-most, most), zero=True),
    ]
    return Chart(CHART, panels, clock=clock_of(shown), marks=marks(account))


def marks(account: Account) -> list[Mark]:
    """The part of the shown recording from which its prediction starts."""
    begin = float(account.shown.time[0])
    text = "known positions, from which the prediction starts"
    return [Mark("identify", text, begin, begin + _known(account))]


def _near(reading: FloatArray, position: FloatArray) -> FloatArray:
    """Predicted positions, cut where they leave the readings by more than these spread [m].

    On a beam that a controller moves, a prediction of many seconds ends anywhere: what it leaves is not to be hidden.
    """
    low, high = float(reading.min()), float(reading.max())
    spread = max(high - low, _LEAST_SPREAD)
    return np.clip(position, low - spread, high + spread)


def _framed(values: FloatArray) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.25 * (high - low)
    return low - room, high + room
