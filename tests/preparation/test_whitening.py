"""Innovations are generalised least squares by other means."""

from __future__ import annotations

import numpy as np

from harness.preparation.whitening import innovations

DENSITY = 3e-4


def wandering(time: np.ndarray, density: float) -> np.ndarray:
    """Covariance of the position of a ball that is pushed by white noise from rest at the first stamp, shape (n, n)."""
    early = np.minimum.outer(time, time) - time[0]
    late = np.maximum.outer(time, time) - time[0]
    return density * (early**2 * late / 2.0 - early**3 / 6.0)


def test_innovations_give_generalised_least_squares() -> None:
    """Weight errors by the inverse of their full covariance, with free initial state and blanks omitted."""
    draw = np.random.default_rng(0)
    time = np.cumsum(draw.uniform(0.01, 0.03, 80))
    variance = np.where(draw.random(80) < 0.1, np.inf, (1e-3 * draw.uniform(0.5, 2.0, 80)) ** 2)
    variance[:3] = 1e-6
    signals = np.column_stack((np.sin(3.0 * time), time**2, draw.standard_normal(80)))
    white, _ = innovations(time, signals, variance, DENSITY)

    use = np.isfinite(variance)
    covariance = (wandering(time, DENSITY) + np.diag(np.where(use, variance, 0.0)))[np.ix_(use, use)]
    weight = np.linalg.inv(covariance)
    line = np.column_stack((np.ones(use.sum()), time[use]))
    weight -= weight @ line @ np.linalg.solve(line.T @ weight @ line, line.T @ weight)  # a free start
    expected = signals[use].T @ weight @ signals[use]
    # The filter's start is not free but wide: 100 m against 1 mm, 1e-10 in variance, and two digits of rounding.
    np.testing.assert_allclose(white.T @ white, expected, rtol=1e-6)


def test_innovations_of_the_right_noise_are_white() -> None:
    """Whiten simulated random walk and noise to independent numbers of variance 1."""
    draw = np.random.default_rng(1)
    time = np.arange(400) * 0.01
    variance = np.full(400, 1e-6)
    root = np.linalg.cholesky(wandering(time[1:], DENSITY) + 1e-18 * np.eye(399))
    paths = np.vstack((np.zeros(50), root @ draw.standard_normal((399, 50))))
    white, _ = innovations(time, paths + 1e-3 * draw.standard_normal((400, 50)), variance, DENSITY)
    count = 398 * 50
    # The first two readings are spent on the start. 4 standard deviations of a mean square, √(2/count), and of a
    # correlation, 1/√count.
    assert np.all(white[:2] == 0.0)
    assert abs(np.sum(white**2) / count - 1.0) < 4.0 * np.sqrt(2.0 / count)
    assert abs(np.sum(white[2:-1] * white[3:]) / count) < 4.0 / np.sqrt(count)


def test_the_likelihood_peaks_at_the_true_density() -> None:
    """Find the density that the noise was made with."""
    draw = np.random.default_rng(2)
    time = np.arange(600) * 0.01
    root = np.linalg.cholesky(wandering(time[1:], DENSITY) + 1e-18 * np.eye(599))
    path = np.concatenate(([0.0], root @ draw.standard_normal(599))) + 1e-3 * draw.standard_normal(600)
    factors = np.exp(np.arange(-3.0, 3.01, 0.25))
    cost = []
    for factor in factors:
        white, logs = innovations(time, path[:, None], np.full(600, 1e-6), factor * DENSITY)
        cost.append(np.sum(white**2) + logs)
    # The velocity wanders by √(q t), 40 times in 6 s what the noise hides: some 40 numbers know log q to √(2/40) = 0.22
    # each; three of these.
    assert abs(np.log(factors[np.argmin(cost)])) < 0.75
