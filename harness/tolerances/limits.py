"""A limit: source, horizon, metric and limiting value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from harness.comparison import Choices
from harness.engines.catalogue import ENGINES
from harness.metrics import Better, Metric, horizon_name

AGAINST_CAM = "against_cam"

DIFFERENCES = {
    metric.name: metric
    for metric in (
        Metric("max_difference_m", "largest |s − s_CAM|", "m", Better.SMALLER, ("max",)),
        Metric("rms_difference_m", "RMS of s − s_CAM", "m", Better.SMALLER, ("rms",)),
    )
}
"""Metrics of a source against CAM, by name. An ideal engine solves CAM's equation, so these metrics measure the contact
model and the numerical error of an engine, independently of the physics in the recording."""


@dataclass(frozen=True)
class Limit:
    """One limit.

    Attributes:
        source: `cam`, `mujoco` …
        seconds: window length, `None` for the free run over the whole recording [s].
        metric: one of `METRICS`, or of `DIFFERENCES` if `against_cam`.
        value: in the metric's unit; upper limit, lower limit, or upper limit of the magnitude (`Metric.better`).
        against_cam: whether the reference is CAM instead of the measurement.
    """

    source: str
    seconds: float | None
    metric: Metric
    value: float
    against_cam: bool = False

    @property
    def horizon(self) -> str:
        """As in metrics.csv: "whole", "2 s"."""
        return horizon_name(self.seconds)

    @property
    def place(self) -> str:
        """`mujoco 2 s`, `mujoco against_cam`, `mujoco against_cam 2 s`."""
        if not self.against_cam:
            return f"{self.source} {self.horizon}"
        return f"{self.source} {AGAINST_CAM}" + ("" if self.seconds is None else f" {self.horizon}")

    @property
    def relation(self) -> str:
        """`<=` or `>=`."""
        return ">=" if self.metric.better is Better.LARGER else "<="

    def margin(self, value: float) -> float:
        """Distance of `value` from the limit, relative to the limit; negative if the limit is violated."""
        match self.metric.better:
            case Better.SMALLER:
                room = self.value - value
            case Better.LARGER:
                room = value - self.value
            case Better.NEAR_ZERO:
                room = self.value - abs(value)
        if room == 0.0 or self.value != 0.0:
            return room / (abs(self.value) or 1.0)
        return room * float("inf")

    def __str__(self) -> str:
        name = f"|{self.metric.name}|" if self.metric.better is Better.NEAR_ZERO else self.metric.name
        unit = "" if self.metric.unit == "1" else f" {self.metric.unit}"
        return f"{self.place}: {name} {self.relation} {self.value:g}{unit}"


@dataclass(frozen=True)
class Tolerances:
    """The limits of a case.

    Attributes:
        path: their file.
        chosen: origin of the file: "given", "of the case" or "defaults of the package".
        limits: in the order of the file.
        tube: half width of the tolerance tube, `None` if the file does not set it [m].
    """

    path: Path
    chosen: str
    limits: tuple[Limit, ...]
    tube: float | None = None

    @property
    def engines(self) -> tuple[str, ...]:
        """Engines with at least one limit."""
        return tuple(engine for engine in ENGINES if any(limit.source == engine for limit in self.limits))

    def without(self, sources: Iterable[str]) -> Tolerances:
        """A copy without limits on `sources`."""
        dropped = set(sources)
        return replace(self, limits=tuple(limit for limit in self.limits if limit.source not in dropped))

    def applied_to(self, choices: Choices) -> Choices:
        """`choices` with the windows and the tube that the limits require."""
        wanted = {*choices.lengths, *(limit.seconds for limit in self.limits if limit.seconds is not None)}
        tube = choices.tolerance if self.tube is None else self.tube
        return replace(choices, lengths=tuple(sorted(wanted)), tolerance=tube)
