"""What names of columns say."""

from __future__ import annotations

import math

import pytest

from harness.importing.words import factor_of, is_unit, read_name


@pytest.mark.parametrize(
    ("name", "kind", "unit"),
    [
        ("time_s", "time", "s"),
        ("Zeit (ms)", "time", "ms"),
        ("temps [s]", "time", "s"),
        ("t", "time", ""),
        ("X", "position", ""),
        ("Angle (deg)", "angle", "deg"),
        ("Winkel in Grad", "angle", "Grad"),
        ("beamAngle", "angle", ""),
        ("Inclinaison [°]", "angle", "°"),
        ("beam_angle_mrad", "angle", "mrad"),
        ("Distance [cm]", "position", "cm"),
        ("Abstand / mm", "position", "mm"),
        ("ball position (in)", "position", "in"),
        ("Kugel", "position", ""),
        ("theta_deg", "shaft", "deg"),
        ("servo angle", "shaft", ""),
        ("Encoder 1", "shaft", ""),
        ("ball velocity [m/s]", "velocity", "m/s"),
        ("angle setpoint (deg)", "setpoint", "deg"),
        ("Sollwinkel", "setpoint", ""),
        ("position[0]", "position", ""),
        ("temperature", None, ""),
        ("CH1", None, ""),
        ("Channel A (V)", None, "V"),
        ("Position (in) Run #1", "position", "in"),
        ("Angle (deg) (filtered)", "angle", "deg"),
        ("theta_deg (2)", "shaft", "deg"),
        ("t (s) Run #1", "time", "s"),
        ("t (s) (2)", "time", "s"),
        ("ball.x", "position", ""),
        ("x in cm", "position", "cm"),
        ("mag_x", None, ""),
        ("F_s", None, ""),
        ("θ_r", None, ""),
        ("r", None, ""),
        ("Sonar (s)", None, "s"),
    ],
)
def test_a_name_says_quantity_and_unit(name: str, kind: str | None, unit: str) -> None:
    """Tell what a name in any of the known languages means, and its unit."""
    made = read_name(name)
    assert (made.kind, made.unit) == (kind, unit)


@pytest.mark.parametrize(
    ("role", "unit", "factor"),
    [
        ("angle", "°", math.pi / 180),
        ("angle", "Grad", math.pi / 180),
        ("position", "inch", 0.0254),
        ("time", "µs", 1e-6),
        ("time", "hours", 3600.0),
        ("time", "weeks", 604800.0),
    ],
)
def test_units_have_factors(role: str, unit: str, factor: float) -> None:
    """Convert units that recordings of the project itself may not have."""
    assert factor_of(role, unit) == pytest.approx(factor, rel=1e-15)  # type: ignore[arg-type]


def test_a_voltage_is_a_unit_but_of_nothing_here() -> None:
    """Know volts as a unit, and as none of the angle or the position."""
    assert is_unit("Volt")
    assert factor_of("angle", "V") is None
    assert factor_of("position", "V") is None
