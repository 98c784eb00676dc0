"""How errors grow with the length of a run, and what a run over the whole recording is worth."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from harness.comparison.horizons import Horizon
from harness.formatting import number, plus_minus
from harness.report.answer import still_error
from harness.report.comparison.overlay import overlay
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import INK, UNCERTAINTY_COLOUR, look_of, swatch
from harness.report.plots import WIDTH, Picture, picture, plain_log, sample, style
from harness.report.tables import Column, Row, Table


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


def floor(subject: Subject, horizon: Horizon) -> float:
    """RMS of u_val on a horizon [m]: what a perfect model would still be off by."""
    return float(np.sqrt(np.nanmean(subject.study.u_val_of(horizon) ** 2)))


def _ordered(subject: Subject) -> list[Horizon]:
    """Horizons from short to long."""
    return sorted(subject.study.setting.horizons, key=lambda one: one.seconds or math.inf)


def _growth(subject: Subject) -> Picture:
    study, horizons = subject.study, _ordered(subject)
    seconds = np.array([one.seconds or subject.duration for one in horizons])
    floors = 1e3 * np.array([floor(subject, one) for one in horizons])
    still = 1e3 * np.array([still_error(study, one) for one in horizons])
    with style():
        figure = Figure(figsize=(WIDTH, 3.5), layout="constrained")
        axes = figure.add_subplot()
        plain_log(axes, "x", list(seconds))
        plain_log(axes, "y")
        largest = float(max(still.max(), floors.max()))
        entries: list[Artist] = []
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
            entries.append(sample(look, look.label))
        bottom = 0.5 * min(floors)
        axes.fill_between(seconds, bottom, floors, color=UNCERTAINTY_COLOUR, alpha=0.35, linewidth=0, zorder=1)
        axes.plot(seconds, still, color=INK, linewidth=1.1, linestyle=(0, (1, 2)), zorder=2)
        entries.append(
            Line2D([], [], color=INK, linewidth=1.1, linestyle=(0, (1, 2)), label="ball that stays in place")
        )
        entries.append(Patch(color=UNCERTAINTY_COLOUR, alpha=0.35, label=r"$u_\mathrm{val}$: a perfect model"))
        axes.set_ylim(bottom, 2.0 * largest)
        axes.set_xlabel("length of the runs [s]; the last is the whole recording")
        axes.set_ylabel("RMS error [mm]")
        figure.legend(handles=entries, loc="outside right upper", handlelength=2.6)
        alt = f"RMS position error of every source against the length of the runs, {number(seconds[0])} to " + (
            f"{number(seconds[-1])} s, with the floor u_val and the error of a ball that stays in place."
        )
        caption = (
            "RMS error against the length of the runs (bars: standard error over the windows). A source below "
            "the dotted "
            "line tells something about the motion; one within the grey area cannot be improved on with this recording."
        )
        return picture(figure, alt, caption)


def _table(subject: Subject) -> Table:
    study, horizons = subject.study, _ordered(subject)
    columns = [Column("source", text=True)]
    for one in horizons:
        mark = " (headline)" if one is study.headline else ""
        runs = f"{len(one.first)} runs" if len(one.first) > 1 else "1 run"
        columns.append(Column(one.name + mark, f"mm, {runs}"))
    rows = []
    for standing in subject.ranked:
        scores = [study.score_of(standing.source, one) for one in horizons]
        cells = [plus_minus(one.rms_error_mm, one.rms_error_standard_error_mm) for one in scores]
        rows.append(Row((swatch(standing.source), *cells)))
    rows.append(_reference("u_val: a perfect model", [floor(subject, one) for one in horizons]))
    rows.append(_reference("a ball that stays in place", [still_error(study, one) for one in horizons]))
    return Table(f"RMS error of the ball's position against the {subject.recording}, ± standard error", columns, rows)


def _reference(name: str, values: list[float]) -> Row:
    return Row((name, *(number(1e3 * value) for value in values)), "reference")
