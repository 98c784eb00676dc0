"""The comparison with the baselines: won where the model knows what acts, and fair to those who do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.diagnosis import diagnose
from harness.identify.estimate.block_errors import block_errors, groups_of
from harness.identify.estimate.cross_validation import cross_validated
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.free_run_fit import Effort, fit_free_runs
from harness.identify.estimate.window_errors import window_errors
from harness.identify.pose import problem_of, unknown_effects
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.windows import fitted_windows, windows_of
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    BaselineComparison,
    compare_with_baselines,
)
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
    made = compare_with_baselines(posed.problem, base, found)
    assert made is not None
    return made


@pytest.mark.slow
def test_who_knows_what_acts_wins(held: BaselineComparison) -> None:
    """Beat all baselines and the model without the effect, beyond chance, where the effect is known."""
    assert held.blocks == 8  # four of 16 s, of each of two recordings
    for other in (BEFORE, *BASELINES):
        assert held.rms(AFTER) < 0.5 * held.rms(other)
        margin = held.margin(other)
        assert margin is not None
        assert margin.sure
        assert margin.low <= margin.value <= margin.high


@pytest.mark.slow
def test_gains_and_blocks_won_follow_from_the_errors(held: BaselineComparison) -> None:
    """Gain the difference of RMS errors, and win the blocks that are predicted better."""
    for name in BASELINES:
        margin = held.margin(name)
        assert margin is not None
        assert margin.value == pytest.approx(held.rms(name) - held.rms(AFTER))
        assert held.won(name) == np.sum(held.errors[AFTER] < held.errors[name])


@pytest.mark.slow
def test_the_model_knows_two_seconds_only(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Miss a window by the same when everything before and after it is changed, for the model is no better informed."""
    posed, _, found = rolling
    window = windows_of(posed.problem.recordings)[1]

    def shifted(reading: FloatArray) -> FloatArray:
        outside = np.ones(len(reading), dtype=bool)
        outside[window.use] = False
        return reading + 0.1 * outside

    other = replace(window.recording, reading=shifted(window.recording.reading))
    assert window_errors(posed.problem, found, [replace(window, recording=other)]) == window_errors(
        posed.problem, found, [window]
    )


@pytest.mark.slow
def test_held_out_readings_have_no_say(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Predict a group of blocks the same whatever their readings are that nobody knows while they are held out.

    If errors e of a window become e ± d at a share m of its readings, 2 m d² is added to twice their mean square.
    """
    posed, _, found = rolling
    _, blocks = groups_of(posed.problem.recordings)[0]
    windows = [window for block in blocks for window in block.held_out]
    recording = windows[0].recording
    assert all(one.recording is recording for one in windows)
    hidden, known = np.zeros((2, len(recording.time)), dtype=bool)
    for window in windows:
        hidden[window.use] |= window.judged
        known[window.use] |= window.known
    hidden &= ~known

    def squares(shift: float) -> FloatArray:
        other = replace(recording, reading=recording.reading + shift * hidden)
        recordings = tuple(other if one is recording else one for one in posed.problem.recordings)
        return block_errors(replace(posed.problem, recordings=recordings), found)[: len(blocks)] ** 2

    d = 0.01
    shares = [np.mean([np.mean(hidden[one.use][one.judged]) for one in block.held_out]) for block in blocks]
    assert max(shares) > 0.1  # or it would say nothing
    added = squares(d) + squares(-d) - 2.0 * squares(0.0)
    np.testing.assert_allclose(added, 2.0 * d**2 * np.array(shares), rtol=1e-9, atol=1e-15)


@pytest.mark.slow
def test_fits_to_free_runs_are_repeated_as_in_their_cross_validation(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Find the errors again that the cross-validation of a fit to free runs found."""
    posed, _, found = rolling
    windows = fitted_windows(posed.problem.recordings)
    begun = fit_free_runs(posed.problem, found.hypothesis, windows, initial=found.values(), effort=Effort.NEAR).fit
    whole = cross_validated(posed.problem, begun)
    assert whole.held_out
    np.testing.assert_array_equal(block_errors(posed.problem, whole), whole.held_out)
    np.testing.assert_allclose(block_errors(posed.problem, replace(whole, held_out=())), whole.held_out, rtol=1e-9)


def test_like_against_like_is_a_draw() -> None:
    """Claim nothing where two miss by the same on average, and nothing at all of three blocks."""
    one, other = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), np.array([2.0, 1.0, 4.0, 3.0, 6.0, 5.0])
    made = BaselineComparison({AFTER: 1e-3 * one, BASELINES[0]: 1e-3 * other})
    margin = made.margin(BASELINES[0])
    assert margin is not None
    assert margin.low < 0.0 < margin.high
    assert BaselineComparison({AFTER: one[:3], BASELINES[0]: other[:3]}).margin(BASELINES[0]) is None


@pytest.mark.slow
def test_short_recordings_hold_nothing_to_compare(rolling: tuple[Posed, Fit, Fit]) -> None:
    """Say nothing where what is left beside a held-out block does not last for two windows."""
    posed, base, found = rolling
    short = tuple(replace(one, time=one.time[:400], reading=one.reading[:400]) for one in posed.problem.recordings)
    assert compare_with_baselines(replace(posed.problem, recordings=short[:1]), base, found) is None


def test_what_the_rig_file_leaves_open_is_fitted_beside() -> None:
    """Stand in for K, α₀ and the lever of α̈ by an effect each, only where nobody knows them."""
    whole = KnownRig(mass=0.07, inertia=5e-6, radius=0.0132, rolling_radius=0.0118, eccentricity=0.0, gravity=9.81)
    assert unknown_effects(whole) == ()
    assert unknown_effects(replace(whole, rolling_radius=None)) == ("angle_gain", "level_error")
    assert unknown_effects(replace(whole, rolling_radius=None, level_angle=0.0)) == ("angle_gain",)
    nowhere = replace(whole, eccentricity=None)
    assert unknown_effects(nowhere) == ("level_error", "eccentric_pivot")
    assert unknown_effects(nowhere, lever=False) == ("level_error",)


@needs_shared
@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("daisy", 2), ("uts", 3)])
def test_measured_rigs_are_predicted_better_than_by_baselines(name: str, count: int) -> None:
    """Predict held-out blocks of real rigs better than all baselines, from their first recordings."""
    problem = problem_of(load_case(RECORDINGS / name))
    made = diagnose(replace(problem, recordings=problem.recordings[:count])).baselines
    assert made is not None
    assert made.rms(AFTER) < min(made.rms(one) for one in BASELINES)
