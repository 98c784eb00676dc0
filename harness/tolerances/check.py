"""A study held to limits: what was measured, and how much room is left."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM
from harness.comparison import Setting, Study
from harness.comparison.horizons import Horizon
from harness.errors import InputError
from harness.tolerances.limits import Limit, Tolerances


@dataclass(frozen=True)
class Checked:
    """One limit and what was found.

    Attributes:
        source, horizon, metric, unit: as in metrics.csv.
        against_cam: whether CAM is the reference, else the measurement.
        relation: `<=` or `>=`, of the value or, where the metric says so, of its magnitude.
        value: measured; NaN where there is none.
        limit: in the same unit.
        passed: whether the limit is kept.
        margin: room left, relative to the limit; negative where it is broken, NaN without a value.
        failure: why there is no value; empty where there is one.
        name: the limit in one line, as pytest shows it.
    """

    source: str
    horizon: str
    metric: str
    unit: str
    against_cam: bool
    relation: str
    value: float
    limit: float
    passed: bool
    margin: float
    failure: str
    name: str

    def finding(self) -> str:
        """What was found: value, limit and margin, or why there is no value."""
        if self.failure:
            return self.failure
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.value:.4g}{unit}, limit {self.relation} {self.limit:g}{unit}, margin {percent(self.margin)}"

    def text(self) -> str:
        """The limit and what was found, in one line."""
        return f"{self.name} {'kept' if self.passed else 'broken'}: {self.finding()}"


def percent(margin: float) -> str:
    """A margin with its sign; a dash where there is none."""
    return "-" if math.isnan(margin) else f"{100.0 * margin:+.{0 if abs(margin) >= 0.1 else 2}f} %"


def check(study: Study, tolerances: Tolerances) -> list[Checked]:
    """Hold `study` to every limit, in the order of the file.

    A limit on a source that failed, or that did not run, is not kept.

    Raises:
        InputError: as `require`.
    """
    require(study.setting, tolerances)
    horizons = {horizon.name: horizon for horizon in study.setting.horizons}
    return [_checked(study, limit, horizons[limit.horizon]) for limit in tolerances.limits]


def require(setting: Setting, tolerances: Tolerances) -> None:
    """Make sure that a study of `setting` can be held to `tolerances`.

    Raises:
        InputError: it will have another tube than the limits are meant for, or lacks a horizon: either it was not
            prepared with `tolerances.settle(choices)`, or the recording is too short for such a window.
    """
    tube = setting.choices.tolerance
    if tolerances.tube not in (None, tube):
        raise InputError(
            f"{tolerances.path}: [tube] tolerance_m = {tolerances.tube:g}, but the tube here is ±{tube:g} m. "
            "Use one of them."
        )
    names = [horizon.name for horizon in setting.horizons]
    for limit in tolerances.limits:
        if limit.horizon not in names:
            length = setting.time[-1] - setting.time[0]
            raise InputError(
                f"{tolerances.path}: {limit.place}: {setting.recording.path.name} ({length:.3g} s) holds no window of "
                f"{limit.horizon} with enough known positions; its horizons are {', '.join(names)}. Remove that limit, "
                "or name limits that suit with --tolerances."
            )


def _checked(study: Study, limit: Limit, horizon: Horizon) -> Checked:
    value, failure = _measured(study, limit, horizon)
    if not failure and math.isnan(value):
        failure = f"{limit.place}: {limit.metric.name} is not defined on this recording"
    return Checked(
        source=limit.source,
        horizon=limit.horizon,
        metric=limit.metric.name,
        unit=limit.metric.unit,
        against_cam=limit.against_cam,
        relation=limit.relation,
        value=value,
        limit=limit.value,
        passed=limit.metric.meets(value, limit.value),
        margin=limit.margin(value),
        failure=failure,
        name=str(limit),
    )


def _measured(study: Study, limit: Limit, horizon: Horizon) -> tuple[float, str]:
    """The metric's value, or NaN and why."""
    if limit.source not in study.sources:
        return math.nan, f"{limit.source} did not run; choose it with --engine {limit.source} or remove the limit"
    runs = study.run_of(limit.source, horizon)
    if runs.failures:
        others = len(runs.failures) - 1
        return math.nan, f"{runs.failures[0]}{f' (and {others} more windows)' if others else ''}"
    if not limit.against_cam:
        return float(getattr(study.score_of(limit.source, horizon), limit.metric.name)), ""
    cam = study.run_of(CAM.name, horizon)
    pieces = [(runs.position[i, where] - cam.position[i, where]) for i, where in enumerate(horizon.slices())]
    return _DIFFERENCE[limit.metric.name](np.concatenate(pieces)), ""


_DIFFERENCE = {
    "max_difference_m": lambda difference: float(np.max(np.abs(difference))),
    "rms_difference_m": lambda difference: float(np.sqrt(np.mean(difference**2))),
}
