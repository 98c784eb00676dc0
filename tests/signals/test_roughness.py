from __future__ import annotations

import math

import numpy as np

from harness.signals import smooth, smooth_rounded
from harness.signals.roughness import KNOT_SPACING, WALK_STD, Stiffness, scoring_step
from harness.signals.spline_smoother import kalman_smoother
from tests.signals.known_angles import encoder, servo_angle


def scored(time, value, variance, stiffness, passes=60):
    """Density after some scoring steps."""
    n = len(time)
    room = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(n - 1), np.empty(n - 1)
    for _ in range(passes):
        density = np.exp(stiffness.log_density)[stiffness.knot]
        kalman_smoother(time, value, np.full(n, variance), density, *room)
        stride = scoring_step(
            stiffness.knot, stiffness.coupling, stiffness.lowest, room[2], room[3], stiffness.log_density
        )
        if stride < 1e-6:
            break
    return stiffness.log_density


def test_one_knot_climbs_to_the_greatest_evidence():
    """Reach by scoring the density that a direct search of the evidence finds."""
    time = np.arange(0.0, 8.0, 0.02)
    value = np.sin(3.0 * time) + 0.01 * np.random.default_rng(0).standard_normal(len(time))
    log_density = scored(time, value, 1e-4, Stiffness.constant(time))
    # The search stops within 0.05 of the log density.
    assert abs(log_density[0] - math.log(smooth(time, value, 1e-4).density[0])) < 0.06


def test_scoring_step_solves_the_coupled_knots():
    """Make the step that a dense solve of gradient and information makes, walk included."""
    generator = np.random.default_rng(1)
    time = np.cumsum(generator.uniform(0.01, 0.2, 60))
    stiffness = Stiffness.over(time)
    m = len(stiffness.log_density)
    energy, dof = generator.uniform(0.0, 1.0, 59), generator.uniform(0.5, 1.0, 59)
    gradient, information = np.zeros(m), np.full(m, 1e-3)
    np.add.at(gradient, stiffness.knot, 0.5 * (energy - dof))
    np.add.at(information, stiffness.knot, 0.5 * dof)
    walk = np.zeros((m, m))
    for j, c in enumerate(stiffness.coupling):
        walk[j : j + 2, j : j + 2] += c * np.array([[1.0, -1.0], [-1.0, 1.0]])
    before = stiffness.log_density + 0.1 * generator.standard_normal(m)
    after = before.copy()
    scoring_step(stiffness.knot, stiffness.coupling, stiffness.lowest, energy, dof, after)
    expected = np.linalg.solve(np.diag(information) + walk, gradient - walk @ before)
    assert np.allclose(after - before, np.clip(expected, -1.0, 1.0), atol=1e-12)


def test_knots_follow_time_and_not_the_number_of_readings():
    """Couple neighbouring knots by the time between them, over a gap in the record too."""
    time = np.concatenate((np.arange(0.0, 1.0, 0.01), np.arange(3.0, 4.0, 0.001)))
    stiffness = Stiffness.over(time)
    assert len(stiffness.knot) == len(time) - 1
    variance = 1.0 / (WALK_STD**2 * stiffness.coupling)
    assert np.allclose(variance[:5], KNOT_SPACING)
    assert np.isclose(variance.max(), 3.0 - stiffness.knot[98] * KNOT_SPACING, atol=KNOT_SPACING)


def test_a_rest_is_stiffer_than_a_move():
    """Learn a density at least a thousand times lower at rest than in motion."""
    time = np.arange(0.0, 16.0, 0.01)
    states = servo_angle(1).states(time)
    reading, step = encoder(states[:, 0], 12800)
    log_density = np.log(smooth_rounded(time, reading, step)[0].density)
    rests = (np.abs(states[:-1, 1]) < 1e-9) & (np.abs(states[1:, 1]) < 1e-9)
    moves = np.abs(states[:-1, 2]) > 1.0
    assert rests.sum() > 50
    assert moves.sum() > 50
    # Within a rest of t = 0.5 s the value stays within the count: √(d t⁵/20) < q means d < 1e-4; a move of 2° within
    # 0.3 s has a third derivative of 60 · 0.035/0.3³ = 80 rad/s³ for 0.1 s, that is d = 80² · 0.1 = 600.
    assert np.median(log_density[moves]) - np.median(log_density[rests]) > math.log(1000.0)
