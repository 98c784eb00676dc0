"""Columns that are called alike: the same values in other units, flags, filtered copies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.importing import Ambiguity, Options, read_file, understand
from tests.importing import made


def put(file: Path, **columns: np.ndarray) -> Path:
    """A table of these columns, with six decimals."""
    rows = np.column_stack([*columns.values()])
    np.savetxt(file, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.6f")
    return file


def test_the_same_values_in_several_units(tmp_path: Path) -> None:
    """Take an angle that is there in rad and in deg, and times since 1970 and since the start, for one each."""
    t, alpha, s = made.truth()
    file = put(tmp_path / "a.csv", time=1.77e9 + t, time_rel=t, alpha=alpha, alpha_deg=np.degrees(alpha), x_cm=1e2 * s)
    made_of = understand([read_file(file)], Options())
    assert [line.column for line in made_of.lines] == ["time_rel", "alpha_deg", "x_cm"]
    np.testing.assert_allclose(made_of.angle, alpha, atol=2e-8)


def test_a_flag_is_no_position(tmp_path: Path) -> None:
    """Leave aside columns of two values, however they are called."""
    t, alpha, s = made.truth()
    fresh = np.arange(len(t)) % 2
    file = put(tmp_path / "a.csv", t_s=t, alpha_deg=np.degrees(alpha), pos_fresh=fresh, pos_held=0.0 * t, x_cm=1e2 * s)
    assert understand([read_file(file)], Options()).lines[2].column == "x_cm"


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (lambda s: np.convolve(s, np.full(9, 1 / 9), "same"), "2 columns may be the ball's position"),
        (lambda s: 1.02 * s, "2 columns may be the ball's position"),  # another calibration, no other unit
        (lambda s: s + 0.01, "2 columns may be the ball's position"),  # another zero
    ],
)
def test_a_copy_that_differs_is_asked_about(tmp_path: Path, other, told: str) -> None:
    """Ask which of two positions is meant where one is filtered, or counted or calibrated otherwise."""
    t, alpha, s = made.truth()
    file = put(tmp_path / "a.csv", t_s=t, alpha_deg=np.degrees(alpha), x_cm=1e2 * s, pos_cm=1e2 * other(s))
    with pytest.raises(Ambiguity, match=told):
        understand([read_file(file)], Options())


def test_two_angles_of_shafts(tmp_path: Path) -> None:
    """Offer the angles that may be the beam's, and no other column, where two turn."""
    t, alpha, s = made.truth()
    file = put(tmp_path / "a.csv", t_s=t, servo_deg=900.0 * alpha, theta_deg=np.degrees(alpha), x_cm=1e2 * s, dt=t * t)
    with pytest.raises(Ambiguity, match="'servo_deg', 'theta_deg' may be it, or that of the servo") as caught:
        understand([read_file(file)], Options())
    assert [one.typed for one in caught.value.choices] == ["--angle 'servo_deg'", "--angle 'theta_deg'"]


def test_a_position_in_pixels(tmp_path: Path) -> None:
    """Take the position that is in a unit of length, and not the one in pixels."""
    t, alpha, s = made.truth()
    file = put(
        tmp_path / "a.csv", **{"t_s": t, "alpha_deg": np.degrees(alpha), "X [pixel]": 2400.0 * s, "x [cm]": 1e2 * s}
    )
    assert understand([read_file(file)], Options()).lines[2].column == "x [cm]"
