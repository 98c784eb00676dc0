"""Free runs over windows: those of the kernel, with their derivatives by the start."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.effects import acting, parameters_with
from analytic.kernel import Grid, integrate_windows
from analytic.models import CAM
from analytic.motion import SplineMotion
from analytic.rig import Rig
from harness.identify.filter.arguments import BeamTable
from harness.identify.filter.free_run import free_runs, start_derivatives

TIME = np.linspace(0.0, 10.0, 501)
GRID = Grid.over(TIME, 5e-3)
MOTION = SplineMotion(CubicSpline(TIME, 0.03 * np.sin(1.7 * TIME)))
BEAM = BeamTable(GRID.steps, GRID.marks, GRID.tabulate(MOTION))
FIRST, LAST = np.array([0, 150]), np.array([251, 401])
STARTS = np.array([[0.05, 0.1], [-0.02, -0.05]])


def test_free_runs_are_those_of_the_kernel() -> None:
    """Begin each window at its own start and go on as `integrate` does."""
    p = parameters_with(CAM, Rig(), [acting("rolling_resistance", {"coefficient": 0.002})])
    run = free_runs(FIRST, LAST, BEAM, p, 0.0, STARTS)
    other, _ = integrate_windows(GRID, BEAM.table, p, STARTS, FIRST, LAST - 1)
    # How operations are grouped may differ between two compiled functions: of 1000 steps each moves s and ṡ, below
    # 1 m and 1 m/s, by some roundings, and that of ṡ acts for 5 s.
    rounding = 1000.0 * 4.0 * np.finfo(float).eps * 5.0
    np.testing.assert_allclose(run[:251], other[:251], rtol=0.0, atol=rounding)
    np.testing.assert_allclose(run[251:], other[251:], rtol=0.0, atol=rounding)


def test_a_lagging_sensor_follows_from_a_motion_at_the_first_velocity() -> None:
    """Show T ẏ + y = s: T ṡ behind at the start, and late by about T."""
    p = parameters_with(CAM, Rig(), [])
    plain, late = (free_runs(FIRST, LAST, BEAM, p, lag, STARTS) for lag in (0.0, 0.05))
    assert late[0] == plain[0] - 0.05 * 0.1
    slope = np.gradient(late[:251], TIME[:251])
    # Differences over 40 ms err by a sixth of the third derivative times 0.02²: below 1 m/s³ in the motion, and at the
    # start 0.1 m/s · e^(−t/T)/T² as the lag sets in, below 1 m/s³ after 7.5 T.
    settled = TIME[:251] > 0.375
    error = (late[:251] + 0.05 * slope - plain[:251])[settled][:-2]
    np.testing.assert_allclose(error, 0.0, atol=0.05 * 2.0 * 0.02**2 / 6.0)


def test_derivatives_by_the_start_are_those_of_a_moved_start() -> None:
    """On a beam of small angles a start moves the run by itself: δs and δṡ t, but for the centrifugal term."""
    p = parameters_with(CAM, Rig(), [])
    here = free_runs(FIRST, LAST, BEAM, p, 0.0, STARTS)
    slopes = start_derivatives(FIRST, LAST, BEAM, p, 0.0, STARTS, here)
    # s α̇² K adds at most 0.051² · 0.71 = 0.0018 1/s² of δs: 0.0018 · 5²/2 = 2.3 % after 5 s
    np.testing.assert_allclose(slopes[:251, 0], 1.0, atol=0.025)
    np.testing.assert_allclose(slopes[:251, 1], TIME[:251], atol=0.025 * 5.0)
    assert slopes[251, 1] == pytest.approx(0.0)
