"""Errors in physical units against cases that can be worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.errors import InputError
from harness.metrics.errors import fit_percent, fraction_outside, max_error, rms_error
from harness.metrics.run_comparison import RunComparison, trapezoid_weights
from harness.metrics.time_history import absolute_integral

ROUNDING = 1e-12  # relative: sums of at most 1e3 terms lose at most 1e3 ε = 2e-13

stamps = st.lists(st.floats(1e-3, 0.5), min_size=3, max_size=60).map(lambda steps: np.cumsum([0.0, *steps]))


@given(stamps, st.floats(-0.2, 0.2))
def test_offset_is_its_own_size(time, offset):
    """State a constant error as that error, whatever the stamps."""
    error = np.full(time.shape, offset)
    assert max_error(error) == abs(offset)
    assert rms_error(error) == pytest.approx(abs(offset), rel=ROUNDING)
    assert absolute_integral(error, trapezoid_weights(time)) == pytest.approx(
        abs(offset) * (time[-1] - time[0]), rel=ROUNDING
    )


@given(stamps, st.floats(0.0, 0.1), st.floats(0.0, 0.1))
def test_paper_integral_of_a_growing_error(time, start, slope):
    """Integrate an error that grows steadily without loss on uneven stamps: trapezoids are exact there."""
    duration = time[-1]
    exact = start * duration + 0.5 * slope * duration**2
    assert absolute_integral(start + slope * time, trapezoid_weights(time)) == pytest.approx(exact, rel=ROUNDING)


def test_paper_integral_of_a_sine():
    """Give E_disp of a full sine as 4 A/ω."""
    time = np.linspace(0.0, 2.0, 2001)
    amplitude, omega = 0.01, np.pi  # one period; its zero at t = 1 s is a stamp, so that |e| is smooth between stamps
    exact = 4.0 * amplitude / omega
    # error of the trapezoidal rule: at most T h² max|f''|/12
    bound = 2.0 * 1e-6 * amplitude * omega**2 / 12.0
    assert absolute_integral(amplitude * np.sin(omega * time), trapezoid_weights(time)) == pytest.approx(
        exact, abs=bound
    )


@given(stamps)
def test_trapezoid_weights_add_up_to_the_duration(time):
    """Spread the duration over the stamps."""
    assert np.sum(trapezoid_weights(time)) == pytest.approx(time[-1] - time[0], rel=ROUNDING)


def test_fit_has_its_two_anchors():
    """Call the measurement itself 100 %, its mean 0 %, and its mirror image −100 %."""
    deviation = np.array([-1.0, 2.0, -3.0, 2.0])
    assert fit_percent(np.zeros(4), deviation) == 100.0
    assert fit_percent(-deviation, deviation) == 0.0
    assert fit_percent(-2.0 * deviation, deviation) == -100.0
    assert np.isnan(fit_percent(np.ones(4), np.zeros(4)))


def test_tube_counts_what_lies_outside():
    """Count stamps outside the tube; its edge belongs to it."""
    assert fraction_outside(np.array([0.0, -0.01, 0.01, 0.02, -0.03]), 0.01) == pytest.approx(2 / 5)


def test_unknown_and_excluded_positions_do_not_count():
    """Leave out blanks and outliers, and bridge them by the trapezoid between their neighbours."""
    run = RunComparison(
        time=np.array([0.0, 1.0, 2.0, 3.0, 5.0]),
        measured=np.array([0.0, np.nan, 9.0, 0.0, 0.0]),
        model=np.array([0.1, 7.0, 7.0, 0.3, 0.5]),
        use=np.array([True, True, False, True, True]),
    )
    assert run.error == pytest.approx([0.1, 0.3, 0.5], rel=ROUNDING)
    # (0.1 + 0.3)/2 · 3 s + (0.3 + 0.5)/2 · 2 s
    assert absolute_integral(run.error, trapezoid_weights(run.time[run.valid])) == pytest.approx(1.4, rel=ROUNDING)


def test_velocity_counts_only_where_both_are_known():
    """Compare velocities at valid stamps that have an estimate, and nowhere without one."""
    time = np.arange(4.0)
    run = RunComparison(
        time=time,
        measured=np.array([0.0, np.nan, 0.0, 0.0]),
        model=np.zeros(4),
        measured_velocity=np.array([1.0, 1.0, np.nan, 1.0]),
        model_velocity=np.full(4, 1.5),
    )
    assert run.velocity_error == pytest.approx([0.5, 0.5])
    assert RunComparison(time=time, measured=np.zeros(4), model=np.zeros(4)).velocity_error.size == 0


def test_nothing_measured_is_told_to_the_user():
    """Name the times between which no position is known."""
    with pytest.raises(InputError, match=r"between t = 2 s and 3 s"):
        RunComparison(time=np.array([2.0, 3.0]), measured=np.full(2, np.nan), model=np.zeros(2))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model": np.zeros(2)}, "model has shape"),
        ({"time": np.array([0.0, 1.0, 1.0])}, "strictly increasing"),
        ({"uncertainty": np.array([1.0, 0.0, 1.0])}, "uncertainty must be positive"),
    ],
)
def test_misuse_is_refused(changes, message):
    """Refuse arrays of different shapes."""
    arrays = {"time": np.arange(3.0), "measured": np.zeros(3), "model": np.zeros(3)} | changes
    with pytest.raises(ValueError, match=message):
        RunComparison(**arrays)
