"""Pictures of a measured rig: held-out errors by source, and windows, measured and predicted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.measured.page import LABELS
from harness.api.case import Case
from harness.api.saved import LoadedDiagnosis
from harness.identify.estimate.block_errors import group_fits
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.run import Excerpt, run_parts
from harness.identify.model_file import observed_for, prepared_for, read_forecasting
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.identify.record import BaselinesRecord
from harness.identify.validation.baseline_comparison import AFTER, BASELINES, BEFORE, FORECASTS
from harness.report.diagnosis.account import FOUND
from harness.report.palette import MEASURED_COLOUR

_DPI = 80
_MOST_WINDOWS = 6
_OTHER = "#5b6570"


def draw_errors(compared: BaselinesRecord, path: Path) -> Path:
    """Errors of all blocks by source, one point a block, and their RMS; returns `path`."""
    sources = [one for one in (AFTER, FORECASTS, BEFORE, *BASELINES) if one in compared.errors_m]
    figure = Figure(figsize=(8.0, 0.6 + 0.42 * len(sources)), layout="constrained")
    axes = figure.add_subplot()
    for row, source in enumerate(sources):
        errors = 1e3 * np.array([np.nan if error is None else error for error in compared.errors_m[source]])
        rms = compared.rms_m[source]
        colour = FOUND.colour if source == compared.predicting else _OTHER
        spread = 0.5 * (np.arange(len(errors)) / max(len(errors) - 1, 1) - 0.5)  # blocks in order, from top to bottom
        axes.plot(errors, row + spread, "o", color=colour, markersize=3.5, alpha=0.6, markeredgewidth=0.0)
        if rms is not None:
            axes.plot([1e3 * rms] * 2, [row - 0.35, row + 0.35], color=colour, linewidth=2.0)
    axes.set_yticks(range(len(sources)), [LABELS[source] for source in sources], fontsize=8)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlabel(f"RMS error of a held-out block over {AHEAD:g} s [mm]; line: over all blocks", fontsize=8)
    axes.tick_params(axis="x", labelsize=8)
    axes.grid(axis="x", which="both", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    return _saved(figure, path)


def draw_windows(case: Case, diagnosis: LoadedDiagnosis, path: Path) -> Path:
    """Windows of the first recording, predicted without the blocks that they belong to; returns `path`.

    Every third window is shown, so that predicted parts follow each other.
    """
    model = diagnosis.record.model
    recording = case.recordings[case.identify[0]]
    record = prepared_for(model, observed_for(model, recording, diagnosis.sensors))
    problem, found = read_forecasting(model, record, str(diagnosis.origin))
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    axes = figure.add_subplot()
    origin = record.time[0]
    axes.plot(record.time - origin, 1e3 * record.reading, ".", color=MEASURED_COLOUR, markersize=2.0, label="measured")
    label = f"held out, predicted from the {KNOWN:g} s before"
    shown = [(part, block.held_out[0]) for part, blocks in group_fits(problem, found) for block in blocks]
    for i, (part, window) in enumerate(shown[:_MOST_WINDOWS]):
        known = Excerpt(window.use, np.where(window.known, window.reading, np.nan))
        (run,) = run_parts(Dynamics(problem, part.terms), record, part.process_noise, [known])
        ahead = window.time >= KNOWN
        time = window.begin + window.time[ahead] - origin
        color = FOUND.colour
        axes.plot(time, 1e3 * run.recorded[ahead], color=color, linewidth=1.6, label="" if i else label)
        axes.axvline(window.begin + KNOWN - origin, color="0.85", linewidth=0.8, zorder=0)
    axes.set_xlabel(f"time [s] of {recording.name}", fontsize=8)
    axes.set_ylabel("ball position [mm]", fontsize=8)
    axes.tick_params(labelsize=8)
    figure.legend(loc="outside upper left", fontsize=8, frameon=False, ncols=2)
    return _saved(figure, path)


def _saved(figure: Figure, path: Path) -> Path:
    # without the program's version, so that the file changes with its content only
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})
    return path
