"""The runs of a sweep that its report draws one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.numerics import evenly_chosen
from harness.sweeps.factors import TIME_STEP
from harness.sweeps.plan import Plan
from harness.sweeps.ranges import Value
from harness.sweeps.results import CAM_ERROR, MEASURED, Results

MOST_RUNS = 800
"""Runs that are drawn: of more, so many are taken evenly from each source, and the best fits."""

_WIDE = 10.0  # ratio of the largest to the smallest value from which an axis is logarithmic


@dataclass(frozen=True)
class DrawnRun:
    """A run that did not fail.

    Attributes:
        number: of the run.
        source: model or engine.
        where: case and recording.
        values: of the factors that the sweep varies.
        seconds: processor time over the time that it simulates [1].
        error_cam: largest difference from CAM [m].
        error_measured: RMS error against the measurement [m].
        best: whether its combination has the smallest error of its source.
    """

    number: int
    source: str
    where: str
    values: Mapping[str, Value]
    seconds: float
    error_cam: float
    error_measured: float
    best: bool


def drawn_runs(plan: Plan, results: Results, file: Path) -> tuple[tuple[DrawnRun, ...], int]:
    """Runs to draw in the order of their numbers, and how many could be drawn.

    Args:
        plan: of the sweep.
        results: of its rows.
        file: `runs.parquet`.
    """
    import pandas as pd

    columns = ["run", "source", "point", "motion_s", "cpu_s", "failure", MEASURED, CAM_ERROR]
    rows = pd.read_parquet(file, columns=columns)
    rows = rows[rows["failure"].isna()]
    sources = plan.spec.sources
    chosen: set[int] = set()
    best: set[int] = set()
    for source in sources:
        own = rows[rows["source"] == source]
        chosen |= set(evenly_chosen(own.index.tolist(), MOST_RUNS // len(sources)))
        points = {one.point for one in results.best if one.source == source}
        best |= set(own.index[own["point"].isin(points)].tolist())
    # Of a best fit over very many recordings, those that are drawn anyway.
    chosen |= best if len(best) <= MOST_RUNS // 4 else set()
    made = []
    for row in rows.loc[sorted(chosen)].itertuples():
        at = dict(zip(("index", *columns), row, strict=True))
        run = plan.run(int(at["run"]))
        varied = {one.name for one in plan.spec.factors[run.source] if one.varied}
        made.append(
            DrawnRun(
                run.number,
                run.source,
                f"{plan.spec.case_names[run.case]}: {run.recording}",
                {name: value for name, value in run.values.items() if name in varied or name == TIME_STEP},
                at["cpu_s"] / at["motion_s"],
                at[CAM_ERROR],
                at[MEASURED],
                at["index"] in best,
            )
        )
    return tuple(sorted(made, key=lambda one: one.number)), len(rows)


def numeric_factors(plan: Plan) -> tuple[str, ...]:
    """Names of the factors whose values are numbers and that differ between runs, in the order of the spec."""
    found: dict[str, None] = {}
    for factors in plan.spec.factors.values():
        for one in factors:
            if one.varied and not any(isinstance(value, bool | str) for value in one.values):
                found[one.name] = None
    return tuple(found)


def logarithmic(plan: Plan, name: str) -> bool:
    """Whether a factor is drawn on a logarithmic axis: sampled so, or listed with positive values over decades."""
    given = [one for factors in plan.spec.factors.values() for one in factors if one.name == name]
    ranges = [one.range for one in given if one.range is not None]
    if ranges:
        return all(one.scale == "log" for one in ranges)
    values = [float(value) for one in given for value in one.values]
    return min(values) > 0.0 and max(values) > _WIDE * min(values)
