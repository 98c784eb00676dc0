import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.geometry import channel_of
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from harness.comparison import Choices, prepare
from harness.comparison.setting import Setting
from harness.engines.catalogue import engine_of
from harness.errors import InputError
from harness.recording import load_case
from harness.viewing.playback import Playback
from harness.viewing.rerun_log import boxes_of, check_log_target, write_log
from harness.viewing.runs import run_without
from harness.viewing.told import Told
from tests.acceptance.short import write_short_case
from tests.viewing.logged import Logged

# Geometry is kept in 32 bits: half a unit in the last of 24 places of numbers below 1, thrice for what is computed.
SINGLE = 3 * 2.0**-24
STAMP = 1e-9  # Rerun counts time in nanoseconds


@pytest.fixture
def setting(tmp_path: Path) -> Setting:
    """A short recording of which the 41st to 60th positions are not known."""
    case = write_short_case(tmp_path / "case")
    file = case / "rec_01.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    blank = [line if not 41 <= n <= 60 else line.rsplit(",", 1)[0] + "," for n, line in enumerate(lines)]
    file.write_text("\n".join(blank) + "\n", encoding="utf-8")
    return prepare(load_case(case), Choices(recording="rec_01.csv"))


def playback_of(setting: Setting, *, begin: float, end: float, runs: int = 1) -> Playback:
    """The run of MuJoCo, and a second one with another beam and other positions that ends early."""
    first = run_without(setting, engine_of("mujoco"), {})
    beam = QuinticMotion(np.array([0.0, 5.0]), np.array([[0.02, 0.0, 0.0]] * 2))
    part = slice(10, len(first.time) // 2)
    second = replace(
        first, motion=beam, time=first.time[part], position=first.position[part] + 0.01, rolled=first.rolled[part]
    )
    known = setting.ball.trusted
    stamps, reading = setting.time[known], setting.recording.position[known]
    return Playback("mujoco", (first, second)[:runs], stamps, reading, begin, end, setting.case.simulated)


def test_measured_ball_and_beam_are_those_of_the_recording(setting: Setting, tmp_path: Path) -> None:
    """Log every stamp: the ball where it was recorded, none where it was not, the beam at the drive's angle."""
    pytest.importorskip("rerun")
    file = tmp_path / "log.rrd"
    recording = setting.recording
    count = write_log(setting, playback_of(setting, begin=0.0, end=float(setting.time[-1])), (), "", file)
    log = Logged(file)
    assert count == len(setting.time)
    name = "recorded_simulated" if setting.case.simulated else "measured"
    time, centres = log.ball(name)
    np.testing.assert_allclose(time, setting.time, rtol=0.0, atol=STAMP)
    known = np.isfinite(recording.position) & setting.ball.trusted
    assert 0 < known.sum() < len(known)
    np.testing.assert_array_equal(np.isfinite(centres[:, 0]), known)
    np.testing.assert_allclose(centres[known, 0], recording.position[known], rtol=0.0, atol=SINGLE)
    channel = channel_of(setting.rig)
    # In its frame the ball lies in the middle of the beam, at the height of rolling contact.
    np.testing.assert_allclose(centres[known, 1:], [[0.0, channel.ball_height]] * known.sum(), rtol=0.0, atol=SINGLE)
    time, angle = log.beam()
    np.testing.assert_allclose(angle, setting.drive.evaluate(setting.time), rtol=0.0, atol=SINGLE)

    # What is plotted is kept in 64 bits.
    np.testing.assert_array_equal(log.scalars(f"position_m/{name}")[1], recording.position[known])
    np.testing.assert_array_equal(log.scalars("beam_angle_deg/recorded")[1], np.degrees(recording.angle))
    smoothed = np.degrees(setting.drive.evaluate(setting.time))
    np.testing.assert_array_equal(log.scalars("beam_angle_deg/smoothed")[1], smoothed)


def test_each_run_is_an_entity_of_its_own(setting: Setting, tmp_path: Path) -> None:
    """Log the runs without and with effects under names of their own, in the part that is asked for."""
    pytest.importorskip("rerun")
    file, begin, end = tmp_path / "log.rrd", 0.2, 2.4
    playback = playback_of(setting, begin=begin, end=end, runs=2)
    write_log(setting, playback, (), "", file)
    log = Logged(file)
    shown = setting.time[(setting.time >= begin) & (setting.time <= end)]
    for run, kind in zip(playback.runs, ("without_effects_found", "with_effects_found"), strict=True):
        name = f"mujoco_simulated/{kind}"
        time, centres = log.ball(name)
        np.testing.assert_allclose(time, shown, rtol=0.0, atol=STAMP)
        use = (run.time >= begin) & (run.time <= end)
        rolling = np.isin(shown, run.time)
        np.testing.assert_array_equal(np.isfinite(centres[:, 0]), rolling)
        np.testing.assert_allclose(centres[rolling, 0], run.position[use], rtol=0.0, atol=SINGLE)
        time, position = log.scalars(f"position_m/{name}")
        np.testing.assert_array_equal(position, run.position[use])
        time, residual = log.scalars(f"residual_mm/{name}")
        stamps = np.searchsorted(setting.time, time + STAMP, side="right") - 1
        expected = np.interp(setting.time[stamps], run.time, run.position) - setting.recording.position[stamps]
        # Interpolated at its own stamps: rounding of numbers of 0.5 m, in millimetres.
        np.testing.assert_allclose(residual, 1e3 * expected, rtol=0.0, atol=1e-12)
        assert "simulated" in str(log.static(f"world/beam/{name}", "Ellipsoids3D:labels"))
    assert rolling.sum() < len(shown), "the second run was to end early"
    # Only the second run has a beam that is not the recorded one.
    assert "beam_angle_deg/mujoco_simulated/without_effects_found" not in log.entities
    _, angle = log.scalars("beam_angle_deg/mujoco_simulated/with_effects_found")
    np.testing.assert_allclose(angle, np.degrees(0.02), rtol=1e-12)


def test_outliers_are_points_of_their_own(setting: Setting, tmp_path: Path) -> None:
    """Draw no ball at a spike, and plot it beside the trusted readings."""
    pytest.importorskip("rerun")
    trusted = setting.ball.trusted.copy()
    trusted[70] = False
    spiked = replace(setting, ball=replace(setting.ball, trusted=trusted))
    file = tmp_path / "log.rrd"
    write_log(spiked, playback_of(spiked, begin=0.0, end=1.5), (), "", file)
    log = Logged(file)
    _, position = log.scalars("position_m/outliers")
    assert position.tolist() == [setting.recording.position[70]]
    assert np.isnan(log.ball("measured" if not setting.case.simulated else "recorded_simulated")[1][70, 0])


def test_events_are_at_their_times(setting: Setting, tmp_path: Path) -> None:
    """Write every line at its time with its level, and the whole in words once."""
    pytest.importorskip("rerun")
    file = tmp_path / "log.rrd"
    told = [Told(0.0, "begins"), Told(0.75, "lifts off", "WARN"), Told(1.25, "fails", "ERROR")]
    write_log(setting, playback_of(setting, begin=0.0, end=1.5), told, "all of it", file)
    log = Logged(file)
    assert log.events() == [(one.time, one.level, one.text) for one in told]
    assert log.static("about", "TextDocument:text") == "all of it"


@pytest.mark.parametrize("gap", [0.6, 0.001])
def test_the_channel_is_that_of_the_scene(gap: float) -> None:
    """Let the boxes touch, with the ball's edges or its plane at their height, in a groove and on a flat rail."""
    channel = channel_of(Rig(rolling_radius=Rig().radius * float(np.sqrt(1.0 - gap**2))))
    assert channel.flat == (gap == 0.001)
    centres, halves = boxes_of(channel)
    low, high = centres - halves, centres + halves
    np.testing.assert_allclose([low[:, 0], high[:, 0]], [[channel.x_from] * 3, [channel.x_to] * 3], atol=1e-15)
    assert low[0, 1] == pytest.approx(channel.half_width)
    assert high[1, 1] == pytest.approx(-channel.half_width)
    assert high[:2, 2] == pytest.approx(channel.wall_top)
    assert high[2, 2] == pytest.approx(channel.floor_top)
    assert low[:2, 2] == pytest.approx(channel.floor_top)
    assert (low[2, 1], high[2, 1]) == pytest.approx((low[1, 1], high[0, 1]))


def test_other_kinds_of_files_are_no_logs() -> None:
    """Name the kind that can be written."""
    with pytest.raises(InputError, match=r"written as \.rrd"):
        check_log_target(Path("log.mcap"))


def test_without_the_package_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Say the line that installs it."""
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(InputError, match=r"pip install 'rerun-sdk>=0.41,<0.42'"):
        check_log_target(Path("log.rrd"))


def test_a_log_that_is_turned_off_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Name the variable by which Rerun would log nothing."""
    pytest.importorskip("rerun")
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(InputError, match="RERUN"):
        check_log_target(Path("log.rrd"))
