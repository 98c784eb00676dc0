"""How sure a better prediction is follows from the windows that both predict."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from harness.metrics.bootstrap import Margin, rms_reduction

ERRORS = 0.01 * norm.ppf((np.arange(100) + 0.5) / 100)  # as normal errors fall, without their chance


def test_reduction_is_the_difference_of_the_rms() -> None:
    """State by how much the RMS falls, positive where the second prediction is better."""
    before, after = np.array([0.03, 0.04]), np.array([0.01, 0.07])
    expected = np.sqrt((0.03**2 + 0.04**2) / 2.0) - np.sqrt((0.01**2 + 0.07**2) / 2.0)
    assert rms_reduction(before, after).value == pytest.approx(expected, rel=1e-12)
    assert rms_reduction(after, before).value == pytest.approx(-expected, rel=1e-12)


@pytest.mark.parametrize(("after", "sure"), [(0.02, True), (0.03, False), (0.04, False)])
def test_windows_that_all_agree_leave_no_doubt(after: float, sure: bool) -> None:
    """Give an interval of no width where every window says the same, sure only if the error falls."""
    found = rms_reduction(np.full(9, 0.03), np.full(9, after))
    assert (found.low, found.high) == pytest.approx((0.03 - after, 0.03 - after), abs=1e-15)
    assert found.sure is sure


def test_interval_has_the_width_that_normal_errors_give_it() -> None:
    """Leave out the chance on both sides: ± z σ/√(2 n) for the RMS of n normal errors against none at all."""
    for chance in (0.05, 0.32):
        found = rms_reduction(ERRORS, np.zeros(100), chance)
        half = norm.ppf(1.0 - chance / 2.0) * np.std(ERRORS**2) / np.sqrt(100.0) / (2.0 * 0.01)
        # σ of the mean square over 2 RMS; the RMS is 1 % less than 0.01, the root bends it by 2 %, quantiles err by 2 %
        assert found.high - found.low == pytest.approx(2.0 * half, rel=0.05)
        assert found.low < found.value < found.high
    assert rms_reduction(ERRORS, np.zeros(100)) == rms_reduction(ERRORS, np.zeros(100), 0.05)


def test_windows_are_compared_in_pairs() -> None:
    """Be sure of a tenth where every window falls by that, however much the windows differ among themselves."""
    found = rms_reduction(ERRORS, 0.9 * ERRORS)
    whole = rms_reduction(ERRORS, np.zeros(100))
    assert found.sure
    assert (found.low, found.high) == pytest.approx((0.1 * whole.low, 0.1 * whole.high), rel=1e-9)


def test_a_margin_that_begins_at_zero_is_not_sure() -> None:
    """Ask for more than nothing."""
    assert not Margin(0.01, 0.0, 0.02).sure
