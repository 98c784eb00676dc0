"""CAM differs from CUM in two things, the α̈ term and the radius in the inertia; each is worth what it is worth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.kernel import simulate
from analytic.models import CAM, CUM, Model
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from tests.motions import Fixed, Sines

RIG = Rig()
TIME = np.linspace(0.0, 3.6, 361)
# The ball goes out by about 0.25 m and comes back: the paper's travel.
MOTION = Sines(((math.radians(3.0), 2.0 * math.pi / 3.6, 0.5 * math.pi),))

ECCENTRIC = CUM.variant("cum_eccentric", eccentric=True)
ROLLING = CUM.variant("cum_rolling_radius", inertia_radius="r")


def positions(model: Model, motion: BeamMotion = MOTION) -> FloatArray:
    """s of a ball released at rest at 0.36 m [m]."""
    (run,) = simulate([model], RIG, motion, State(0.36, 0.0), TIME)
    return run.position


def test_both_steps_together_lead_from_cum_to_cam() -> None:
    """Turn CUM into CAM by the α̈ term and the radius, and by nothing else."""
    both = ECCENTRIC.variant("cam", inertia_radius="r", equation=CAM.equation)
    assert both == CAM
    np.testing.assert_array_equal(positions(both), positions(CAM))


def test_eccentric_term_is_worth_35_mm_per_radian() -> None:
    """Shift the ball by −(h + r + J/(m r))/(1 + J/(m r²)) α, that is 35 mm per radian or 2 mm at 3°."""
    worth = RIG.lever * RIG.rolling_ratio
    assert worth == pytest.approx(0.035, abs=5e-4)
    assert worth * math.radians(3.0) == pytest.approx(2e-3, abs=5e-4)
    # without s α̇² the equation is linear in the shift: α̈ integrates twice to α − α(0) − α̇(0) t
    shift = positions(CAM.variant("a", centrifugal=False)) - positions(
        CAM.variant("b", centrifugal=False, eccentric=False)
    )
    angle, rate = MOTION.evaluate(TIME), MOTION.derivative(TIME[:1])[0]
    # Simpson's rule on sin ω t over 2.5 ms: (ω h)⁴/2880 = 2.6e-13 of the shift; rounding of s: 1200 steps of 1e-16 m
    np.testing.assert_allclose(shift, -worth * (angle - angle[0] - rate * TIME), rtol=0.0, atol=1e-12)


def test_radius_is_worth_seven_per_cent_of_the_travel() -> None:
    """Make the ball travel 7 % further with R in the inertia than with r, on a slope and on a moving beam."""
    ratio = (1.0 + RIG.inertia_ratio) / (1.0 + RIG.inertia / (RIG.mass * RIG.radius**2))
    assert ratio == pytest.approx(1.07, abs=5e-3)
    for motion in (Fixed(0.02), MOTION):
        travel, longer = (
            positions(model.variant(model.name, centrifugal=False), motion)[1:] - 0.36 for model in (ROLLING, CUM)
        )
        np.testing.assert_allclose(longer, ratio * travel, rtol=0.0, atol=1e-12)


def test_an_ablation_has_to_separate_the_two() -> None:
    """Show on the paper's travel that CAM − CUM is mostly the radius, although only the α̈ term is "eccentric"."""
    cum, cam = positions(CUM), positions(CAM)
    travel = np.ptp(cum)
    assert 0.2 < travel < 0.3
    radius, eccentric = positions(ROLLING) - cum, positions(ECCENTRIC) - cum
    # 7 % of the travel, and 35 mm times 6° of beam angle: k_R instead of k_r and s α̇² change either by less than 10 %
    assert np.max(np.abs(radius)) == pytest.approx(0.0718 / 1.0718 * travel, rel=0.1)
    assert np.max(np.abs(eccentric)) == pytest.approx(RIG.lever * RIG.rolling_ratio * math.radians(6.0), rel=0.1)
    assert np.max(np.abs(radius)) > 3.0 * np.max(np.abs(eccentric))
    # to first order they add up; what is left is 7 % of the smaller one
    assert np.max(np.abs(cam - cum - radius - eccentric)) < 0.08 * np.max(np.abs(eccentric))
