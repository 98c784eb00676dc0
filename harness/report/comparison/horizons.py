"""Section on errors by horizon, compared with u_val and a stationary ball."""

import math

import numpy as np
from matplotlib.artist import Artist
from matplotlib.patches import Patch

from harness.comparison.horizons import Horizon
from harness.formatting import number, plus_minus
from harness.report.answer import still_error
from harness.report.chart import Chart, Panel, Trace
from harness.report.comparison.overlay import overlay
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import INK, UNCERTAINTY_COLOUR, Look, look_of, swatch
from harness.report.plots import Picture, band, drawing, line, picture, plain_log, sample, style
from harness.report.tables import Column, Row, Table, texts

FLOOR = Look("u_val: a perfect model", UNCERTAINTY_COLOUR)
STATIONARY = Look("stationary ball", INK, (1.0, 2.0), 1.1, 2)


def section(subject: Subject) -> Section:
    """Errors by horizon."""
    context = {
        "growth": _growth(subject),
        "table": _table(subject),
        "free_run": overlay(subject, subject.whole) if subject.study.headline is not subject.whole else None,
        "headline": subject.study.headline.name,
        "several": len(subject.study.setting.horizons) > 1,
    }
    return Section("horizons", "How errors grow with the horizon", "Horizons", "comparison/horizons.html", context)


def _ordered(subject: Subject) -> list[Horizon]:
    """Horizons from short to long."""
    return sorted(subject.study.setting.horizons, key=lambda one: one.seconds or math.inf)


@style()
def _growth(subject: Subject) -> Picture:
    study, horizons = subject.study, _ordered(subject)
    seconds = np.array([one.seconds or subject.duration for one in horizons])
    floors = 1e3 * np.array([study.floor(one) for one in horizons])
    still = 1e3 * np.array([still_error(study, one) for one in horizons])
    figure = drawing(3.5)
    axes = figure.add_subplot()
    plain_log(axes, "x", list(seconds))
    plain_log(axes, "y")
    largest = float(max(still.max(), floors.max()))
    entries: list[Artist] = []
    traces: list[Trace] = []
    names = [one.name for one in horizons]
    for standing in subject.ranked:
        look = look_of(standing.source)
        scores = [study.score_of(standing.source, one) for one in horizons]
        rms = np.array([one.rms_error_mm for one in scores])
        std = np.nan_to_num([one.rms_error_standard_error_mm for one in scores])
        rms = np.where(np.isfinite(rms), rms, np.nan)
        largest = float(np.nanmax([largest, *rms]))
        drawn = axes.errorbar(
            seconds, rms, yerr=std, color=look.colour, linewidth=look.width, marker="o", markersize=4,
            elinewidth=1.0, zorder=look.layer,
        )  # fmt: skip
        if look.dash:
            drawn.lines[0].set_dashes(look.dash)
        entries.append(sample(look))
        notes = [f"{one.name}, {len(one.first)} run{'s' if len(one.first) > 1 else ''}" for one in horizons]
        traces.append(Trace(standing.source, look, seconds, rms, notes=notes, spread=np.where(std > 0.0, std, np.nan)))
    bottom = 0.5 * min(floors)
    band(axes, seconds, np.full_like(floors, bottom), floors)
    line(axes, seconds, still, STATIONARY)
    entries.append(sample(STATIONARY))
    entries.append(Patch(color=UNCERTAINTY_COLOUR, alpha=0.35, label=r"$u_\mathrm{val}$: a perfect model"))
    traces = [
        Trace("uncertainty", FLOOR, seconds, floors, low=np.full_like(floors, bottom)),
        *traces,
        Trace("stationary", STATIONARY, seconds, still, notes=names),
    ]
    panel = Panel("RMS error", "mm", traces, frame=(bottom, 2.0 * largest), log=True)
    axes.set_ylim(bottom, 2.0 * largest)
    axes.set_xlabel("length of the runs [s]; the last is the whole recording")
    axes.set_ylabel("RMS error [mm]")
    figure.legend(handles=entries, loc="outside right upper", handlelength=2.6)
    return picture(
        figure,
        f"RMS position error of every source against the length of the runs, {number(seconds[0])} to "
        f"{number(seconds[-1])} s, with u_val and the error of a stationary ball.",
        "RMS error against the length of the runs (bars: standard error over windows). A source below the dotted "
        "line predicts better than a stationary ball; the error of one within the shaded area is explained by u_val.",
        Chart("growth", [panel], "length of the runs", "s", log_x=True),
    )


def _table(subject: Subject) -> Table:
    study, horizons = subject.study, _ordered(subject)
    columns = texts("source")
    for one in horizons:
        mark = " (headline)" if one is study.headline else ""
        columns.append(Column(one.name + mark, f"mm, {len(one.first)} run{'s' if len(one.first) > 1 else ''}"))
    rows = []
    for standing in subject.ranked:
        scores = [study.score_of(standing.source, one) for one in horizons]
        cells = [plus_minus(one.rms_error_mm, one.rms_error_standard_error_mm) for one in scores]
        rows.append(Row((swatch(standing.source), *cells)))
    references = {
        "u_val: a perfect model": [study.floor(one) for one in horizons],
        "stationary ball": [still_error(study, one) for one in horizons],
    }
    rows += [Row((name, *(number(1e3 * one) for one in errors)), "reference") for name, errors in references.items()]
    what = "simulated recording" if subject.simulated else "measurement"
    return Table(f"RMS error of the ball's position against the {what}, ± standard error", columns, rows)
