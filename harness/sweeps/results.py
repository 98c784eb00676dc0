"""What the rows of a sweep say: work and precision, the best fit to the measurement, indices, failures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.sweeps.factors import CAM_SOURCE, TIME_STEP
from harness.sweeps.indices import Indices, indices_of
from harness.sweeps.plan import Plan

if TYPE_CHECKING:
    import pandas as pd

MOST_STEPS = 24  # different step sizes, beyond which they were sampled and not compared
MEASURED, CAM_ERROR = "error_measured_rms_m", "error_cam_max_m"
OUTPUTS = (MEASURED, CAM_ERROR)
"""What Sobol' indices are of."""


@dataclass(frozen=True)
class WorkPrecision:
    """Accuracy and cost of a source at one step size, over all of its runs there.

    Attributes:
        source: model or engine.
        time_step: [s]; `None` for CAM.
        runs, failed: how many.
        seconds: median processor time of a run over the time that it simulates [1].
        error_cam: median of the largest difference from CAM [m].
        error_cam_max: largest of all [m].
        error_measured: median RMS error against the measurement [m].
    """

    source: str
    time_step: float | None
    runs: int
    failed: int
    seconds: float
    error_cam: float
    error_cam_max: float
    error_measured: float


@dataclass(frozen=True)
class Best:
    """The combination of values with the smallest RMS error against the measurement, over recordings.

    Attributes:
        source: model or engine.
        point: its number.
        run: number of its run on the first of the recordings.
        error: RMS over the recordings [m].
        largest: the same of the combination with the largest error [m].
        values: of the factors that the sweep varies.
        candidates: combinations that failed on none of the recordings.
        recordings: how many these are: all but those on which every combination failed.
    """

    source: str
    point: int
    run: int
    error: float
    largest: float
    values: dict[str, Any]
    candidates: int
    recordings: int


@dataclass(frozen=True)
class Failing:
    """Failures of one name.

    Attributes:
        source: model or engine.
        failure: its name.
        runs: how many runs failed so.
        example: number of the first of them.
        message: of that one.
    """

    source: str
    failure: str
    runs: int
    example: int
    message: str


@dataclass(frozen=True)
class Results:
    """What the rows say; failures and best fits by source, in the order of the spec."""

    runs: int
    failed: int
    work_precision: tuple[WorkPrecision, ...]
    best: tuple[Best, ...]
    failures: tuple[Failing, ...]
    indices: tuple[Indices, ...] = field(default=())


def results_of(plan: Plan, file: Path) -> Results:
    """Read the rows of a finished sweep and sum them up.

    Args:
        plan: of the sweep.
        file: `runs.parquet`.
    """
    import pandas as pd

    columns = ["run", "source", "point", "motion_s", "cpu_s", "failure", *OUTPUTS]
    if TIME_STEP in plan.names:
        columns.append(TIME_STEP)
    rows = pd.read_parquet(file, columns=columns)
    return Results(
        runs=len(rows),
        failed=int(rows["failure"].notna().sum()),
        work_precision=tuple(_work_precision(rows, plan)),
        best=tuple(_best(rows, plan)),
        failures=tuple(_failures(rows, file, plan)),
        indices=tuple(_indices(rows, plan)) if plan.spec.indices else (),
    )


def _of_sources(rows: pd.DataFrame, plan: Plan) -> Iterator[tuple[str, pd.DataFrame]]:
    for source in plan.spec.sources:
        yield source, rows[rows["source"] == source]


def _work_precision(rows: pd.DataFrame, plan: Plan) -> Iterator[WorkPrecision]:
    for source, own in _of_sources(rows, plan):
        if source == CAM_SOURCE:
            yield _cost(source, None, own)
            continue
        steps = sorted(own[TIME_STEP].unique(), reverse=True)
        if len(steps) <= MOST_STEPS:
            for step in steps:
                yield _cost(source, float(step), own[own[TIME_STEP] == step])


def _cost(source: str, step: float | None, rows: pd.DataFrame) -> WorkPrecision:
    good = rows[rows["failure"].isna()]
    return WorkPrecision(
        source,
        step,
        len(rows),
        len(rows) - len(good),
        float((good["cpu_s"] / good["motion_s"]).median()),
        float(good[CAM_ERROR].median()),
        float(good[CAM_ERROR].max()),
        float(good[MEASURED].median()),
    )


def _over_recordings(rows: pd.DataFrame, output: str, plan: Plan) -> tuple[pd.Series, int]:
    """Root mean square of an output over recordings, by point, NaN where it failed on any of them; their number.

    A recording on which every point failed says nothing of any of them, and is left out.
    """
    usable = int((rows.loc[rows[output].notna(), "run"] // plan.per_recording).nunique())
    squares = (rows[output] ** 2).groupby(rows["point"])
    return np.sqrt(squares.mean().where(squares.count() == usable)), usable


def _best(rows: pd.DataFrame, plan: Plan) -> Iterator[Best]:
    for source, own in _of_sources(rows, plan):
        errors, recordings = _over_recordings(own, MEASURED, plan)
        errors = errors.dropna()
        if errors.empty:
            continue
        point = int(errors.index.to_numpy()[errors.to_numpy().argmin()])
        run = int(own.loc[(own["point"] == point) & own[MEASURED].notna(), "run"].min())
        varied = {one.name for one in plan.spec.factors[source] if one.varied}
        values = {name: value for name, value in plan.run(run).values.items() if name in varied}
        yield Best(source, point, run, float(errors.min()), float(errors.max()), values, len(errors), recordings)


def _failures(rows: pd.DataFrame, file: Path, plan: Plan) -> Iterator[Failing]:
    import pyarrow.parquet as pq

    for source, own in _of_sources(rows, plan):
        for name, failed in own.groupby("failure"):
            first = int(failed["run"].min())
            (text,) = pq.read_table(file, columns=["message"], filters=[("run", "=", first)])["message"].to_pylist()
            yield Failing(source, str(name), len(failed), first, text)


def _indices(rows: pd.DataFrame, plan: Plan) -> Iterator[Indices]:
    for source, own in _of_sources(rows, plan):
        design = plan.designs[source]
        if not design.ranged:
            continue
        count = len(design.samples)
        for output in OUTPUTS:
            if source == CAM_SOURCE and output == CAM_ERROR:
                continue
            errors, _ = _over_recordings(own, output, plan)
            values = errors.reindex(range(len(design))).to_numpy(dtype=np.float64)
            for block in range(len(design) // count):
                listed = {
                    name: value
                    for name, value in design.values(block * count).items()
                    if name not in {one.name for one in design.ranged}
                    and any(one.name == name and one.varied for one in design.listed)
                }
                part = values[block * count : (block + 1) * count]
                names = [one.name for one in design.ranged]
                yield indices_of(source, output, listed, names, part, seed=plan.spec.seed)
