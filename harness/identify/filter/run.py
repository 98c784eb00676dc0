"""The filter over one recording or all recordings of a problem, with terms added to the baseline model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from analytic.effects import SensorLaw
from analytic.motion import FloatArray
from harness.identify.filter.arguments import BeamTable, FilterOutput, Memory, Readings, Sensor
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.ekf import extended_kalman_filter, negative_two_log_likelihood
from harness.identify.problem.hypothesis import Own, Terms
from harness.identify.problem.problem import PreparedRecording, Problem, filtered_against
from harness.threads import in_threads

_WORTH_THREADS = 3000  # readings: a thread begins and ends as long as the filter takes for some 800


@dataclass(frozen=True)
class FilterRun:
    """The filter's output for a recording (`FilterOutput`), with the law of the sensor."""

    innovation: FloatArray
    innovation_variance: FloatArray
    state: FloatArray
    position_variance: FloatArray
    sensor: SensorLaw

    @property
    def recorded(self) -> FloatArray:
        """Sensor output for the filtered state, shape (n,) [m]."""
        return self.sensor.curve(self._sensed)

    @property
    def recorded_variance(self) -> FloatArray:
        """Its variance, without that of a reading, shape (n,) [m²]."""
        with np.errstate(over="ignore", invalid="ignore"):  # a prediction may leave any beam
            return self.position_variance * self.sensor.slope(self._sensed) ** 2

    @property
    def _sensed(self) -> FloatArray:
        return self.state[:, 3 if self.sensor.lag > 0.0 else 0]


def run_filter(
    problem: Problem,
    recording: PreparedRecording,
    added: Terms,
    process_noise: float,
    *,
    own: Own | None = None,
    reading: FloatArray | None = None,
    points: bool = True,
    shared: bool = False,
) -> FilterRun:
    """Run the filter over one recording.

    Args:
        added: terms beside the known effects.
        process_noise: density [m²/s³].
        own: what the recording has of its own; by default what the terms say.
        reading: readings in place of the recording's, shape (n,), NaN where missing [m].
        points: whether steps in which dry friction may stop the ball are taken at points.
        shared: whether rests on one count inform once, as an estimate from all recordings needs it; a prediction is of
            one rest and its error.
    """
    part, model = Excerpt(slice(None), reading), Dynamics(problem, added)
    (run,) = run_parts(model, recording, process_noise, [part], own=own, points=points, shared=shared)
    return run


class Excerpt(NamedTuple):
    """Consecutive stamps of a recording, and readings in place of its own, NaN where missing [m]; as many."""

    use: slice
    reading: FloatArray | None


def run_parts(
    model: Dynamics,
    recording: PreparedRecording,
    process_noise: float,
    parts: Sequence[Excerpt],
    *,
    own: Own | None = None,
    points: bool = True,
    shared: bool = False,
) -> list[FilterRun]:
    """Run the filter over parts of one recording, each from its own first reading.

    Args:
        model: the problem's, with terms.
        process_noise, own, points, shared: as for `run_filter`.
    """
    sensor = _sensor(model)
    p, table = model.of(recording, own)
    error = recording.error_with((*model.problem.declared, *model.added.effects), shared=shared)
    runs = []
    for use, reading in parts:
        first, last, _ = use.indices(len(recording.time))
        readings = Readings(recording.time[use], recording.reading[use] if reading is None else reading)
        beam = beam_over(recording, table, use)
        out = extended_kalman_filter(readings, beam, p, sensor, process_noise, error.between(first, last), points)
        runs.append(FilterRun(*out, model.law))
    return runs


def run_ahead(
    problem: Problem,
    recording: PreparedRecording,
    added: Terms,
    process_noise: float,
    spans: Sequence[slice],
    *,
    own: Own | None = None,
) -> tuple[FilterRun, list[FilterRun]]:
    """Run the filter over one recording, and from its readings before each of some spans on over that span without any.

    The run over the recording is made once and halted where spans begin, so that the work grows with the length of the
    recording and of the spans.

    Args:
        spans: consecutive stamps each, with a begin and an end.
        own, added, process_noise: as for `run_filter`.

    Returns:
        The run over all stamps, and one over the stamps of each span.
    """
    model = Dynamics(problem, added)
    law, sensor = model.law, _sensor(model)
    p, table = model.of(recording, own)
    error, beam = recording.error_with((*problem.declared, *added.effects)), beam_over(recording, table)
    known = Readings(recording.time, recording.reading)
    none = Readings(recording.time, np.full_like(recording.reading, np.nan))

    def run(readings: Readings, memory: Memory, use: slice) -> FilterOutput:
        return extended_kalman_filter(readings, beam, p, sensor, process_noise, error, memory=memory, use=use)

    memory, parts, at = Memory.blank(error), [], 0
    ahead: dict[int, FilterRun] = {}
    for i in sorted(range(len(spans)), key=lambda i: int(spans[i].start)):
        if spans[i].start > at:
            parts.append(run(known, memory, slice(at, spans[i].start)))
            at = spans[i].start
        ahead[i] = FilterRun(*run(none, memory.copy(), spans[i]), law)
    parts.append(run(known, memory, slice(at, None)))
    whole = FilterOutput(*(np.concatenate(each) for each in zip(*parts, strict=True)))
    return FilterRun(*whole, law), [ahead[i] for i in range(len(spans))]


def _sensor(model: Dynamics) -> Sensor:
    """The sensor as the filter takes it."""
    problem, law = model.problem, model.law
    noise = problem.colour
    return Sensor(
        law.gain,
        law.lag,
        problem.reading_variance * (1.0 - noise.share),
        law.square,
        law.cube,
        problem.reading_variance * noise.share,
        noise.time,
    )


def beam_over(recording: PreparedRecording, table: FloatArray, use: slice = slice(None)) -> BeamTable:
    """The beam's motion over consecutive stamps of a recording, from its table."""
    steps, marks = recording.grid.steps, recording.grid.marks[use]
    begin, end = int(marks[0]), int(marks[-1])
    return BeamTable(steps[begin:end], marks - begin, table[2 * begin : 2 * end + 1])


def innovations(problem: Problem, added: Terms, process_noise: float) -> tuple[FloatArray, FloatArray]:
    """Innovations of all recordings and their variances, shape (readings,) each [m], [m²], at a density [m²/s³]."""
    model = Dynamics(problem, added)
    readings = sum(len(one.time) for one in problem.recordings)
    every = in_threads if readings >= _WORTH_THREADS else map
    each = every(lambda one: innovations_of(model, one, process_noise), problem.recordings)
    innovation, variance = zip(*each, strict=True)
    return np.concatenate(innovation), np.concatenate(variance)


def innovations_of(
    model: Dynamics, recording: PreparedRecording, process_noise: float
) -> tuple[FloatArray, FloatArray]:
    """As `innovations`, of one recording."""
    (run,) = run_parts(model, recording, process_noise, [Excerpt(slice(None), None)], shared=True)
    return run.innovation[recording.judged], run.innovation_variance[recording.judged]


def deviance(problem: Problem, added: Terms, process_noise: float) -> float:
    """Deviance of the innovations of all recordings, at a density of the process noise [m²/s³]."""
    return negative_two_log_likelihood(*innovations(problem, added, process_noise))


def deviance_of(
    problem: Problem,
    recording: PreparedRecording,
    added: Terms,
    process_noise: float,
    *,
    own: Own | None = None,
    reading: FloatArray | None = None,
) -> float:
    """Deviance of the innovations of one recording; arguments as for `run_filter`."""
    reading = recording.reading if reading is None else reading
    known = np.flatnonzero(np.isfinite(reading))
    part = slice(int(known[0]), int(known[-1]) + 1)  # nothing is predicted before or behind
    excerpt, model = Excerpt(part, reading[part]), Dynamics(problem, added)
    (run,) = run_parts(model, recording, process_noise, [excerpt], own=own, shared=True)
    use = filtered_against(reading[part])
    return negative_two_log_likelihood(run.innovation[use], run.innovation_variance[use])
