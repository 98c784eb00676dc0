"""A study of the short case, shared by all tests of tolerances."""

from __future__ import annotations

import pytest

from harness.comparison import Choices, Study, prepare, study
from harness.engines.mujoco import MuJoCo
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.engines.pybullet import PyBullet, PyBulletParameters
from harness.recording import load_case
from tests.tolerances.short_case import write_case


@pytest.fixture(scope="package")
def short_study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """The short case through every model, MuJoCo, and a PyBullet whose contacts cannot hold the ball."""
    case = load_case(write_case(tmp_path_factory.mktemp("short")))
    engines: list[tuple[Engine, EngineParameters]] = [
        (MuJoCo(), MuJoCoParameters()),
        (PyBullet(), PyBulletParameters(lateral_friction_rail=0.001)),
    ]
    return study(prepare(case, Choices(lengths=(1.0, 2.0))), engines)
