"""Units, signs, linkage and rates, from what the file says or from the data."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing import Ambiguity, Group, Options, Signal, SourceFile, Understood, understand
from harness.importing.words import UNITS
from tests.importing import made

NAMES = ("t", "angle", "x")


def source(*columns: tuple[str, FloatArray], step: float | None = None) -> SourceFile:
    """A file with these columns, already read."""
    signals = tuple(Signal(name, values) for name, values in columns)
    rows = np.arange(1, len(signals[0].values) + 1)
    return SourceFile(Path("log.csv"), "0" * 64, "text", (Group("", signals, rows, step=step, step_from="dt"),))


def in_units(time: str, angle: str, position: str, *, sign: float = 1.0) -> SourceFile:
    """The recording in units that nobody wrote down."""
    t, a, s = made.truth()
    factors = UNITS["time"][time], UNITS["angle"][angle], UNITS["position"][position]
    columns = (t / factors[0], sign * a / factors[1], s / factors[2])
    return source(*zip(NAMES, columns, strict=True))


def agrees(understood: Understood) -> None:
    """Compare with the recording; conversions round in the last digits only."""
    for found, true in zip((understood.time, understood.angle, understood.position), made.truth(), strict=True):
        np.testing.assert_allclose(found, true, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    "units", list(itertools.product(("s", "ms", "us", "ns"), ("rad", "deg"), ("m", "cm", "mm", "in"))), ids="-".join
)
def test_units_that_are_not_written(units: tuple[str, str, str]) -> None:
    """Find every combination of units from size and acceleration, and say that they were not written."""
    understood = understand([in_units(*units)], Options())
    agrees(understood)
    assert tuple(line.unit for line in understood.lines) == units
    assert all("not written" in line.unit_from for line in understood.lines)


def test_units_that_the_data_leave_open_are_asked_for() -> None:
    """Ask where the ball does not move by the angle, so that only size is left."""
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 10.0, 0.01)
    position = 50.0 + 20.0 * np.cumsum(rng.normal(size=len(time))) / np.sqrt(len(time))
    file = source(("time_s", time), ("angle_rad", 0.03 * np.sin(3.0 * time)), ("x", position))
    with pytest.raises(Ambiguity) as caught:
        understand([file], Options())
    assert {one.typed for one in caught.value.choices} == {f"--position 'x:{unit}'" for unit in ("cm", "mm", "in")}


def test_counts_are_not_degrees() -> None:
    """Ask about whole numbers, and about an angle with which no ball would accelerate as the data say."""
    time, angle, position = made.truth()
    counts = np.round(np.degrees(angle) * 1024.0 / 360.0)
    with pytest.raises(Ambiguity, match=r"'angle' .* holds whole numbers, which may be the counts") as caught:
        understand([source(("t", time), ("angle", counts), ("x_cm", 2.54 * position * 100.0))], Options())
    assert "--angle 'angle:0.088 deg/count+0.5'" in caught.value.advice
    with pytest.raises(Ambiguity, match=r"'angle' .* accelerates by 0\.23 g α, where a ball does by 0\.4 to 0\.8"):
        understand([source(("t_s", time), ("angle", np.degrees(angle) * 1024.0 / 360.0), ("x_m", position))], Options())


@pytest.mark.parametrize("factor", [1e3, 2000.0])
def test_the_quantity_that_fits_nothing_is_named(factor: float) -> None:
    """Blame milliradians, and not the time, for what fits no unit."""
    time, angle, position = made.truth()
    with pytest.raises(Ambiguity, match=r"'angle' \(angle\) has no unit, and .* size of any of rad, deg"):
        understand([source(("t", time), ("angle", factor * angle), ("x", position))], Options())


def test_a_unit_that_only_size_would_tell_is_asked_for() -> None:
    """Ask for the unit of a position that does not follow the angle; take that of the time from its size."""
    time = np.arange(0.0, 10.0, 0.01)
    noise = np.random.default_rng(5).uniform(0.2, 0.4, len(time))
    file = source(("t", time), ("angle_rad", 0.03 * np.sin(3.0 * time)), ("x", noise))
    with pytest.raises(Ambiguity, match=r"'x' .* does not follow the angle clearly enough") as caught:
        understand([file], Options())
    assert [one.typed for one in caught.value.choices] == ["--position 'x:m'"]
    assert understand([file], Options(position="x:m")).lines[0].unit == "s"


@pytest.mark.parametrize("unit", ["%", "deg/s", "counts", "V"])
def test_a_suggested_calibration_is_understood(unit: str) -> None:
    """Suggest none that the option refuses."""
    time, angle, position = made.truth()
    file = source(("t_s", time), (f"tilt ({unit})", angle), ("x_m", position))
    with pytest.raises(Ambiguity, match=f"is in {re.escape(unit)}, which is no unit of the angle") as caught:
        understand([file], Options())
    (given,) = re.findall(r"--angle '([^']+)'", caught.value.advice)
    assert ("/" in given.split(":")[1]) == unit.isalpha()
    understand([file], Options(angle=given, keep_signs=True))


def test_the_origin_is_offered_with_the_sign() -> None:
    """Turn a distance from the other end, as the message says, into one from this end."""
    time, angle, position = made.truth()
    file = source(("t_s", time), ("angle_rad", angle), ("distance_cm", 100.0 * (1.0 - position)))
    with pytest.raises(Ambiguity, match="one sign is reversed") as caught:
        understand([file], Options())
    (given,) = re.findall(r"--position '([^']+)'", caught.value.advice)
    assert given == "distance_cm:-1 cm+100"
    agrees(understand([file], Options(position=given)))


def test_what_was_left_out_is_told_with_a_question() -> None:
    """Name the columns that were left out when the file was read where one is missed."""
    file = replace(source(("t_s", made.truth()[0]), ("y", made.truth()[1])), notes=("columns of words left out: tilt",))
    with pytest.raises(Ambiguity, match=r"no column is called .* Note: columns of words left out: tilt\."):
        understand([file], Options())


@pytest.mark.parametrize("every", [1, 4, 10, 25])
def test_the_sign_is_told_where_positions_come_slowly(every: int) -> None:
    """Ask about a reversed sign at any ratio of the rates."""
    time, angle, position = made.truth()
    slow = np.where(np.arange(len(time)) % every == 0, position, np.nan)
    with pytest.raises(Ambiguity, match=r"is -0\.6.* one sign is reversed"):
        understand([source(("time_s", time), ("angle_rad", -angle), ("x_m", slow))], Options())


def test_a_linkage_is_of_the_servos_angle() -> None:
    """Turn the servo's column, and not that of the beam, by the linkage."""
    time, angle, position = made.truth()
    crank = np.arcsin(np.sin(angle) * 0.4 / 0.05)
    file = source(("t_s", time), ("servo_rad", crank), ("angle_rad", angle), ("x_m", position))
    understood = understand([file], Options(linkage="r=0.05,L=0.4"))
    assert understood.lines[1].column == "servo_rad"
    np.testing.assert_allclose(understood.angle, angle, atol=1e-14)


@pytest.mark.parametrize("role", ["angle", "position"])
def test_the_time_is_nothing_else(role: str) -> None:
    """Refuse the column of the time as another quantity."""
    time, angle, position = made.truth()
    file = source(("t_s", time), ("angle_rad", angle), ("x_m", position))
    with pytest.raises(InputError, match=f"'t_s' is given as time and as {role}"):
        understand([file], Options(**{role: "1:deg" if role == "angle" else "t_s:m"}))


def test_a_letter_within_a_name_says_nothing() -> None:
    """Ask for the position where only `mag_x`, `F_s` and `r` could be it by a letter."""
    time, angle, position = made.truth()
    others = [(name, np.sin(time)) for name in ("mag_x", "F_s", "r (m)", "t (s) (2)")]
    file = source(("t (s)", time), ("pitch_rad", angle), *others, ("range (cm)", 100.0 * position))
    with pytest.raises(Ambiguity, match="no column is called the ball's position"):
        understand([file], Options(time="t (s)"))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sign_is_told_from_the_data(sign: float) -> None:
    """Confirm a sign that is right, and ask about one that is reversed."""
    file = in_units("s", "rad", "m", sign=sign)
    if sign > 0.0:
        understood = understand([file], Options())
        assert understood.sign_checked
        assert understood.sign.startswith("right: the ball's acceleration is +0.6")
        return
    with pytest.raises(Ambiguity, match=r"is -0\.6.* one sign is reversed") as caught:
        understand([file], Options())
    assert [one.typed for one in caught.value.choices] == ["--flip-angle", "--flip-position", "--keep-signs"]
    agrees(understand([file], Options(flip_angle=True)))


def test_a_sign_that_cannot_be_checked_is_said() -> None:
    """Say that the sign was not checked where the ball does not follow the angle."""
    time = np.arange(0.0, 10.0, 0.01)
    noise = np.random.default_rng(5).normal(0.3, 1e-3, len(time))
    file = source(("time_s", time), ("angle_rad", 0.03 * np.sin(3.0 * time)), ("x_m", noise))
    understood = understand([file], Options())
    assert not understood.sign_checked
    assert understood.sign.startswith("not checked")


@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_a_linkage_turns_a_crank_angle_into_the_beams(offset: float) -> None:
    """Compute α = asin(r sin(θ + offset) / L)."""
    time, angle, position = made.truth()
    crank = np.degrees(np.arcsin(np.sin(angle) * 0.4 / 0.05)) - offset
    file = source(("time_s", time), ("theta_deg", crank), ("x_m", position))
    agrees_to = understand([file], Options(linkage=f"r=0.05,L=40cm,offset={offset}deg")).angle
    # asin(0.4/0.05 sin α) reaches 0.4 rad, where it amplifies rounding by less than 10.
    np.testing.assert_allclose(agrees_to, angle, atol=1e-14)


def test_the_rate_comes_from_stamps_file_or_user() -> None:
    """Take stamps first, then the file's own interval, then --rate, and ask where there is none of them."""
    time, angle, position = made.truth()
    columns = (("angle_rad", angle), ("x_m", position))
    assert "100 Hz from the stamps" in understand([source(("t_s", time), *columns)], Options()).rate
    assert "100 Hz from 'dt' in the file" in understand([source(*columns, step=0.01)], Options()).rate
    agrees(understand([source(*columns)], Options(rate=100.0)))
    with pytest.raises(Ambiguity, match="--rate 100"):
        understand([source(*columns)], Options())


def test_two_columns_of_one_name_are_asked_about() -> None:
    """Ask which of two positions is meant, with the range of each."""
    time, angle, position = made.truth()
    file = source(("t_s", time), ("angle_rad", angle), ("position_m", position), ("distance_m", position + 0.1))
    with pytest.raises(Ambiguity, match="2 columns may be the ball's position") as caught:
        understand([file], Options())
    chosen = caught.value.choices[0]
    assert chosen.typed == "--position 'position_m'"
    agrees(understand([file], Options(position=chosen.options["position"])))


def test_what_is_unclear_is_asked_together() -> None:
    """Ask for both columns, the time and the unit of a chosen column in one message, and for one of them at a time."""
    time, angle, position = made.truth()
    file = source(("CH1", angle), ("CH2", position), ("CH3", time))
    with pytest.raises(
        Ambiguity, match=r"the beam's angle.*Besides, no .*ball's position.*Besides, .*--rate"
    ) as caught:
        understand([file], Options())
    assert [one.typed for one in caught.value.choices] == ["--angle 'CH1'", "--angle 'CH2'", "--angle 'CH3'"]
    with pytest.raises(Ambiguity, match=r"ball's position.*Besides, 'CH1' is an input of an oscilloscope, in V"):
        understand([file], Options(time="CH3:s", angle="CH1"))


def test_a_recording_without_positions() -> None:
    """Import an angle alone if the user says so."""
    time, angle, _ = made.truth()
    file = source(("t_s", time), ("angle_rad", angle))
    with pytest.raises(InputError, match="ball's position"):
        understand([file], Options())
    understood = understand([file], Options(position="none"))
    assert np.isnan(understood.position).all()


@pytest.mark.parametrize(
    ("text", "reading", "value"),
    [
        ("x:0.125 m/V+0.01", 2.0, 0.26),
        ("x:12.5 cm/V - 1.5 cm", 2.0, 0.235),
        ("x:cm+3", 2.0, 0.05),
        ("x:-0.5mm", 2.0, -0.001),
        ("x:1e-1 m / V", 2.0, 0.2),
    ],
)
def test_calibrations(text: str, reading: float, value: float) -> None:
    """Read gain and offset in the unit of the quantity."""
    time, angle, _ = made.truth()
    file = source(("t_s", time), ("angle_rad", angle), ("x", np.full(len(time), reading)))
    np.testing.assert_allclose(understand([file], Options(position=text)).position, value, rtol=1e-12)


def test_times_that_fall_are_refused_with_their_row() -> None:
    """Name the row in which the time goes back."""
    time, angle, position = (one.copy() for one in made.truth())
    time[700] = 1.0
    with pytest.raises(InputError, match="row 701, column 't_s': time decreases"):
        understand([source(("t_s", time), ("angle_rad", angle), ("x_m", position))], Options())


def test_the_steps_of_the_sensors_are_estimated() -> None:
    """Find the rounding of both readings of the simulated recording."""
    understood = understand([in_units("s", "rad", "m")], Options())
    assert understood.angle_resolution == pytest.approx(2.0 * np.pi / 40_000, rel=1e-3)
    assert understood.position_resolution == pytest.approx(1e-4, rel=1e-3)
