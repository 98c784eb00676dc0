"""What a rival loses on a recording without noise: steady filters in closed form against the filter itself."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.design.closed_loop import simulate_closed_loop
from harness.identify.design.discrimination import SteadyFilters, open_loop_drift, rival_deviance
from harness.identify.design.excitation import LIBRARY, envelope_of
from harness.identify.filter.ekf import negative_two_log_likelihood
from harness.identify.filter.run import run_filter
from harness.identify.problem.hypothesis import NOTHING, Own
from tests.identify.short_rig import GAIN, RADIUS, Short, short


@pytest.fixture(scope="module")
def radius(tmp_path_factory: pytest.TempPathFactory) -> Short:
    """A rolling radius that a gain of the position sensor imitates to the last on 5 s of data."""
    return short(tmp_path_factory.mktemp("radius"), {RADIUS: {"radius": 0.0112}}, GAIN)


def test_innovations_follow_from_those_at_another_density(radius: Short) -> None:
    """Get, by the steady linear filter, what the filter itself gives of a rival at another process noise.

    Linear filtering is exact but for the first second, before gains are steady, and for what depends on position and
    angle in the tilt, sin α ≈ α and s α̇²: 1e-3 of it. Dry friction, which holds the ball at turning points, is left out
    here; a gain of the sensor scales the process noise that the readings see.
    """
    frictionless = replace(radius.problem, declared=())
    envelope = envelope_of(frictionless)
    (profile,) = (one for one in LIBRARY if one.name == "quick ramps")
    made = simulate_closed_loop(frictionless, radius.found.terms, radius.found.process_noise, profile, envelope)
    assert made is not None
    steady_filters = SteadyFilters.of(envelope.interval, frictionless.reading_variance, 1e-6)
    best = radius.rival.terms
    gain = frictionless.sensor(best.effects).gain

    def innovations(process_noise: float) -> FloatArray:
        found = run_filter(frictionless, made.recording, best, process_noise / gain**2, own=Own(), reading=made.reading)
        return found.innovation[1:]

    later = slice(round(2.0 / envelope.interval), None)
    for number in (1, 3):
        direct = innovations(float(steady_filters.process_noise[number]))
        by_filter = steady_filters.filtered(innovations(1e-4)[:, None])[number, :, 0]
        difference = np.sqrt(np.mean((direct - by_filter)[later] ** 2) / np.mean(direct[later] ** 2))
        assert difference < 1e-3, number


def test_a_wrong_process_noise_costs_what_is_claimed(radius: Short) -> None:
    """Charge a density that is too large with what it adds to the deviance of simulated noise."""
    problem, true = radius.problem, 1e-8
    envelope = envelope_of(problem)
    (profile,) = (one for one in LIBRARY if one.name == "slow swing")
    values = replace(radius.found.terms, effects=())
    frictionless = replace(problem, declared=())
    made = simulate_closed_loop(frictionless, values, true, profile, envelope)
    assert made is not None
    steady_filters = SteadyFilters.of(envelope.interval, problem.reading_variance, true)
    generator = np.random.default_rng(0)
    number, costs = 4, []
    for _ in range(40):
        kicks = math.sqrt(true * envelope.interval) * generator.standard_normal(len(made.reading))
        path = np.cumsum(np.cumsum(kicks)) * envelope.interval
        noisy = made.reading + path + math.sqrt(problem.reading_variance) * generator.standard_normal(len(path))
        noisy[0] = made.reading[0]
        deviances = []
        for process_noise in (float(steady_filters.process_noise[0]), float(steady_filters.process_noise[number])):
            out = run_filter(frictionless, made.recording, NOTHING, process_noise, reading=noisy)
            later = slice(round(4.0 / envelope.interval), None)  # steady by then
            deviances.append(negative_two_log_likelihood(out.innovation[later], out.innovation_variance[later]))
        costs.append((deviances[1] - deviances[0]) / len(made.recording.time[later]))
    error = np.std(costs) / math.sqrt(len(costs))
    assert steady_filters.cost[number] > 10.0 * error  # else the comparison would say nothing
    assert abs(np.mean(costs) - steady_filters.cost[number]) < 3.0 * error


def test_a_model_is_not_apart_from_itself(radius: Short) -> None:
    """Regain nothing where the rival is what the recording was made with."""
    envelope = envelope_of(radius.problem)
    made = simulate_closed_loop(radius.problem, radius.found.terms, radius.found.process_noise, LIBRARY[0], envelope)
    assert made is not None
    steady_filters = SteadyFilters.of(envelope.interval, radius.problem.reading_variance, radius.found.process_noise)
    assert rival_deviance(radius.problem, made, radius.found, steady_filters) == pytest.approx(0.0, abs=1e-6)
    assert open_loop_drift(radius.problem, radius.found, made) > 0.0
