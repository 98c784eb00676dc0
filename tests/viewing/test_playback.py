import math

import numpy as np
import pytest

from analytic.geometry import to_beam
from analytic.rig import Rig
from harness.viewing.film import lines_of
from harness.viewing.playback import BEYOND, centre_of, turned_by
from tests.viewing.shown import ANGLE, TIME, made


def test_balls_are_where_run_and_recording_have_them() -> None:
    """Interpolate both between the stamps, and give their difference."""
    now = made().at(0, 0.55)
    # Both are linear in time: only rounding is left.
    assert now.position == pytest.approx(0.1 + 0.3 * 0.55, abs=1e-12)
    assert now.recorded == pytest.approx(0.5 - 0.3 * 0.55, abs=1e-12)
    assert now.error == pytest.approx(-0.4 + 0.6 * 0.55, abs=1e-12)
    assert now.angle == pytest.approx(ANGLE, abs=1e-12)
    assert now.spin == pytest.approx(0.3 * 0.55 / Rig().rolling_radius + ANGLE, abs=1e-10)


def test_the_recorded_ball_is_not_known_in_a_gap() -> None:
    """Draw no ghost between readings that are half a second apart."""
    reading = np.where((TIME > 0.25) & (TIME < 0.75), np.nan, 0.3)
    playback = made(reading=reading)
    assert math.isnan(playback.at(0, 0.5).recorded)
    assert playback.at(0, 0.1).recorded == 0.3
    assert playback.at(0, 0.95).recorded == 0.3


def test_a_run_that_ended_by_a_lift_off_says_so() -> None:
    """Show no ball after the run, and write when it lifted off."""
    playback = made(lifted_off=0.62, rolls_until=0.6)
    now = playback.at(0, 0.8)
    assert math.isnan(now.position)
    lines = [text for text, _ in lines_of(playback, 0, now, 1.0)]
    assert "mujoco lifted off the beam at 0.62 s" in lines
    assert any("error not known" in text for text in lines)


def test_what_is_written_names_simulated_data_so() -> None:
    """Write time, angle, positions and error, and that all of it is simulated."""
    playback = made()
    lines = [text for text, _ in lines_of(playback, 0, playback.at(0, 0.5), 0.5)]
    assert lines == [
        "mujoco, simulated made up    shown at 0.5 × real time",
        "t =   0.50 s    beam angle  +2.86°    error -100.0 mm",
        "mujoco 250.0 mm",
        "recorded (simulated) 350.0 mm",
    ]


def test_the_beam_is_as_long_as_the_recorded_ball_needs() -> None:
    """Draw it from the pivot to beyond the farthest reading."""
    playback = made()
    assert playback.channel.x_from == -BEYOND
    assert playback.channel.x_to == pytest.approx(0.5 + BEYOND)
    assert not playback.beyond(playback.at(0, 1.0))


def test_a_ball_off_the_drawn_beam_is_told() -> None:
    """Say that the engine's ball is beyond the end."""
    playback = made(reading=np.full(len(TIME), 0.2))
    now = playback.at(0, 1.0)
    assert playback.beyond(now)
    assert "mujoco 400.0 mm, beyond the drawn beam" in [text for text, _ in lines_of(playback, 0, now, 1.0)]


def test_the_ball_stands_on_the_edges() -> None:
    """Put its centre at h + r above the beam's axis, at its position."""
    along, across, normal = to_beam(*centre_of(Rig(), 0.31, ANGLE), ANGLE)
    assert (along, across, normal) == pytest.approx((0.31, 0.0, Rig().eccentricity + Rig().rolling_radius), abs=1e-15)


def test_a_quarter_turn_takes_z_to_x() -> None:
    """Turn about +y, as a ball that rolls towards +x does."""
    w, x, y, z = turned_by(0.5 * math.pi)
    # Rotation of e_z by a unit quaternion: (2 (x z + w y), 2 (y z − w x), 1 − 2 (x² + y²))
    turned = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    assert turned == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)
