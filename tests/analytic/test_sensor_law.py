"""What a position sensor makes of a position, and what it says of one."""

from __future__ import annotations

import warnings

import numpy as np

from analytic.effects.sensor_law import SensorLaw


def test_a_ball_lies_where_its_reading_says() -> None:
    """Invert a gain with a curve wherever the curve rises by a tenth or more."""
    law = SensorLaw(gain=1.02, square=-0.3, cube=0.2)
    where = np.linspace(-0.2, 0.6, 9)
    np.testing.assert_allclose(law.position(law.curve(where)), where, atol=1e-12)


def test_a_reading_that_no_ball_has_is_taken_for_its_position() -> None:
    """Be finite where a curve turns round at 0.305 m, before it reaches 0.331 m: no innovation is NaN."""
    law = SensorLaw(square=-0.447, cube=-0.666)
    assert float(np.max(law.curve(np.linspace(0.0, 1.0, 1001)))) < 0.31
    np.testing.assert_array_equal(law.position(np.array([0.331])), [0.331])


def test_a_ball_that_left_every_beam_warns_of_nothing() -> None:
    """Read of a run that diverged, as a fit tries and rejects them, without a warning on the user's terminal."""
    with warnings.catch_warnings(action="error"):
        assert SensorLaw(cube=0.3).curve(np.array([1e200]))[0] == np.inf
