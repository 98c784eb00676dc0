"""The ball's acceleration against g α: whatever the size of the numbers that hold angle and position."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from harness.recording.tilt_response import tilt_response

STEP, K = 0.01, 0.66
TIME = STEP * np.arange(800)
ANGLE = 0.05 * np.sin(2.0 * TIME) + 0.03 * np.sin(5.0 * TIME)
PATH = -K * 9.81 * (0.05 * np.sin(2.0 * TIME) / 4.0 + 0.03 * np.sin(5.0 * TIME) / 25.0)
POSITION = 0.3 + PATH + 1e-4 * np.random.default_rng(0).standard_normal(len(TIME))


@pytest.mark.parametrize("power", [-600, -1, 1, 600, 900])
def test_another_unit_changes_the_slope_alone(power: int) -> None:
    """Scale the slope by a power of two to the bit, where squares are beyond a float too, without a warning."""
    plain = tilt_response(STEP, ANGLE, POSITION)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        other = tilt_response(STEP, np.ldexp(ANGLE, power), POSITION)
    assert plain is not None
    assert other is not None
    assert plain.slope == pytest.approx(K, rel=0.01)  # noise of 0.1 mm on a path of 80 mm
    assert other.slope == np.ldexp(plain.slope, -power)
    assert (other.correlation, other.t_value) == (plain.correlation, plain.t_value)


def test_what_is_beyond_a_float_says_nothing() -> None:
    """Give no response, and no warning, where g α is infinite."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert tilt_response(STEP, 1e200 * ANGLE, POSITION, gravity=1e200) is None


def test_a_slope_beyond_a_float_is_infinite() -> None:
    """Give an infinite slope, without a warning, where the position's numbers are too large for the angle's."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        response = tilt_response(STEP, np.ldexp(ANGLE, -600), np.ldexp(POSITION, 600))
    assert response is not None
    assert response.slope == np.inf
