"""Windows that engines are fitted to: where they begin, and that a ball which slides between them does no harm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.effects import acting
from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.identify.pose import problem_of
from harness.identify.problem.problem import Problem
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from harness.tuning.estimate.fit import fit
from harness.tuning.estimate.free import LEVEL, free_of, level_of
from harness.tuning.estimate.runs import Model
from harness.tuning.estimate.windows import fitted_stretches, stretches_of

FRICTION, TILT = 0.01, -3.6e-3  # μ, near where the ball slides on the steepest beam; α₀ [rad]


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A simulated recording of 16 s in which the ball slides when the beam is steep."""
    hidden = {"level_error": {"angle": TILT}, "contact_slip": {"friction_coefficient": FRICTION}}
    experiment = Experiment(
        rig=Rig(), hidden=hidden, duration=16.0, counts=4096, rate=50.0, identify=1, predict=0, seed=604_003
    )
    folder = tmp_path_factory.mktemp("sliding") / "case"
    write_case(folder, experiment, experiment.recordings(None))
    return problem_of(load_case(folder))


def test_windows_begin_where_the_beam_is_least_steep(problem: Problem) -> None:
    """Begin a window at six tenths of the largest tilt at most, and lose no reading between two windows."""
    (recording,) = problem.recordings
    first, second = fitted_stretches(problem)
    tilt = np.abs(np.interp(second.time[0], recording.drive.time, recording.drive.states[:, 0]))
    assert tilt < 0.6 * np.max(np.abs(recording.drive.states[:, 0]))
    assert second.time[0] - first.time[-1] == pytest.approx(0.04, abs=0.02)  # one cell after the other
    assert second.time[0] == pytest.approx(8.0, abs=1.05)


def test_a_window_begins_at_a_reading(problem: Problem) -> None:
    """Begin a window at a reading behind a drop-out, and at the even division where no tilt is smaller."""
    (recording,) = problem.recordings
    time = recording.time
    lost = replace(recording, reading=np.where((time > 6.9) & (time < 8.5), np.nan, recording.reading))
    first, second = fitted_stretches(replace(problem, recordings=(lost,)))
    assert 8.5 <= second.time[0] < 9.05
    # The first window ends with the last reading before the second, behind the drop-out or before it.
    ends = time[np.isfinite(lost.reading) & (time < second.time[0] - 0.02)][-1]
    assert first.time[-1] == pytest.approx(ends, abs=0.05)
    nothing = replace(recording, reading=np.where((time > 6.9) & (time < 9.1), np.nan, recording.reading))
    assert len(fitted_stretches(replace(problem, recordings=(nothing,)))) == 2
    drive = recording.drive
    level = replace(recording, drive=replace(drive, states=np.zeros_like(drive.states)))
    assert fitted_stretches(replace(problem, recordings=(level,)))[1].time[0] == pytest.approx(8.0, abs=0.03)


@pytest.mark.slow
def test_a_ball_that_slides_between_windows_is_no_missing_physics(problem: Problem) -> None:
    """Find friction and level within four standard deviations, with residuals of noise, by windows so begun.

    Where a window begins on a steep beam, the ball slides at once, the engine's rolls, and residuals say so.
    """
    engine = engine_of("mujoco")
    settings = {"time_step": 2e-3}
    base = parameters_of(engine, settings)
    free = {one.name: one for one in (level_of(problem.rig), *free_of(engine, problem.rig, base, ["friction"]))}
    model = Model(engine, problem, settings, free)
    truth = {"friction": FRICTION, LEVEL: TILT}
    tuned = [free[name] for name in truth]
    found = fit(model, fitted_stretches(problem), tuned, truth)
    assert found.complete
    for name, value in truth.items():
        low, high = found.interval(name)
        # one of 16,000 normal errors is larger
        assert abs(found.values[name] - value) < 4.0 * (high - low) / (2.0 * 1.96)
    (recording,) = problem.recordings
    steepest = float(recording.drive.time[np.argmax(np.abs(recording.drive.states[:, 0]))])
    badly_begun = stretches_of(problem, recording, [(steepest, 17.0)])
    assert not fit(model, badly_begun, tuned, truth).complete


@pytest.mark.parametrize("delay", [-0.6, 0.6])
def test_cells_lie_where_the_angle_is_known(problem: Problem, delay: float) -> None:
    """Leave out readings of a ball that was on a beam before or after its recording, and keep the others."""
    delayed = replace(problem, declared=(*problem.declared, acting("channel_delay", {"delay": delay})))
    begin, end = problem.recordings[0].drive.time[[0, -1]]
    time = np.concatenate([one.time for one in fitted_stretches(delayed)]) - delay
    assert np.all((time >= begin) & (time <= end))
    assert np.ptp(time) > end - begin - 0.7
