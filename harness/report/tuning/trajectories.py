"""Recorded positions and runs of the engine before and after tuning over one recording: still picture and chart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import KNOWN
from harness.report import plots
from harness.report.chart import Chart, Mark, Panel, Trace
from harness.report.palette import MEASURED_COLOUR, Look
from harness.report.tuning.subject import Subject
from harness.tuning.estimate.runs import known_positions

RECORDED = "recorded"
_ROOM = 0.25  # of the readings' range, above and below it in the frame
_MOST = 3.0  # the errors' frame, in RMS errors of the larger of both


@dataclass(frozen=True)
class Piece:
    """One run of the engine before and after.

    Attributes:
        time: shape (m,) [s].
        before, after: positions, shape (m,) each [m]; NaN where the engine failed.
    """

    time: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True)
class Shown:
    """Runs over one recording, one after the other.

    Attributes:
        anchor: of the chart.
        title: of what they are, for the choice of the replay.
        recording: what they are compared with.
        pieces: ascending in time, without overlap.
        mark: what begins where a piece does.
    """

    anchor: str
    title: str
    recording: PreparedRecording
    pieces: Sequence[Piece]
    mark: str

    @property
    def clock(self) -> str:
        """Of all charts over the time of the recording."""
        return f"recording {self.recording.name}"

    def positions(self, which: str) -> tuple[FloatArray, FloatArray]:
        """Times [s] and positions [m] of all pieces with NaN between them; `which` is `before` or `after`."""
        gap = np.array([np.nan])
        times = np.concatenate([part for one in self.pieces for part in (one.time, gap)])
        return times, np.concatenate([part for one in self.pieces for part in (getattr(one, which), gap)])

    def errors(self, which: str) -> tuple[FloatArray, FloatArray]:
        """Times [s] and the same minus the readings [mm], which are interpolated where a piece averages several."""
        times, positions = self.positions(which)
        known = np.isfinite(self.recording.reading)
        readings = np.interp(times, self.recording.time[known], self.recording.reading[known])
        return times, 1e3 * (positions - readings)

    @property
    def marks(self) -> list[Mark]:
        """Where pieces begin, and which of them failed."""
        found = []
        for one in self.pieces:
            begin = float(one.time[0])
            found.append(Mark("window", self.mark, begin, begin))
            for which in ("before", "after"):
                if np.isnan(getattr(one, which)).any():
                    found.append(Mark("failure", f"the engine failed, {which} tuning", begin, begin))
        return found


def free_runs(subject: Subject) -> Shown:
    """Free runs over the windows of the first recording that was fitted to."""
    windows = subject.tuned.windows
    recording = windows[0].recording
    pieces = [
        Piece(window.time, known_positions(old), known_positions(new))
        for window, old, new in zip(windows, *subject.runs, strict=True)
        if window.recording is recording
    ]
    title = f"{recording.name}, fitted windows"
    return Shown("free-runs", title, recording, pieces, "a free run begins, from a start fitted to it")


def held_out(subject: Subject) -> list[Shown]:
    """Predictions of the held-out blocks, by recording."""
    errors = subject.tuned.held_out
    if errors is None:
        return []
    shown = []
    for number, recording in enumerate(subject.tuned.model.problem.recordings):
        pieces = [Piece(one.time, one.before, one.after) for one in errors.predicted if one.recording == recording.name]
        if pieces:
            title = f"{recording.name}, held-out blocks"
            mark = f"a prediction begins, from the {KNOWN:g} s before"
            shown.append(Shown(f"held-out-{number}", title, recording, pieces, mark))
    return shown


def looks(subject: Subject) -> dict[str, Look]:
    """Of the runs, by `before` and `after`; one look where nothing was tuned and both are the same."""
    own = subject.look
    before = Look(f"{subject.engine}, before", "#8a8f98", (5.0, 2.0), 1.4, 4)
    fitted = "level angle fitted" if subject.tuned.rejected is None else "fitted, and not taken"
    after = "tuned" if subject.tuned.selection.pays else fitted
    return {"before": before, "after": Look(f"{subject.engine}, {after}", own.colour, None, 1.6, 5)}


def _of(subject: Subject, shown: Shown) -> dict[str, Look]:
    """The looks of the lines that differ from each other."""
    each = looks(subject)
    same = all(one.after is one.before for one in shown.pieces)
    return {"before": each["before"]} if same else each


def chart(subject: Subject, shown: Shown) -> Chart:
    """Positions above, errors below."""
    recording, each = shown.recording, _of(subject, shown)
    known = np.isfinite(recording.reading)
    recorded = Look(subject.measured, MEASURED_COLOUR, None, 1.6)
    top = [Trace(RECORDED, recorded, recording.time[known], recording.reading[known])]
    top += [Trace(which, look, *shown.positions(which)) for which, look in each.items()]
    bottom = [Trace(which, look, *shown.errors(which)) for which, look in each.items()]
    panels = [
        Panel("position s", "m", top, frame=_frame(shown)),
        Panel(f"run − {subject.measured}", "mm", bottom, frame=_error_frame(shown), zero=True),
    ]
    return Chart(shown.anchor, panels, clock=shown.clock, marks=shown.marks)


def _frame(shown: Shown) -> tuple[float, float]:
    readings = shown.recording.reading
    low, high = float(np.nanmin(readings)), float(np.nanmax(readings))
    room = max(_ROOM * (high - low), 1e-3)
    return low - room, high + room


def _error_frame(shown: Shown) -> tuple[float, float]:
    most = _MOST * max(float(np.sqrt(np.nanmean(shown.errors(which)[1] ** 2))) for which in ("before", "after"))
    return (-most, most) if most > 0.0 else (-1.0, 1.0)


@plots.style()
def drawn(subject: Subject, shown: Shown) -> Figure:
    """The same as a still picture."""
    figure = plots.drawing(4.2)
    upper, lower = figure.subplots(2, 1, sharex=True)
    recording, each = shown.recording, _of(subject, shown)
    recorded = Look(subject.measured, MEASURED_COLOUR, None, 1.2)
    known = np.isfinite(recording.reading)
    plots.signal(upper, recording.time[known], recording.reading[known], recorded)
    upper.set_ylim(_frame(shown))
    lower.set_ylim(_error_frame(shown))
    for which, look in each.items():
        for axes, values in ((upper, shown.positions(which)), (lower, shown.errors(which))):
            plots.line(axes, *values, look)
            plots.mark_exits(axes, *values, look)
    plots.zero(lower)
    plots.over_time(lower, float(recording.time[0]), float(recording.time[-1]))
    upper.set_title(recording.name)
    upper.set_ylabel("position s [m]")
    lower.set_ylabel(f"run − {subject.measured} [mm]")
    figure.legend(
        handles=[plots.sample(look) for look in (recorded, *each.values())], loc="outside upper left", ncols=3
    )
    return figure


def picture(subject: Subject, shown: Shown, alt: str, caption: str) -> plots.Picture:
    """Still picture and chart of the same data."""
    with plots.style():
        figure = drawn(subject, shown)
        return plots.picture(figure, alt, caption, chart(subject, shown), "Triangles: a line leaves the frame.")
