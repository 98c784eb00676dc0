"""Spans predicted from all readings before them: as by a filter of its own over each, in time that grows linearly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.forecast import filtered, filtered_ahead
from harness.identify.filter import run
from harness.identify.filter.arguments import FilterOutput
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Colour, PreparedRecording, Problem
from harness.identify.problem.windows import predicted_spans
from harness.identify.validation.held_out import errors
from harness.recording import load_case
from harness.simulator import Experiment, write_case

PROCESS_NOISE = 1e-6
# Of both forms of the filter: the usual state, dry friction at points, Dahl friction, slip, a lag, moved beams.
EFFECTS = [
    (),
    ("viscous_damping",),
    ("rolling_resistance",),
    ("presliding_hysteresis",),
    ("contact_slip",),
    ("position_lag", "angle_lag"),
    ("channel_delay",),
]


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Two recordings of 8 s, one of which lacks its first readings and some where spans begin."""
    path: Path = tmp_path_factory.mktemp("ahead") / "case"
    write_case(path, Experiment(duration=8.0, identify=2, predict=0, seed=11))
    made = problem_of(load_case(path))
    first, second = made.recordings
    gaps = second.reading.copy()
    gaps[:30] = np.nan
    gaps[(second.time > 2.9) & (second.time < 3.1)] = np.nan
    return replace(made, recordings=(first, replace(second, reading=gaps)))


def spans_of(recording: PreparedRecording) -> list[slice]:
    """Stamps of all its predicted spans."""
    return [use for _, use in predicted_spans(recording.time - recording.time[0], np.isfinite(recording.reading))]


@pytest.mark.parametrize("names", EFFECTS, ids="+".join)
@pytest.mark.parametrize("colour", [Colour(), Colour(0.4, 0.03)], ids=["white", "coloured"])
def test_spans_are_those_of_a_filter_that_is_given_the_readings_before_them(
    problem: Problem, names: tuple[str, ...], colour: Colour
) -> None:
    """Predict every span to the bit as a filter over the whole recording does that lacks all readings from there on."""
    problem, hypothesis = replace(problem, colour=colour), Hypothesis(names)
    terms = hypothesis.terms(np.ones(hypothesis.size(problem)), problem)
    for recording in problem.recordings:
        spans = spans_of(recording)
        assert len(spans) > 10
        whole, ahead = run.run_ahead(problem, recording, terms, PROCESS_NOISE, spans)
        at_once = run.run_filter(problem, recording, terms, PROCESS_NOISE)
        np.testing.assert_array_equal(whole.innovation, at_once.innovation)
        np.testing.assert_array_equal(whole.state, at_once.state)
        for use, one in zip(spans, ahead, strict=True):
            before = np.where(np.arange(len(recording.time)) < use.start, recording.reading, np.nan)
            alone = run.run_filter(problem, recording, terms, PROCESS_NOISE, reading=before)
            np.testing.assert_array_equal(one.recorded, alone.recorded[use])
            np.testing.assert_array_equal(one.recorded_variance, alone.recorded_variance[use])


def test_a_recording_that_was_not_fitted_gives_its_own_values_by_the_readings_before_a_span(problem: Problem) -> None:
    """Predict each span of a held-out recording with the level that the readings before it tell, not those after."""
    first, second = problem.recordings
    rest = replace(problem, recordings=(first, replace(first, name="again")))
    found = fit(rest, Hypothesis(("level_per_recording",)), rounds=1)
    spans = spans_of(second)[::4]
    _, ahead = filtered_ahead(rest, found, second, spans)
    for use, one in zip(spans, ahead, strict=True):
        before = np.where(np.arange(len(second.time)) < use.start, second.reading, np.nan)
        np.testing.assert_array_equal(one.recorded, filtered(rest, found, second, before).recorded[use])


def test_work_of_prediction_errors_grows_with_the_length_of_a_recording(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Filter each stamp of a recording once, and once more for each horizon, however long the recording is.

    The horizons are 1, 2, 3 and 5 s and the rest of the recording: six stamps are filtered for each one at most.
    """
    recording = problem.recordings[0]
    found = fit(problem, Hypothesis(()))
    for stamps in (len(recording.time) // 2, len(recording.time)):
        part = replace(recording, time=recording.time[:stamps], reading=recording.reading[:stamps])
        assert stamps < filtered_stamps(problem, found, part, monkeypatch) <= 6 * stamps


def filtered_stamps(problem: Problem, found: Fit, recording: PreparedRecording, monkeypatch: pytest.MonkeyPatch) -> int:
    """Number of stamps over which the filter runs for the errors of one recording."""
    counted: list[int] = []
    original: Callable[..., FilterOutput] = run.extended_kalman_filter

    def counting(*arguments: object, **options: object) -> FilterOutput:
        out = original(*arguments, **options)
        counted.append(len(out.innovation))
        return out

    with monkeypatch.context() as patch:
        patch.setattr(run, "extended_kalman_filter", counting)
        errors(problem, found, (recording,))
    return sum(counted)
