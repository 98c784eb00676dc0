"""A beam that shakes unrecorded looks like one that bends, and is said to."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.effects import BEAM_COMPLIANCE, LEVEL_ERROR, TRACK_CURVATURE
from analytic.kernel import simulate
from analytic.models import CAM
from analytic.motion import State
from analytic.rig import Rig
from harness.identify.estimate.fit import fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.shaken_beam import may_be_shaking
from harness.recording import load_case
from tests.motions import Sines

RATE, COUNT, NOISE = 50.0, 800, 1e-4  # [Hz], readings, [m]
SHAKEN = 0.3  # RMS of the rate that no reading shows [rad/s]
FAST = 2.0 * math.pi * RATE  # zero at each reading [rad/s]
WIDTH = math.sqrt(2.0) * SHAKEN / FAST  # [rad]
RIG = Rig()


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A ball on a beam that shakes by a milliradian, once from reading to reading, beside a slow motion."""
    folder = tmp_path_factory.mktemp("shaken")
    slow = ((0.09, 4.0, 0.3), (0.05, 7.0, 0.0))
    time = np.arange(COUNT) / RATE
    fine = np.arange(40 * (COUNT - 1) + 1) / (40 * RATE)
    path = simulate([CAM], RIG, Sines((*slow, (WIDTH, FAST, 0.0))), State(0.05, 0.0), fine)[0].position[::40]
    noise = np.random.default_rng(1).normal(0.0, NOISE, COUNT)
    rows = np.column_stack((time, Sines(slow).evaluate(time), path + noise))
    header = "time_s,beam_angle_rad,ball_position_m"
    np.savetxt(folder / "rec_01.csv", rows, "%.9g", ",", header=header, comments="")
    (folder / "rig.toml").write_text(
        f"[ball]\nmass_kg = {RIG.mass}\ninertia_kg_m2 = {RIG.inertia}\nradius_m = {RIG.radius}\n"
        f"[beam]\nrolling_radius_m = {RIG.rolling_radius}\neccentricity_m = {RIG.eccentricity}\n"
        f"[environment]\ngravity_m_s2 = {RIG.gravity}\n"
    )
    return problem_of(load_case(folder))


def test_it_pushes_the_ball_as_a_beam_that_bends(shaken: Problem) -> None:
    """Find a compliance of σ²/(m g²), which is not there, to a tenth."""
    found = fit(shaken, Hypothesis((BEAM_COMPLIANCE.name, LEVEL_ERROR.name)))
    compliance = found.values()[BEAM_COMPLIANCE.name, "compliance"]
    assert compliance == pytest.approx(SHAKEN**2 / (RIG.mass * RIG.gravity**2), rel=0.1)
    assert may_be_shaking(shaken, BEAM_COMPLIANCE.name, {"compliance": compliance})


def test_only_an_outward_tilt_within_the_recorded_rates_is_called_so(shaken: Problem) -> None:
    """Draw the line at the mean square of the recorded rates over g, outward only, and at no other effect."""
    square = float(np.mean(shaken.recordings[0].drive.states[:, 1] ** 2))
    most = square / RIG.gravity
    for factor, called in ((0.9, True), (1.1, False), (-0.5, False)):
        bent = {"compliance": factor * most / (RIG.mass * RIG.gravity)}
        assert may_be_shaking(shaken, BEAM_COMPLIANCE.name, bent) is called
        assert may_be_shaking(shaken, TRACK_CURVATURE.name, {"curvature": -factor * most, "centre": 0.1}) is called
    assert not may_be_shaking(shaken, LEVEL_ERROR.name, {"angle": 1e-6})
