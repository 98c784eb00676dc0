"""Motion under a prescribed acceleration."""

from __future__ import annotations

import numpy as np

from analytic.kernel import Grid, integrate
from analytic.models import CAM, coefficients
from analytic.rig import Rig
from analytic.slots import CENTRIFUGAL
from harness.signals.prescribed import integrate_twice
from tests.motions import Sines

UNEVEN = np.cumsum(np.random.default_rng(1).uniform(0.004, 0.03, 400))


def test_nodes_are_where_the_kernel_tabulates() -> None:
    """Give the times of a table's rows, on uneven stamps too."""
    grid, motion = Grid.over(UNEVEN), Sines()
    # 1e-12 s of rounding in a sum of some thousand steps, at a rate of 0.13 rad/s.
    np.testing.assert_allclose(grid.tabulate(motion)[:, 0], motion.evaluate(grid.edges), atol=1e-12)


def test_cubic_motion_is_exact() -> None:
    """Integrate an acceleration that is linear in time without error."""
    grid = Grid.over(UNEVEN)
    position, velocity = integrate_twice(grid, 0.3 + 0.2 * (grid.edges - UNEVEN[0]))
    t = UNEVEN - UNEVEN[0]
    # Simpson's rule is exact here; 1e-13 relative is rounding over some thousand steps.
    np.testing.assert_allclose(velocity, 0.3 * t + 0.1 * t**2, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(position, 0.15 * t**2 + t**3 / 30.0, rtol=1e-12, atol=1e-14)


def test_the_kernel_agrees_where_nothing_depends_on_the_ball() -> None:
    """Match CAM without s α̇², whose acceleration is a function of time alone."""
    grid, motion = Grid.over(UNEVEN), Sines()
    p = coefficients(CAM, Rig())
    p[CENTRIFUGAL] = 0.0
    table = grid.tabulate(motion)
    run = integrate(grid, table, p, np.array([[0.0, 0.0]]))
    pull = Rig().rolling_ratio * (Rig().gravity * np.sin(table[:, 0]) - Rig().lever * table[:, 2])
    position, velocity = integrate_twice(grid, pull)
    # For an acceleration of time alone the classical Runge–Kutta method is Simpson's rule: only rounding differs.
    np.testing.assert_allclose(position, run.position[0], atol=1e-12)
    np.testing.assert_allclose(velocity, run.velocity[0], atol=1e-12)
