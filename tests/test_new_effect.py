"""A new effect is one `Effect`: search, engines, report and virtual rig take it as all others."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import Effect, Force, Parameter, Relations, acting, joined, parameters_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import State
from analytic.rig import Rig
from benchmarks.calibration.engine_ball import engine_mover
from benchmarks.calibration.rows import Outcome
from benchmarks.calibration.run import diagnosed
from benchmarks.calibration.trials import plan
from harness.api.assemble import diagnosis_record
from harness.errors import InputError
from harness.identify.diagnosis import diagnose
from harness.identify.pose import problem_of
from harness.recording import load_case
from harness.report.diagnosis import render_diagnosis
from harness.simulator import Experiment, Plant, simulate, write_case
from tests.motions import Sines

FREQUENCY = 60.0  # [1/rad]
HOSE = Effect(
    "hose_pull",
    "F = F_max sin(60 α)",
    (Parameter("force", "N", -0.1, 0.1, 0.005, starts=(0.0,), strength=True, shown=("mN", 1e3)),),
    "made up: an air hose that lies across the beam",
    force=Force("angle", lambda angle, force: force * np.sin(FREQUENCY * angle)),
    phrase="a hose that pulls with {force}",
    relations=Relations(nested_in=(("angle", False),)),
)
VALUES = {"force": 0.008}


@pytest.fixture(autouse=True)
def _joined() -> Iterator[None]:
    """The line in the catalogue."""
    with joined([HOSE]):
        yield


def test_plant_and_kernel_move_the_ball_alike() -> None:
    """Compile the force for the plant, sample it for the kernel: the ball runs alike, and elsewhere without it."""
    time, motion, start = np.arange(401) / 100.0, Sines(((0.01, 1.7, 0.0), (0.012, 3.1, 0.4))), State(0.36, 0.0)
    truth = simulate(Plant(step=5e-5).with_effects({HOSE.name: VALUES}), motion, start, time[-1])
    expected = np.interp(time, truth.time, truth.position)
    grid = Grid.over(time)

    def run(*values: dict[str, float]) -> np.ndarray:
        vector = parameters_with(CAM, Rig(), [acting(HOSE.name, one) for one in values])
        return integrate(grid, grid.tabulate(motion), vector, np.array([[0.36, 0.0]])).position[0]

    # Nodes 1/256 rad apart leave (60/256)⁴/384 of K F/m, 6e-7 m/s²: in 4 s 5e-6 m if it pushed to one side.
    assert np.max(np.abs(run(VALUES) - expected)) < 5e-6
    assert np.max(np.abs(run() - expected)) > 0.05


def test_engine_ball_gets_the_force_too() -> None:
    """Follow the plant's ball in MuJoCo, where the force is the only thing that a motion along the beam lacks."""
    experiment = Experiment(seed=3, identify=1, predict=0, duration=4.0, hidden={HOSE.name: VALUES})
    own, other = experiment.recordings()[0], experiment.recordings(engine_mover("mujoco"))[0]
    bare = replace(experiment, hidden={}).plant(experiment.seeds[0], {})
    assert bare.force is None
    # below 1 µm each in 6 s, as of every smooth force (tests/benchmarks/test_engine_ball.py)
    assert np.max(np.abs(own.position - other.position)) < 1e-6


def test_a_law_that_cannot_be_compiled_is_refused() -> None:
    """Say what the virtual rig needs of a law."""
    text = Effect(
        "of_text",
        "F",
        HOSE.parameters,
        "here",
        force=Force("angle", lambda angle, force: force * sum(map(ord, str(angle)))),
    )
    written = Effect("written", "F", HOSE.parameters, "here", write=lambda p, rig, values: None)
    with joined([text, written]):
        with pytest.raises(InputError, match="of_text: the virtual rig cannot compile its law"):
            Plant().with_effects({"of_text": VALUES})
        with pytest.raises(InputError, match="no law of its own for written"):
            Plant().with_effects({"written": VALUES})


@pytest.mark.slow
@pytest.mark.parametrize("plant", ["virtual_rig", "mujoco"])
def test_blind_trials_find_it(plant: str) -> None:
    """Plan trials of it about its typical size, hide it on the virtual rig and in an engine's scene, and name it."""
    every = plan(["confusion"], seeds=4, only=[HOSE.name])
    assert {one.size for one in every} == {"small", "middle", "large"}
    row = diagnosed(next(one for one in every if one.size == "middle" and one.plant == plant), "test")
    assert row.outcome is Outcome.RIGHT, row
    (interval,) = row.intervals()
    assert abs(interval.z) < 4.0, interval  # one of 20 intervals misses the truth; one error in 16,000 is beyond this


@pytest.mark.slow
def test_diagnosis_and_report_take_it(tmp_path: Path) -> None:
    """Find it, put it into both engines, which then predict better, and say it in its own words."""
    write_case(tmp_path / "case", Experiment(hidden={HOSE.name: VALUES}, duration=8.0, seed=1, predict=0))
    case = load_case(tmp_path / "case")
    found = diagnose(problem_of(case))
    (effect,) = found.effects
    force = effect.parameters["force"]
    assert (effect.name, force.unit) == (HOSE.name, "N")
    assert force.low < VALUES["force"] < force.high
    for name in ("mujoco", "pybullet"):
        before, after = (found.engines[name][when]["rms_m"]["whole"] for when in ("before", "after"))
        assert after < 0.2 * before
    page = render_diagnosis(found, diagnosis_record(found, case, 1.0, {}), case)
    assert re.search(r"hose that pulls with 8\.\d+ ± 0\.\d+ mN", page)
    assert "hose pull" in page  # where it enters the engines' scenes
