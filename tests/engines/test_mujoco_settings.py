"""MuJoCo's settings: what it would ignore is refused, what is numerical leaves the motion alone."""

from __future__ import annotations

import mujoco
import pytest
from pydantic import ValidationError

from harness.engines.mujoco import MuJoCo
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.engines.parameters import EngineParameters
from harness.errors import InputError
from tests.engines.test_mujoco import PAPER, STAMPS, START, bound, error
from tests.motions import Ramp


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"solref_timeconst": 1e-3}, "under two time steps"),
        ({"time_step": 2e-3, "solref_timeconst": 2e-3}, "under two time steps"),
        ({"rolling_friction": 1e-4}, "acts from condim 6"),
        ({"torsional_friction": 1e-4}, "acts from condim 4"),
        ({"condim": 6, "torsional_friction": 1e-4}, "raises rolling_friction 0 to 1e-05"),
        ({"condim": 4}, "raises torsional_friction 0 to 1e-05"),
        ({"cone": "pyramidal", "friction_relaxation": 1.5}, "elliptic"),
        ({"solimp_dmax": 1.0}, "0.9999"),
        ({"friction": 0.0}, "greater than or equal to 0.00001"),
        ({"condim": 1}, "3, 4 or 6"),
        ({"integrator": "RK4"}, "implicitfast"),
        ({"frictoin": 0.3}, "frictoin"),
    ],
)
def test_settings_mujoco_would_ignore_are_refused(settings: dict[str, object], message: str) -> None:
    """Refuse what MuJoCo would clamp or ignore without a word, and say what it would have done."""
    with pytest.raises(ValidationError, match=message):
        MuJoCoParameters(**settings)  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        {"solver": "CG"},
        {"solver": "PGS", "iterations": 200},
        {"integrator": "implicitfast"},
        {"integrator": "implicit"},
        {"noslip_iterations": 5},
        {"friction_across": 0.5},
        {"friction_across": 0.01, "impratio": 1.0},
        {"gap": 1e-3},
        {"solimp_dmax": 0.995},
        {"friction_relaxation": 1.5},
    ],
)
def test_numerical_settings_leave_the_motion_alone(settings: dict[str, object]) -> None:
    """Arrive within a few micrometres whatever solver, integrator or cone the user prefers."""
    # PGS and CG stop at a tolerance; they leave slips of up to 3e-5 m/s, of either sign, and twice the height error.
    assert error(**settings) < 3 * bound(PAPER)


def test_every_setting_is_described() -> None:
    """Describe each parameter, with its unit where it has one, for the help text."""
    named = {"cone", "integrator", "solver", "condim", "refsafe"}
    for name, field in MuJoCoParameters.model_fields.items():
        assert field.description
        assert name in named or "[" in field.description, name


def test_settings_of_another_engine_are_refused() -> None:
    """Refuse parameters that are not MuJoCo's."""
    with pytest.raises(InputError, match="MuJoCoParameters"):
        MuJoCo().run(PAPER, Ramp(0.01), START, STAMPS, parameters=EngineParameters())


def test_version_is_the_packages() -> None:
    """Name the version for the manifest."""
    assert MuJoCo().version() == mujoco.__version__
