"""First section: the verdict in a sentence, the effects found, and predictions without and with them."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.effects import CATALOGUE
from analytic.motion import FloatArray
from harness.formatting import NONE, brief, number
from harness.identify.design import proposal
from harness.identify.estimate.forecast import Forecast, forecast
from harness.identify.problem.windows import KNOWN
from harness.identify.selection.criterion import Criterion, Rule
from harness.identify.selection.ledger import Line
from harness.identify.validation.whiteness import SIGNIFICANT
from harness.numerics import rms
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.palette import INK, MEASURED_COLOUR, Look
from harness.report.plots import WIDTH, Picture, band, frame, line, mark_exits, picture, sample, style, thinning
from harness.report.tables import Column, Row, Table
from harness.report.wording import error_size, sentence, words

_MAX_BAND = 3.0  # of the uncertainty band in the figure, times the largest error


def section(account: Account) -> Section:
    """The verdict."""
    context = {
        "sentence": sentence(account.diagnosis),
        "glance": _glance(account),
        "found": _found(account) if account.diagnosis.effects else None,
        # Beside a curve nothing was tried again, and without it the process noise hides what is small.
        "unseen": () if account.diagnosis.found.terms.spline is not None else account.diagnosis.unseen,
        "hidden": account.diagnosis.hidden,
        "picture": _picture(account),
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
    """The effect that comes closest to what was found with as many others beside it, or the other spline term."""
    found, criterion = account.diagnosis.found, Criterion(account.diagnosis.problem.settings)
    spline = found.hypothesis.spline is not None

    def other(one: Line) -> bool:
        """Not the same spline term with more nodes, or with an effect that it contains."""
        theirs = one.fit.hypothesis
        if one.kept or (theirs.spline is not None) != spline or one.rule in (Rule.REFINE, Rule.ABSORB):
            return False
        return spline or (len(theirs.names) == len(found.hypothesis.names) and theirs != found.hypothesis)

    others = [one for one in account.diagnosis.ledger if other(one)]
    if not others:
        return "nothing else was fitted in the same place"
    behind, nearest = min((criterion.gain(found, one.fit), one.title) for one in others)
    told = "told apart" if behind >= criterion.settings.rival else "not told apart"
    return f"the nearest is {words(nearest)}, {number(behind)} behind in {'BIC' if spline else 'quasi-BIC'}: {told}"


def _independence(account: Account) -> str:
    """Whether held-out innovations are independent of the beam's motion."""
    tests = account.diagnosis.heldout.after.beam
    if not any(one.freedom for one in tests.values()):
        return "too few readings to test"
    least = min(one.p for one in tests.values())
    size = number(account.diagnosis.heldout.after.ratio)
    relation = "independent of" if least >= SIGNIFICANT else "not independent of"
    return f"held out, {size} times the reading noise, {relation} the beam's motion (smallest p = {brief(least, 2)})"


def _found(account: Account) -> Table:
    columns = [
        Column("effect", text=True),
        Column("law", text=True),
        Column("parameter", text=True),
        Column("value"),
        Column("95 % interval"),
        Column("unit", text=True),
        Column("indistinguishable from", text=True),
    ]
    rows = []
    for one in account.diagnosis.effects:
        rivals = ", ".join(one.indistinguishable_from) or "nothing: no rival comes close"
        for key, estimate in one.parameters.items():
            value, low, high, unit = astuple(estimate)
            first = key == next(iter(one.parameters))
            head = (f"`{one.name}`", CATALOGUE[one.name].law) if first else ("", "")
            digits = _digits(value, high - low)
            interval = f"{number(low, digits)} … {number(high, digits)}"
            cells = (*head, f"`{key}`", number(value, digits), interval, unit, rivals if first else "")
            rows.append(Row(cells, "best" if first else ""))
    return Table("Effects found (± above is half the width of these intervals)", columns, rows)


def _digits(value: float, width: float) -> int:
    """Significant digits of a value at which an interval of this width has two."""
    if not (value and width > 0.0):
        return 3
    return int(np.clip(np.floor(np.log10(abs(value))) - np.floor(np.log10(width)) + 2, 2, 6))


Runs = list[tuple[Forecast, Look]]


def _runs(account: Account) -> Runs:
    """The first recording predicted from its first seconds, without and with what was found."""
    diagnosis, shown = account.diagnosis, account.shown
    given = np.where(shown.time - shown.time[0] < KNOWN, shown.reading, np.nan)
    fits = [(diagnosis.base, MODEL), (diagnosis.found, FOUND)]
    return [(forecast(diagnosis.problem, fit, shown, given), look) for fit, look in fits[: 2 if account.changed else 1]]


def before_after(account: Account, runs: Runs | None = None) -> Figure:
    """Predictions of the first recording and their errors, without and with what was found."""
    diagnosis, shown = account.diagnosis, account.shown
    time, reading = shown.time, shown.reading
    runs = _runs(account) if runs is None else runs
    closest = runs[-1][0]
    with style():
        figure = Figure(figsize=(WIDTH, 4.3), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1.0))
        _panel(top, time, reading, runs, closest)
        top.set_ylabel("position $s$ [m]")
        errors = [(1e3 * (one.position - reading), look) for one, look in runs]
        # The difference contains the noise of the reading.
        reach = 2e3 * np.sqrt(closest.deviation**2 + diagnosis.problem.reading_variance)
        thin = slice(None, None, thinning(len(time)))
        band(bottom, time, -reach, reach)
        for error, look in errors:
            line(bottom, time[thin], error[thin], look)
        bottom.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        seen = errors[-1][0][np.isfinite(reading)]
        most = _MAX_BAND * float(np.max(np.abs(seen)))
        frame(bottom, np.concatenate((seen, np.clip(-reach, -most, most), np.clip(reach, -most, most))), margin=0.2)
        for error, look in errors:
            mark_exits(bottom, time, error, look)
        bottom.set_ylabel("prediction − reading\n[mm]")
        bottom.set_xlabel("time [s]")
        bottom.set_xlim(time[0], time[-1])
        for axes in (top, bottom):
            axes.axvspan(time[0], time[0] + KNOWN, color="#eef1f4", linewidth=0.0, zorder=0)
        entries = [sample(Look("recording", MEASURED_COLOUR, None, 1.4), account.measured)]
        entries += [sample(look, look.label) for _, look in runs]
        figure.legend(handles=entries, loc="outside upper left", ncols=3, handlelength=2.6)
    return figure


def _picture(account: Account) -> Picture:
    shown, runs = account.shown, _runs(account)
    time, reading = shown.time, shown.reading
    first = time - time[0] < KNOWN
    figure = before_after(account, runs)
    with style():
        ends = ", ".join(f"{look.label} {_error(one, reading, ~first)}" for one, look in runs)
        alt = f"Recorded and predicted position of {shown.name} without and with the effects found; differences."
        caption = (
            f"{shown.name}, predicted from the recorded angle and the positions of the first {brief(KNOWN)} s alone "
            f"(shaded). RMS error after them: {ends}. Grey: ± 2 σ of the last of them, below including reading "
            "noise. Triangles: a line leaves the frame. Parameters are those of the verdict, fitted to this recording "
            "too; for held-out errors see below."
        )
        return picture(figure, alt, caption)


def _panel(axes: Axes, time: FloatArray, reading: FloatArray, runs: Runs, closest: Forecast) -> None:
    thin = slice(None, None, thinning(len(time)))
    band(axes, time, closest.position - 2.0 * closest.deviation, closest.position + 2.0 * closest.deviation)
    known = np.isfinite(reading)
    stride = slice(None, None, thinning(int(known.sum())))
    axes.plot(time[known][stride], reading[known][stride], color=MEASURED_COLOUR, linewidth=2.4, alpha=0.85, zorder=4)
    for one, look in runs:
        line(axes, time[thin], one.position[thin], look)
    frame(axes, np.concatenate((reading[known], closest.position)), margin=0.25)
    for one, look in runs:
        mark_exits(axes, time, one.position, look)


def _error(one: Forecast, reading: FloatArray, judged: np.ndarray) -> str:
    misses = (one.position - reading)[judged & np.isfinite(reading)]
    return error_size(rms(misses)) if misses.size else NONE
