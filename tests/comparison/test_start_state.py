"""Every source starts from one estimate of the ball's state, and that estimate covers the truth."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from analytic.models import CAM, coefficients
from analytic.motion import State
from analytic.slots import ECCENTRIC
from harness.comparison import Setting
from harness.comparison.horizons import Horizon
from harness.comparison.sources import run_models
from tests.comparison.made import Made


def squared_distances(made: Made, setting: Setting, horizon: Horizon) -> list[float]:
    """Mahalanobis distance² of the estimated from the true state at the start of every run; 2 on average if right."""
    first = horizon.first
    error = setting.starts(horizon) - made.ball(setting.time[first])
    covariance = setting.ball.covariance[first][:, :2, :2].copy()
    # The velocity is measured relative to CAM's, which holds −K ℓ α̇ of the beam as it was read.
    jolt = coefficients(CAM, setting.rig)[ECCENTRIC]
    covariance[:, 1, 1] += (jolt * setting.drive.std[first, 1]) ** 2
    return np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error).tolist()


def test_start_of_the_whole_run_covers_the_truth(perfect: list[tuple[Made, Setting]]) -> None:
    """Find the first state within its stated uncertainty."""
    distances = [d for made, setting in perfect for d in squared_distances(made, setting, setting.horizons[0])]
    # χ² with 2 degrees of freedom a recording; one in a thousand lies outside either bound if error bars are right.
    low, high = chi2.ppf((0.001, 0.999), 2 * len(perfect))
    assert low < sum(distances) < high


def test_starts_of_windows_cover_the_truth(perfect: list[tuple[Made, Setting]]) -> None:
    """Find the state of a moving ball within its stated uncertainty, on average over all windows."""
    distances = []
    for made, setting in perfect:
        distances += squared_distances(made, setting, setting.horizons[1])
    # Some 60 windows: chance moves the root mean square by 1/√120 = 9 %. What the bound allows beyond is the beam's
    # rate at a servo's corners, which a coarse encoder sees a count too late: its error bars are up to half too short
    # there, and that reaches the ball's velocity through K ℓ.
    assert 0.6 < np.sqrt(np.mean(distances) / 2.0) < 2.0


def test_every_source_starts_alike(bundled: Setting) -> None:
    """Start every model's run at the estimated state."""
    for horizon in bundled.horizons:
        for run in run_models(bundled, [CAM], horizon):
            starts = np.array([[piece[0] for piece in horizon.pieces(one)] for one in (run.position, run.velocity)]).T
            np.testing.assert_array_equal(starts, bundled.starts(horizon))


def test_a_given_start_holds_for_the_whole_run_only(perfect: list[tuple[Made, Setting]]) -> None:
    """Use a start given by the user for the free run only, and the estimated state for windows."""
    made, estimated = perfect[0]
    setting = made.prepare(start=State(0.4, 0.01))
    assert setting.starts(setting.horizons[0]).tolist() == [[0.4, 0.01]]
    assert setting.start == State(0.4, 0.01)
    np.testing.assert_array_equal(setting.starts(setting.horizons[1]), estimated.starts(estimated.horizons[1]))
