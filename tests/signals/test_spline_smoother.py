from __future__ import annotations

import numpy as np
from mpmath import matrix as mp_matrix
from mpmath import mp, mpf

from analytic.motion import FloatArray
from harness.signals import draw, smooth
from harness.signals.spline_smoother import _DIFFUSE, kalman_smoother
from tests.signals.dense_posterior import KICK


def record(n: int = 14) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Uneven stamps, values, variances (two readings missing) and densities that differ by e⁶."""
    generator = np.random.default_rng(3)
    time = np.sort(generator.uniform(0.0, 1.0, n))
    variance = np.full(n, 0.05**2)
    variance[[4, 5]] = np.inf
    return time, np.sin(6.0 * time) + 0.05 * generator.standard_normal(n), variance, np.exp(np.linspace(2, 8, n - 1))


def dense(
    time: FloatArray, value: FloatArray, variance: FloatArray, density: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Mean, covariance blocks and log evidence from the joint Gaussian, solved with 60 digits."""
    mp.dps = 60
    n = len(time)

    def advance(h: mpf) -> mp_matrix:
        return mp_matrix([[1, h, h * h / 2], [0, 1, h], [0, 0, 1]])

    blocks = [mp.diag([mpf(v) for v in _DIFFUSE])]
    for k in range(n - 1):
        h = mpf(time[k + 1]) - mpf(time[k])
        Q = mp_matrix(3, 3)
        for i in range(3):
            for j in range(3):
                Q[i, j] = mpf(density[k]) * h ** (5 - i - j) * KICK[i][j]
        blocks.append(advance(h) * blocks[k] * advance(h).T + Q)
    prior = mp_matrix(3 * n, 3 * n)
    for i in range(n):
        for j in range(i, n):
            C = advance(mpf(time[j]) - mpf(time[i])) * blocks[i]
            for a in range(3):
                for b in range(3):
                    prior[3 * j + a, 3 * i + b] = prior[3 * i + b, 3 * j + a] = C[a, b]
    seen = [k for k in range(n) if np.isfinite(variance[k])]
    S, cross, y = mp_matrix(len(seen), len(seen)), mp_matrix(3 * n, len(seen)), mp_matrix(len(seen), 1)
    for a, k in enumerate(seen):
        y[a] = mpf(value[k])
        for b, other in enumerate(seen):
            S[a, b] = prior[3 * k, 3 * other] + (mpf(variance[k]) if a == b else 0)
        for i in range(3 * n):
            cross[i, a] = prior[i, 3 * k]
    inverse = S**-1
    mean, cover = cross * inverse * y, prior - cross * inverse * cross.T
    evidence = -(mp.log(mp.det(2 * mp.pi * S)) + (y.T * inverse * y)[0]) / 2
    covariance = [[[float(cover[3 * k + a, 3 * k + b]) for b in range(3)] for a in range(3)] for k in range(n)]
    return np.array(mean.tolist(), float).reshape(n, 3), np.array(covariance), float(evidence)


def test_smoother_is_the_gaussian_posterior():
    """Agree with a dense solve of the same Gaussian in 60 digits: mean, covariance and evidence."""
    mean, covariance, evidence = dense(*record())
    found = smooth(*record())
    deviation = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    # The diffuse start costs digits: prior variances up to 1e4 against posteriors down to 1e-4, in doubles of 1e-16,
    # leave about 1e-8; errors of a thousandth of a standard deviation would still harm nobody.
    assert np.all(np.abs(found.mean - mean) < 1e-5 * deviation)
    scale = deviation[:, :, None] * deviation[:, None, :]
    assert np.all(np.abs(found.covariance - covariance) < 1e-4 * scale)
    # Four-digit diffuse variances enter as logarithms only: the evidence keeps eleven digits of about 10.
    assert abs(found.log_evidence - evidence) < 1e-6


def test_energy_beyond_degrees_of_freedom_is_the_slope_of_the_evidence():
    """Satisfy Fisher's identity: d log evidence / d log density = ½ (energy − dof), step by step."""
    time, value, variance, density = record()
    value = np.where(np.isfinite(variance), value, 0.0)
    n = len(time)
    room = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(n - 1), np.empty(n - 1)
    kalman_smoother(time, value, variance, density, *room)
    slope = 0.5 * (room[2] - room[3])
    dof = room[3].copy()
    step = 1e-2
    for k in range(n - 1):
        up, down = density.copy(), density.copy()
        up[k], down[k] = density[k] * np.exp(step), density[k] * np.exp(-step)
        rise = kalman_smoother(time, value, variance, up, *room) - kalman_smoother(time, value, variance, down, *room)
        # Central differences err by step²/6 of a third derivative of order 1; the evidence's rounding adds 1e-8/step.
        assert abs(rise / (2 * step) - slope[k]) < 3e-5
    assert np.all((dof > -1e-9) & (dof < 3.0))


def test_draws_have_the_posterior_mean_and_covariance():
    """Draw signals whose moments at every stamp are those of the posterior."""
    time, value, variance, density = record()
    posterior = smooth(time, value, variance, density)
    count = 4000
    paths = draw(posterior, variance, count, np.random.default_rng(0))
    deviation = np.sqrt(np.diagonal(posterior.covariance, axis1=1, axis2=2))
    # 42 means and 126 second moments of `count` draws: 4.5 standard errors leave a chance of 1e-3 that any is beyond.
    assert np.all(np.abs(paths.mean(axis=0) - posterior.mean) < 4.5 * deviation / np.sqrt(count))
    off = (paths - posterior.mean) / deviation
    correlation = np.einsum("cki,ckj->kij", off, off) / count
    expected = posterior.covariance / (deviation[:, :, None] * deviation[:, None, :])
    assert np.all(np.abs(correlation - expected) < 4.5 * np.sqrt((1.0 + expected**2) / count))


def test_missing_reading_is_as_if_never_taken():
    """Give the same states elsewhere whether a stamp without a reading is in the record or not."""
    time, value, variance, _ = record()
    seen = np.isfinite(variance)
    value[~seen] = np.nan
    whole, part = smooth(time, value, variance, 100.0), smooth(time[seen], value[seen], variance[seen], 100.0)
    deviation = np.sqrt(np.diagonal(part.covariance, axis1=1, axis2=2))
    # The same numbers by another path of rounding: see the digits of the dense comparison.
    assert np.all(np.abs(whole.mean[seen] - part.mean) < 1e-5 * deviation)
    assert np.isclose(whole.log_evidence, part.log_evidence, atol=1e-6)


def test_parabola_is_reproduced_at_any_stiffness():
    """Leave a parabola as it is: its third derivative is zero, so no stiffness bends it."""
    time = np.linspace(0.0, 5.0, 300)
    truth = np.column_stack((0.3 - 0.2 * time + 0.05 * time**2, -0.2 + 0.1 * time, np.full_like(time, 0.1)))
    for density in (1e-6, 1.0, 1e6):
        found = smooth(time, truth[:, 0], 1e-6, density)
        # The diffuse prior pulls by (posterior/prior variance) < 1e-6 of the values; α̈ at 1e6 has variance of order
        # 1e3 against a prior of 1e4 and only knows its own error bar.
        deviation = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
        assert np.all(np.abs(found.mean - truth) < 1e-6 + 1e-2 * deviation)


def test_covariance_stays_positive_at_any_stiffness():
    """Keep every covariance positive from a diffuse start, with variances over thirty decades."""
    time, value = np.arange(0.0, 4.0, 0.01), np.cos(np.arange(0.0, 4.0, 0.01))
    for density in (1e-9, 1e-3, 1e3, 1e8):
        assert np.linalg.eigvalsh(smooth(time, value, 1e-7, density).covariance).min() > 0.0
