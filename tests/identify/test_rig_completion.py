"""A rig is completed to roll with the estimated K, and the engines can run it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.kernel import simulate
from analytic.models import CAM
from analytic.motion import State
from analytic.rig import Rig
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of
from harness.identify.rig_completion import complete_rig, contradicted, missing, rig_of_ratio, rough_rig
from harness.recording import KnownRig, load_case
from tests.motions import Sines

CASES = [
    pytest.param(KnownRig(gravity=9.81), 0.6, "rolling radius r", id="nothing known: a groove"),
    pytest.param(KnownRig(gravity=9.81, radius=0.01, mass=0.03), 0.4, "rolling radius r", id="deep groove"),
    pytest.param(KnownRig(gravity=9.81, rolling_radius=0.009), 0.6, "inertia J", id="groove known: inertia"),
    pytest.param(KnownRig(gravity=9.81), 0.95, "inertia J", id="no groove rolls so fast"),
    pytest.param(KnownRig(gravity=9.81), 0.12, "inertia J", id="no groove rolls so slowly"),
    pytest.param(KnownRig(inertia=1e-6, rolling_radius=0.009), 0.6, "mass m", id="only the mass is open"),
    pytest.param(KnownRig(inertia=1e-6, mass=0.05, radius=0.01), 0.85, "inertia J", id="declared inertia cannot be"),
    pytest.param(KnownRig(gravity=9.81), 1.2, "gravity g", id="no rolling body accelerates so"),
    pytest.param(KnownRig(mass=0.05, radius=0.01), 1.0, "gravity g", id="a sliding one"),
]


@pytest.mark.parametrize(("known", "ratio", "chosen"), CASES)
def test_completed_rig_accelerates_with_the_estimated_ratio(known: KnownRig, ratio: float, chosen: str) -> None:
    """Reproduce K g exactly by the free quantity, and keep the known ones."""
    rough = rough_rig(known)
    rig, note = rig_of_ratio(known, rough, ratio)
    assert rig.rolling_ratio * rig.gravity == pytest.approx(ratio * rough.gravity, rel=1e-12)
    assert note.name == chosen
    assert note.std == np.inf
    touched = {"rolling radius r": "rolling_radius", "inertia J": "inertia", "mass m": "mass", "gravity g": "gravity"}
    for name in ("mass", "inertia", "radius", "rolling_radius", "gravity"):
        value = getattr(known, name)
        if value is not None and name != touched[chosen]:
            assert getattr(rig, name) == value


def test_a_given_value_that_no_ball_rolls_with_is_told() -> None:
    """Say which value stands for the given one, what was to be expected, and what may be wrong; else nothing."""
    ball = KnownRig(gravity=9.81, mass=0.0028, radius=0.02, inertia=2.0 / 3.0 * 0.0028 * 0.02**2)
    slow = contradicted(ball, rig_of_ratio(ball, rough_rig(ball), 0.086)[0])
    assert slow is not None
    assert slow.code == "rig-contradicted"
    # K = 1/(1 + J/(m r²)) with J = 2/3 m R²: 1/(1 + 2/3) = 0.6 for r = R, 1/(1 + 2/(3 · 0.09)) = 0.12 for r = 0.3 R
    assert "K of 0.086, but a ball of the given inertia has 0.12 to 0.6 on any track" in slow.text
    assert "crank" in slow.text
    fast = contradicted(ball, rig_of_ratio(ball, rough_rig(ball), 1.2)[0])
    assert fast is not None
    assert "1.2 times as much as a mass that slides without friction" in fast.text
    assert contradicted(ball, rig_of_ratio(ball, rough_rig(ball), 0.4)[0]) is None


@pytest.mark.parametrize(("ratio", "told"), [(0.05, True), (0.12, False), (0.5, False), (0.714, False), (0.9, True)])
def test_a_ratio_that_no_ball_has_is_told(ratio: float, told: bool) -> None:
    """Say so where nothing of the ball is known: 0.119 is hollow, at r = 0.3 R, and 5/7 solid, on a flat rail."""
    unknown = KnownRig(gravity=9.81)
    warning = contradicted(unknown, rig_of_ratio(unknown, rough_rig(unknown), ratio)[0])
    assert (warning is not None) == told
    if warning is not None:
        assert "but a ball, solid or hollow, has 0.12 to 0.71 on any track" in warning.text


@pytest.mark.parametrize("share", [0.999, 0.99999, 1.0])
def test_a_ratio_close_to_that_of_a_plane_keeps_the_ball_solid(share: float) -> None:
    """Adapt the rolling radius, not the inertia, up to the flat rail of a solid ball, K = 5/7."""
    known = KnownRig(gravity=9.81, radius=0.0132, mass=0.071)
    rough = rough_rig(known)
    ratio = rough.with_(rolling_radius=share * 0.0132).rolling_ratio
    rig, note = rig_of_ratio(known, rough, ratio)
    assert note.name == "rolling radius r"
    assert rig.rolling_radius == pytest.approx(share * 0.0132, rel=1e-12)
    assert rig.inertia == pytest.approx(0.4 * 0.071 * 0.0132**2)


def test_an_estimate_just_above_that_of_a_plane_is_a_flat_rail() -> None:
    """Take K = 5/7 for an estimate within three standard errors above it, and adapt the inertia beyond that."""
    known = KnownRig(gravity=9.81, radius=0.0132, mass=0.071)
    rig, note = rig_of_ratio(known, rough_rig(known), 5.0 / 7.0 + 0.0029, 0.001)
    assert (rig.rolling_radius, note.name) == (0.0132, "rolling radius r")
    assert rig.rolling_ratio == pytest.approx(5.0 / 7.0, rel=1e-12)
    rig, note = rig_of_ratio(known, rough_rig(known), 5.0 / 7.0 + 0.0031, 0.001)
    assert note.name == "inertia J"
    assert rig.rolling_ratio == pytest.approx(5.0 / 7.0 + 0.0031, rel=1e-12)


@pytest.mark.parametrize("name", DEFAULT_ENGINES)
@pytest.mark.parametrize(("known", "ratio", "chosen"), CASES)
def test_engines_run_the_completed_rig(name: str, known: KnownRig, ratio: float, chosen: str) -> None:
    """Follow CAM in every engine with the completed rig, however unusual."""
    rig, _ = rig_of_ratio(known, rough_rig(known), ratio)
    time, start = np.arange(101) * 0.01, State(0.36, -0.1)
    run = engine_of(name).run(rig, Sines(), start, time)
    (cam,) = simulate([CAM], rig, Sines(), start, time)
    # 10 times what the engines reach in 10 s with the paper's rig; a rig of another K would be off by centimetres.
    np.testing.assert_allclose(run.trajectory.position, cam.position, atol=5e-5)


def test_rough_rig_fits_what_is_known() -> None:
    """Complete a ball as a solid one: its mass from its inertia, its radius from its groove."""
    rig = rough_rig(KnownRig(inertia=1.6e-6, radius=0.01, gravity=9.81))
    assert rig.mass == pytest.approx(0.04)
    assert rough_rig(KnownRig(rolling_radius=0.0118)).radius == pytest.approx(0.0132)
    assert rough_rig(KnownRig()).inertia_ratio == pytest.approx(Rig().inertia_ratio, rel=2e-3)


def test_the_radius_alone_is_not_missed() -> None:
    """Estimate nothing where K is known: a trajectory does not depend on R beside r."""
    complete = {"mass": 0.071, "inertia": 4.948e-6, "rolling_radius": 0.0118, "gravity": 9.81}
    assert missing(KnownRig(**complete, eccentricity=0.035)) == frozenset()
    assert missing(KnownRig(**complete)) == {"lever"}
    assert missing(KnownRig(gravity=9.81)) == {"ratio", "lever"}
    assert rough_rig(KnownRig(**complete, eccentricity=0.035)).rolling_ratio == pytest.approx(Rig().rolling_ratio)


@pytest.mark.parametrize("level", [0, 0.0])
def test_a_level_angle_may_be_given_as_a_whole_number(level: float) -> None:
    """Take the given angle in place of that of rig.toml, written as 0 as well as 0.0."""
    case = load_case("paper_protocol")
    tilted = replace(case, rig=replace(case.rig, level_angle=0.02))
    assert complete_rig(tilted, next(iter(case.recordings.values())), level).rig.level_angle == 0.0
