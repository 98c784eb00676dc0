"""Sections on the engines: their errors split into step size, contact model and missing physics; health, settings."""

from collections.abc import Sequence

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from analytic.motion import FloatArray
from harness.comparison.attribution import Attribution
from harness.comparison.sources import SourceRuns
from harness.engines.health import Health, largest_of_each
from harness.engines.protocol import Engine
from harness.formatting import fixed, length, number, percent
from harness.report.chart import Chart, Panel, Trace
from harness.report.comparison.overlay import CLOCK
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import Look, label_of, swatch
from harness.report.plots import Picture, drawing, over_time, picture, style
from harness.report.tables import Column, Row, Table, texts

_PARTS = {
    "numerical": ("step size", "#0072B2", "engine − engine at dt → 0"),
    "contact": ("contact model", "#E69F00", "engine at dt → 0 − CAM"),
    "physics": ("missing physics", "#882255", "CAM − recording"),
}
_MIN_DRAWN = 1e-9  # lower limit of the logarithmic axis [m]


def attribution(subject: Subject) -> Section | None:
    """Errors split into parts; `None` if no engine ran."""
    parts = subject.study.attributions
    if not subject.study.engines:
        return None
    split = {one.source for one in parts}
    context = {
        "table": _parts(parts) if parts else None,
        "picture": _picture(subject, parts) if parts else None,
        "missing": [label_of(engine.name) for engine, _ in subject.study.engines if engine.name not in split],
    }
    return Section(
        "attribution", "Attribution of the engines' errors", "Attribution", "comparison/attribution.html", context
    )


def _parts(parts: Sequence[Attribution]) -> Table:
    columns = [*texts("engine"), Column("step", "ms")]
    for title, _, formula in _PARTS.values():
        columns += [Column(title, "RMS", hint=formula), Column("share", hint="of the mean square error")]
    rows = []
    for one in parts:
        rms, shares = one.rms(), one.shares()
        cells = [cell for name in _PARTS for cell in (length(rms[name]), _share(shares[name]))]
        rows.append((swatch(one.source), number(1e3 * one.time_step), *cells, length(rms["total"])))
    caption = "Parts of each engine's error in the whole free run; their sum is the error"
    return Table(caption, [*columns, "sum [RMS]"], rows)


def _share(value: float) -> str:
    return "< 0.1 %" if abs(value) < 5e-4 else percent(value)


@style()
def _picture(subject: Subject, parts: Sequence[Attribution]) -> Picture:
    setting = subject.study.setting
    time = setting.time[setting.horizons[0].stamps]
    figure = drawing(3.2)
    grid = figure.subplots(1, len(parts), sharey=True, squeeze=False)[0]
    highest = _MIN_DRAWN
    for axes, one in zip(grid, parts, strict=True):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(FixedLocator([1e-9, 1e-6, 1e-3, 1.0]))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: length(value, 1)))
        axes.yaxis.set_minor_locator(NullLocator())
        for name, (title, colour, _) in _PARTS.items():
            size = np.where(one.use, np.abs(getattr(one, name)), np.nan)
            highest = max(highest, float(np.nanmax(size)))
            axes.plot(time, np.maximum(size, _MIN_DRAWN), color=colour, linewidth=1.2, label=title)
        axes.set_title(label_of(one.source))
        over_time(axes, time[0], time[-1])
    grid[0].set(ylim=(_MIN_DRAWN, 3.0 * highest), ylabel="magnitude of each part")
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=3)
    drawn = ", ".join(label_of(one.source) for one in parts)
    return picture(
        figure,
        f"Magnitude of the numerical, contact and physics parts of the error of {drawn}.",
        "Magnitude of the three parts in the whole free run, logarithmic.",
        Chart("parts-over-time", [_panel(one, time, highest) for one in parts], clock=CLOCK),
    )


def _panel(one: Attribution, time: FloatArray, highest: float) -> Panel:
    """The parts of one engine's error as data of the page.

    Args:
        one: the parts.
        time: their stamps, shape (k,) [s].
        highest: the largest of all [m].
    """
    traces = []
    for name, (title, colour, _) in _PARTS.items():
        size = np.where(one.use, np.abs(getattr(one, name)), np.nan)
        traces.append(Trace(f"part-{name}", Look(title, colour), time, np.maximum(size, _MIN_DRAWN)))
    return Panel("magnitude", "m", traces, frame=(_MIN_DRAWN, 3.0 * highest), log=True, title=label_of(one.source))


def health(subject: Subject) -> Section | None:
    """Failures, health of the runs, settings; `None` if no engine ran."""
    study = subject.study
    if not study.engines:
        return None
    runs = [study.run_of(engine.name, horizon) for engine, _ in study.engines for horizon in study.setting.horizons]
    context = {
        "failures": [(run.horizon.name, str(failure)) for run in runs for failure in run.failures],
        "warnings": [(label_of(engine.name), text) for engine, _ in study.engines for text in _warnings(runs, engine)],
        "lift_offs": [(", ".join(map(label_of, who)), text) for text, who in study.sources_by_lift_off.items()],
        "table": _health(runs),
        "settings": [
            (
                _title(engine),
                engine.version(),
                f"as in {engine.scene_file}" if engine.scene_file else "engine's own",
                list(parameters.model_dump().items()),
            )
            for engine, parameters in study.engines
        ],
    }
    return Section("engines", "Engines", "Engines", "comparison/engines.html", context)


def _warnings(runs: Sequence[SourceRuns], engine: Engine) -> tuple[str, ...]:
    own = [run for run in runs if run.source == engine.name]
    return largest_of_each(text for run in own for health in run.health for text in health.warnings)


def _title(engine: Engine) -> str:
    """Name of an engine, and of the user's scene that it runs."""
    return label_of(engine.name) + (f" with {engine.scene_file}," if engine.scene_file else "")


def _health(runs: Sequence[SourceRuns]) -> Table:
    columns = [
        *texts("engine", "horizon"), "runs [valid of all]", "steps", "contacts [fewest–most]",
        "smallest normal force [N]", "height error", "lateral offset", "slip [mm/s]", "angle error [rad]",
    ]  # fmt: skip
    rows = []
    for run in runs:
        valid = f"{len(run.health)} of {len(run.health) + len(run.failures)}"
        cells = _extremes(run.health) if run.health else ("—",) * 7
        rows.append(Row((swatch(run.source), run.horizon.name, valid, *cells), "failed" if run.failures else ""))
    return Table("Extremes over all runs; failed runs are not scored", columns, rows)


def _extremes(health: Sequence[Health]) -> tuple[str, ...]:
    fewest, most = min(h.contacts_min for h in health), max(h.contacts_max for h in health)
    return (
        fixed(sum(h.steps for h in health), 0),
        f"{fewest}" if fewest == most else f"{fewest}–{most}",
        number(min(h.normal_force_min for h in health)),
        length(max(h.height_error_max for h in health), 2),
        length(max(h.lateral_offset_max for h in health), 2),
        number(1e3 * max(h.slip_max for h in health), 2),
        number(max(h.angle_error_max for h in health), 2),
    )
