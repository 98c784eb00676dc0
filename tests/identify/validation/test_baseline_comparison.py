"""The comparison with the baselines: won where the model knows what acts, and fair to those who do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.diagnosis import diagnose
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.window_errors import window_error
from harness.identify.pose import problem_of, unknown_effects
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.windows import windows_of
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    BaselineComparison,
    compare_with_baselines,
)
from harness.identify.validation.held_out import fit_folds
from harness.recording import KnownRig, load_case
from tests.posed import Posed, pose
from tests.shared_data import RECORDINGS

needs_shared = pytest.mark.skipif(not RECORDINGS.is_dir(), reason="the folder ../shared is absent")
ROLLING = "rolling_resistance"


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> tuple[Posed, Fit, Fit]:
    """A rig whose ball rolls with a resistance that is not declared, and fits without and with it."""
    posed = pose(tmp_path_factory.mktemp("rolling") / "case", 0, {ROLLING: {"coefficient": 0.004}})
    base = fit(posed.problem, Hypothesis(()))
    return posed, base, fit(posed.problem, Hypothesis((ROLLING,)), process_noise=base.process_noise)


@pytest.fixture(scope="module")
def held(rolling: tuple[Posed, Fit, Fit]) -> BaselineComparison:
    """The comparison on that rig."""
    posed, base, found = rolling
    made = compare_with_baselines(fit_folds(posed.problem, base, found))
    assert made is not None
    return made


def test_who_knows_what_acts_wins(held: BaselineComparison) -> None:
    """Beat both baselines and the model without the effect, beyond chance, where the effect is known."""
    assert held.windows == 8  # four of 16 s, of each of two recordings
    for other in (BEFORE, *BASELINES):
        assert held.rms(AFTER) < 0.5 * held.rms(other)
        margin = held.margin(other)
        assert margin is not None
        assert margin.sure
        assert margin.low <= margin.value <= margin.high


def test_gains_and_windows_won_follow_from_the_errors(held: BaselineComparison) -> None:
    """Gain the difference of RMS errors, and win the windows that are predicted better."""
    for name in BASELINES:
        margin = held.margin(name)
        assert margin is not None
        assert margin.value == pytest.approx(held.rms(name) - held.rms(AFTER))
        assert held.won(name) == np.sum(held.errors[AFTER] < held.errors[name])


def test_the_model_knows_two_seconds_only(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Miss a window by the same when everything before and after it is changed, for the model is no better informed."""
    posed, _, found = rolling
    window = windows_of(posed.problem.recordings)[1]

    def shifted(reading: FloatArray) -> FloatArray:
        outside = np.ones(len(reading), dtype=bool)
        outside[window.use] = False
        return reading + 0.1 * outside

    other = replace(window.recording, reading=shifted(window.recording.reading))
    assert window_error(posed.problem, found, replace(window, recording=other)) == window_error(
        posed.problem, found, window
    )


def test_like_against_like_is_a_draw() -> None:
    """Claim nothing where two miss by the same on average, and nothing at all of three windows."""
    one, other = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), np.array([2.0, 1.0, 4.0, 3.0, 6.0, 5.0])
    made = BaselineComparison({AFTER: 1e-3 * one, BASELINES[0]: 1e-3 * other})
    margin = made.margin(BASELINES[0])
    assert margin is not None
    assert margin.low < 0.0 < margin.high
    assert BaselineComparison({AFTER: one[:3], BASELINES[0]: other[:3]}).margin(BASELINES[0]) is None


def test_short_recordings_hold_no_compare_with_baselines(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Say nothing where no held-out piece lasts 5 s."""
    posed, base, found = rolling
    short = tuple(
        replace(one, time=one.time[:400], reading=one.reading[:400], name=one.name) for one in posed.problem.recordings
    )
    held = [replace(one, compared=short[:1]) for one in fit_folds(posed.problem, base, found)]
    assert compare_with_baselines(held) is None


def test_what_the_rig_file_leaves_open_is_fitted_beside() -> None:
    """Stand in for K by a gain of the angle, and for α₀ by a level error, only where nobody knows them."""
    whole = KnownRig(mass=0.07, inertia=5e-6, radius=0.0132, rolling_radius=0.0118, eccentricity=0.0, gravity=9.81)
    assert unknown_effects(whole) == ()
    assert unknown_effects(replace(whole, rolling_radius=None)) == ("angle_gain", "level_error")
    assert unknown_effects(replace(whole, rolling_radius=None, level_angle=0.0)) == ("angle_gain",)


@needs_shared
@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("daisy", 2), ("uts", 3)])
def test_measured_rigs_are_predicted_better_than_by_baselines(name: str, count: int) -> None:
    """Predict held-out pieces of real rigs better than both baselines, from their first recordings."""
    problem = problem_of(load_case(RECORDINGS / name))
    made = diagnose(replace(problem, recordings=problem.recordings[:count])).baselines
    assert made is not None
    assert made.rms(AFTER) < min(made.rms(one) for one in BASELINES)
