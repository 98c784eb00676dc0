"""Compares a study with limits: value and margin of each, also as a plain-text table."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM
from harness.comparison import Setting, Study
from harness.comparison.horizons import Horizon
from harness.errors import InputError
from harness.numerics import rms
from harness.tolerances.limits import Limit, Tolerances


@dataclass(frozen=True)
class Checked:
    """The outcome of one limit.

    Attributes:
        source, horizon, metric, unit: as in metrics.csv.
        against_cam: whether the reference is CAM instead of the measurement.
        relation: `<=` or `>=`, of the value or, for signed metrics, of its magnitude.
        value: of the metric; NaN if there is none.
        limit: in the same unit.
        passed: whether the limit is satisfied.
        margin: relative to the limit; negative if it is violated, NaN without a value.
        failure: why there is no value; else empty.
        name: the limit in one line, as in pytest.
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

    def outcome(self) -> str:
        """Value, limit and margin, or why there is no value."""
        if self.failure:
            return self.failure
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.value:.4g}{unit}, limit {self.relation} {self.limit:g}{unit}, margin {percent(self.margin)}"

    def text(self) -> str:
        """The limit and its outcome, in one line."""
        return f"{self.name} {'kept' if self.passed else 'broken'}: {self.outcome()}"


def percent(margin: float) -> str:
    """A margin with its sign; a dash for NaN."""
    return "-" if math.isnan(margin) else f"{100.0 * margin:+.{0 if abs(margin) >= 0.1 else 2}f} %"


def check(study: Study, tolerances: Tolerances) -> list[Checked]:
    """Checks every limit, in the order of the file.

    A limit on a source that failed or did not run counts as violated.

    Raises:
        InputError: as `require`.
    """
    require(study.setting, tolerances)
    horizons = {horizon.name: horizon for horizon in study.setting.horizons}
    return [_checked(study, limit, horizons[limit.horizon]) for limit in tolerances.limits]


def require(setting: Setting, tolerances: Tolerances) -> None:
    """Checks that `tolerances` apply to a study of `setting`.

    Raises:
        InputError: the tube differs, or a horizon is missing: the setting was not prepared with
            `tolerances.applied_to(choices)`, or the recording is too short for the window.
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
                f"{tolerances.path}: {limit.place}: {setting.recording.path.name} ({length:.3g} s) has no window of "
                f"{limit.horizon} with enough known positions; its horizons are {', '.join(names)}. Remove that limit, "
                "or pass other limits with --tolerances."
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
    return _DIFFERENCE[limit.metric.name](runs.position - cam.position), ""


_DIFFERENCE = {
    "max_difference_m": lambda difference: float(np.max(np.abs(difference))),
    "rms_difference_m": rms,
}


def render_table(checks: Sequence[Checked]) -> str:
    """One line per limit with value and margin, then failures in words and the number of violated limits."""
    rows = [("", "limit", "value", "margin"), *(_row(one) for one in checks)]
    outcome, name, value, margin = (max(map(len, column)) for column in zip(*rows, strict=True))
    lines = [f"{o:<{outcome}}  {n:<{name}}  {v:>{value}}  {m:>{margin}}".rstrip() for o, n, v, m in rows]
    broken = [one for one in checks if not one.passed]
    verdict = f"{len(broken) or len(checks)} of {len(checks)} limits {'broken' if broken else 'kept'}"
    failures = dict.fromkeys(one.failure for one in checks if one.failure)
    return "\n".join([*lines, *failures, verdict])


def _row(one: Checked) -> tuple[str, str, str, str]:
    unit = "" if one.unit == "1" else f" {one.unit}"
    value = "none" if one.failure else f"{one.value:.4g}{unit}"
    return "kept" if one.passed else "BROKEN", one.name, value, percent(one.margin)
