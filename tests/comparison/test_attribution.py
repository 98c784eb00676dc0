"""An engine's error is split without remainder, and each part answers to its cause."""

from __future__ import annotations

from functools import cache
from typing import Any, Protocol

import numpy as np
import pytest

from analytic.models import CAM
from harness.comparison import Setting
from harness.comparison.attribution import Attribution, attribute
from harness.comparison.sources import SourceRuns, run_engine, run_models
from harness.engines.catalogue import engine_of, parameters_of


class Split(Protocol):
    """The attribution of one engine's free run, that run, and CAM's."""

    def __call__(self, name: str, **settings: Any) -> tuple[Attribution | None, SourceRuns, SourceRuns]:
        """By the engine's name and settings other than its own."""


@pytest.fixture(scope="module")
def split(bundled: Setting) -> Split:
    """Split a run on the bundled recording; what was asked for before is not run again."""

    @cache
    def of(name: str, parameters: Any) -> tuple[Attribution | None, SourceRuns, SourceRuns]:
        engine, whole = engine_of(name), bundled.horizons[0]
        own, (cam,) = run_engine(bundled, engine, parameters, whole), run_models(bundled, [CAM], whole)
        return attribute(bundled, engine, parameters, own, cam), own, cam

    return lambda name, **settings: of(name, parameters_of(engine_of(name), settings))


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_parts_add_up(split: Split, bundled: Setting, name: str) -> None:
    """Add numerical part, contact model and physics up to engine − measured, stamp by stamp."""
    parts, own, _ = split(name)
    assert parts is not None
    total = parts.numerical + parts.contact + parts.physics
    error = own.position - bundled.recording.position
    # Sums and differences of a few numbers below 1 m: some units in the last place, 2e-16 each.
    np.testing.assert_allclose(total[parts.use], error[parts.use], atol=5e-15)
    assert sum(parts.shares().values()) == pytest.approx(1.0, abs=1e-12)
    assert parts.rms()["total"] == pytest.approx(np.sqrt(np.mean(error[parts.use] ** 2)), rel=1e-12)


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_numerical_part_shrinks_with_the_step(split: Split, name: str) -> None:
    """Shrink the numerical part with at least the first power of the step."""
    parts = [split(name, time_step=dt)[0] for dt in (4e-3, 2e-3, 1e-3)]
    rms = [one.rms()["numerical"] for one in parts if one is not None]
    slope = np.polyfit(np.log([4e-3, 2e-3, 1e-3]), np.log(rms), 1)[0]
    # Both integrators promise order 1 and reach about 2 with mean rates; the contacts mix the two.
    assert 0.9 < slope < 3.1
    # The split is right if the step's effect, which is known here from the run itself, is all in the numerical part:
    # what is left to the contact model must not shrink with the step by more than its own uncertainty.
    assert rms[-1] < 5e-6  # at 1 ms both engines keep within 5 µm of CAM


def test_measured_order_is_that_of_the_engine(split: Split) -> None:
    """Find order 2 for PyBullet, whose drive is of second order (tests/engines/test_pybullet.py)."""
    parts, _, _ = split("pybullet")
    assert parts is not None
    assert parts.order == pytest.approx(2.0, abs=0.1)
    # An extrapolation with the right order leaves of the step's effect what is of the next order: with 1 instead of 2
    # half of the numerical part would be taken for a contact model.
    assert parts.rms()["contact"] < 0.1 * parts.rms()["numerical"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("mujoco", {"solref_timeconst": 0.05, "margin": 0.0}),
        ("pybullet", {"rolling_friction": 1e-5}),
    ],
)
def test_a_changed_contact_shows_as_contact_model(split: Split, name: str, settings: dict[str, Any]) -> None:
    """Attribute a softened or braking contact to the contact model, not to step size or missing physics."""
    right, own_right, _ = split(name)
    wrong, own_wrong, _ = split(name, **settings)
    assert right is not None
    assert wrong is not None
    moved = np.sqrt(np.mean((own_wrong.position - own_right.position)[wrong.use] ** 2))
    assert moved > 1e-4
    # All but the step's effect on either run, which is micrometres, has to be found again; soft contacts cost more.
    assert wrong.rms()["contact"] == pytest.approx(moved, rel=0.1)
    assert wrong.rms()["contact"] > 10.0 * wrong.rms()["numerical"]
    assert wrong.rms()["physics"] == right.rms()["physics"]


def test_physics_is_what_cam_lacks(split: Split, bundled: Setting) -> None:
    """Attribute CAM − measured to physics for every engine."""
    one, _, cam = split("mujoco")
    other, _, _ = split("pybullet")
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one.physics, other.physics)
    np.testing.assert_array_equal(one.physics, cam.position - bundled.recording.position)


def test_a_failed_run_is_not_explained(split: Split) -> None:
    """Explain nothing where the ball fell."""
    parts, own, _ = split("pybullet", contact_stiffness=10.0, contact_damping=0.1)
    assert own.failures
    assert parts is None
