"""Settings shared by the tests of one worker: making and preparing them is most of what a test costs."""

from __future__ import annotations

import pytest

from harness.comparison import Choices, Setting, prepare
from harness.recording import load_case
from harness.recording.case import BUNDLED
from harness.simulator import Plant
from tests.comparison.made import COARSE, FINE, Made, sensors, steps, swing, write_case

SEEDS = range(5)


@pytest.fixture(scope="session")
def bundled() -> Setting:
    """The bundled recording."""
    return prepare(load_case(BUNDLED), Choices())


@pytest.fixture(
    scope="session",
    params=[(swing, FINE), (swing, COARSE), (steps, FINE), (steps, COARSE)],
    ids=["swing, 40,000 counts", "swing, 4,096 counts", "steps, 40,000 counts", "steps, 4,096 counts"],
)
def perfect(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Made, Setting]]:
    """Recordings of a rig that CAM describes exactly."""
    make, counts = request.param
    used = sensors(counts)
    folder = tmp_path_factory.mktemp("perfect")
    cases = [write_case(folder / str(seed), [make(seed, Plant(), used)], used) for seed in SEEDS]
    return [(made, made.prepare()) for made in cases]
