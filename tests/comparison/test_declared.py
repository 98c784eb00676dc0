"""Effects that are declared to act do so in every source."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.models import CAM
from harness.comparison import Choices, prepare
from harness.comparison.sources import run_engine, run_models
from harness.engines.catalogue import engine_of, parameters_of
from harness.errors import InputError
from harness.recording import load_case
from harness.simulator import Experiment, write_case

DECLARED = {"rolling_resistance": {"coefficient": 0.004}, "level_error": {"angle": 0.002}}


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of a plant on which both effects act; rig.toml declares them."""
    folder = tmp_path_factory.mktemp("declared")
    write_case(folder, Experiment(declared=DECLARED, seed=5))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("source", ["cam", "mujoco", "pybullet"])
def test_source_with_declared_effects_follows_the_plant(case: Path, source: str) -> None:
    """Stay within sensor noise over windows of 2 s; without the effects they would be off by centimetres."""
    setting = prepare(load_case(case), Choices(lengths=(2.0,)))
    horizon = setting.horizons[1]
    if source == "cam":
        run = run_models(setting, [CAM], horizon)[0]
    else:
        engine = engine_of(source)
        run = run_engine(setting, engine, parameters_of(engine, {}), horizon)
    error = run.position - setting.recording.position[horizon.stamps]
    # Noise of 0.3 mm, and a start velocity known to about 0.2 mm/s, which is 0.2 mm RMS over 2 s; the ball starts where
    # friction jumps in some windows, which doubles that.
    assert np.sqrt(np.mean(error**2)) < 7e-4


def test_unknown_declared_effect_is_named(case: Path, tmp_path: Path) -> None:
    """Say which effects exist when rig.toml declares another."""
    for file in case.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    rig = tmp_path / "rig.toml"
    rig.write_text(rig.read_text().replace('"rolling_resistance"', '"roling_resistance"'))
    with pytest.raises(InputError, match=r"roling_resistance.*Did you mean 'rolling_resistance'"):
        prepare(load_case(tmp_path), Choices())
