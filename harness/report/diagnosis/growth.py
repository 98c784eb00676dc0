"""Figure of the errors of CAM over the prediction horizon, before and after, held out and identification."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analytic.motion import FloatArray
from harness.formatting import brief
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import HORIZONS, KNOWN, folds, horizon_spans
from harness.metrics.score import WHOLE
from harness.report.chart import Chart, Panel, Trace
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.palette import Look
from harness.report.plots import Picture, drawing, line, picture, plain_log, style

NOISE = Look("reading noise", "#5b6672", (2.0, 2.0), 1.0, 2)
_WIDTH = 1.6  # of the lines [pt]


@dataclass(frozen=True)
class _Line:
    """Errors of one model on one kind of recordings.

    Attributes:
        look: of its line.
        marker: of its points on paper.
        lengths: of the predicted spans, shape (k,) [s].
        errors: RMS over all spans of a length, shape (k,) [mm].
        notes: what was predicted, k texts.
    """

    look: Look
    marker: str
    lengths: FloatArray
    errors: FloatArray
    notes: Sequence[str]


@style()
def picture_of(account: Account) -> Picture:
    """RMS error over the length of the predicted spans, for screen and paper."""
    lines = [one for one in _lines(account) if one.notes]
    ends = np.array([HORIZONS[0], max((float(one.lengths.max()) for one in lines), default=HORIZONS[-1])])
    noise = np.full(2, 1e3 * float(np.sqrt(account.diagnosis.problem.reading_variance)))
    figure = drawing(2.9)
    axes = figure.add_subplot()
    for one in lines:
        line(axes, one.lengths, one.errors, one.look)
        axes.lines[-1].set(marker=one.marker, markersize=5, label=one.look.label)
    line(axes, ends, noise, NOISE)
    axes.lines[-1].set_label(NOISE.label)
    plain_log(axes, "x", [mark for mark in (*HORIZONS, 10.0, 20.0, 50.0, 100.0, 200.0) if mark <= ends[1]])
    plain_log(axes, "y")
    axes.set(xlabel="prediction horizon [s]; the last is the rest of a recording", ylabel="RMS error [mm]")
    figure.legend(loc="outside right upper")
    traces = [Trace(one.look.label, one.look, one.lengths, one.errors, notes=one.notes) for one in lines]
    panel = Panel("RMS error", "mm", [*traces, Trace("noise", NOISE, ends, noise)], log=True)
    return picture(
        figure,
        "RMS error of the positions predicted by CAM against the prediction horizon.",
        "RMS error of the positions predicted by CAM against the prediction horizon, both logarithmic. The last "
        f"horizon is the rest of a recording after its first {brief(KNOWN)} s, at the mean length of those predicted.",
        Chart("growth", [panel], "prediction horizon", "s", log_x=True),
    )


def _lines(account: Account) -> list[_Line]:
    """Two of each kind, or one if nothing was found."""
    diagnosis = account.diagnosis
    held_out = [one for fold in folds(diagnosis.problem) for one in fold.left]
    lines = []
    for kind, both, predicted, dash, marker in (
        ("held out", diagnosis.heldout, held_out, None, "o"),
        ("identification", diagnosis.identify, diagnosis.problem.recordings, (1.5, 2.5), "s"),
    ):
        compared = [("before", both.before, MODEL), ("after", both.after, FOUND)]
        for when, errors, model in compared[: 2 if account.changed else 1]:
            label = f"{kind}, {when}" if account.changed else kind
            lengths = np.array([_length(name, predicted) for name in errors.rms])
            notes = ["rest" if name == WHOLE else f"windows of {name}" for name in errors.rms]
            look = replace(model, label=label, dash=dash, width=_WIDTH)
            lines.append(_Line(look, marker, lengths, 1e3 * np.array(list(errors.rms.values())), notes))
    return lines


def _length(name: str, recordings: Sequence[PreparedRecording]) -> float:
    """Mean length of the spans that a horizon names [s]."""
    lengths = []
    for one in recordings:
        time = one.time - one.time[0]
        end = float(time[-1])
        lengths += [min(last, end) - first for each, first, last in horizon_spans(time) if each == name and first < end]
    return float(np.mean(lengths))
