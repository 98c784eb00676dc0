"""Sprague and Geers' errors tell size from timing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.metrics.run_comparison import RunComparison, trapezoid_weights
from harness.metrics.time_history import sprague_geers

ROUNDING = 1e-12


@given(
    st.lists(st.tuples(st.floats(1e-3, 0.5), st.floats(-1.0, 1.0)), min_size=2, max_size=60),
    st.floats(0.1, 10.0),
)
def test_gain_is_magnitude_alone(pairs, gain):
    """Read a gain of 1 + M as M, with no phase, on any signal and any stamps."""
    time = np.cumsum([step for step, _ in pairs])
    measured = np.array([1.0, *(value for _, value in pairs[1:])])
    result = sprague_geers(measured, gain * measured, trapezoid_weights(time))
    assert result.magnitude == pytest.approx(gain - 1.0, abs=ROUNDING * (1 + gain))
    assert result.phase == pytest.approx(0.0, abs=ROUNDING)


@pytest.mark.parametrize("degrees", [0.01, 10.0, 90.0, 180.0])
def test_delay_of_a_sine_is_phase_alone(degrees):
    """Read a sine that is φ late as P = φ/π and M = 0."""
    # whole periods on an even grid: the trapezoidal rule is exact for the products of sines
    time = np.linspace(0.0, 6.0, 601)
    phi, omega = np.radians(degrees), np.pi
    result = sprague_geers(np.sin(omega * time), np.sin(omega * time - phi), trapezoid_weights(time))
    assert result.magnitude == pytest.approx(0.0, abs=ROUNDING)
    # near 180° the arcsine turns the rounding ε of its argument into √ε
    assert result.phase == pytest.approx(degrees / 180.0, abs=2e-8 if degrees == 180.0 else ROUNDING)
    assert result.combined == pytest.approx(result.phase, abs=ROUNDING)


def test_small_phase_is_not_lost():
    """Resolve a phase of 1e-10, which the arc cosine of a number near 1 would swallow."""
    time = np.linspace(0.0, 2.0, 401)
    phi = 1e-10 * np.pi
    late = np.sin(np.pi * time) - phi * np.cos(np.pi * time)  # sin(ωt − φ) to order φ²
    result = sprague_geers(np.sin(np.pi * time), late, trapezoid_weights(time))
    assert result.phase == pytest.approx(1e-10, rel=1e-5)  # the ordinates carry φ with ε/φ = 7e-7 each


@given(st.floats(-5.0, 5.0))
def test_zero_of_the_rig_does_not_matter(shift):
    """Give the same errors wherever the rig's zero lies: displacements count from the start."""
    time = np.linspace(0.0, 3.0, 301)
    measured, model = 0.3 + 0.1 * np.sin(time), 0.3 + 0.12 * np.sin(1.1 * time)

    def errors(offset: float):
        run = RunComparison(time=time, measured=measured + offset, model=model + offset)
        return sprague_geers(*run.displacement, trapezoid_weights(time))

    # positions near 5 m carry 5 ε ≈ 1e-15 m, on displacements of 0.1 m
    assert errors(shift) == pytest.approx(errors(0.0), abs=1e-12)


def test_estimated_start_replaces_a_noisy_one():
    """Read the gain rightly from a given start although the first sample is off."""
    time = np.linspace(0.0, 3.0, 301)
    motion = 0.05 * time**2
    measured = 0.3 + motion
    measured[0] += 0.02
    model = 0.3 + 1.1 * motion
    weights = trapezoid_weights(time)
    given_start = sprague_geers(
        *RunComparison(time=time, measured=measured, model=model, start=0.3).displacement, weights
    )
    first_sample = sprague_geers(*RunComparison(time=time, measured=measured, model=model).displacement, weights)
    # the one bad sample adds (0.02 m)² · 5 ms to ∫m² = 0.05² · 3⁵/5 m² s: 1.6e-5 of it, half of that of M
    assert given_start.magnitude == pytest.approx(0.1, abs=2e-5)
    assert abs(first_sample.magnitude - 0.1) > 1e-3


def test_rest_has_no_relative_error():
    """Leave the errors undefined when the ball rests, the phase when the model's does."""
    weights = trapezoid_weights(np.arange(5.0))
    assert all(np.isnan(value) for value in sprague_geers(np.zeros(5), np.ones(5), weights))
    stuck = sprague_geers(np.ones(5), np.zeros(5), weights)
    assert stuck.magnitude == -1.0
    assert np.isnan(stuck.phase)
    assert np.isnan(stuck.combined)
