"""The windows of `harness view` on a screen without a monitor: what is in them, their keys, how they are closed."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np
import psutil
import pybullet
import pytest
from numpy.typing import NDArray

from harness.api.saved import load_diagnosis
from harness.comparison import Choices, prepare
from harness.engines.catalogue import engine_of
from harness.recording import load_case
from harness.viewing.drawing import FOVY, Drawing
from harness.viewing.playback import Playback, centre_of
from harness.viewing.pybullet_window import _DISTANCE, _PITCH, _YAW
from harness.viewing.runs import run_with, run_without
from tests.acceptance.short import write_short_case
from tests.comparison.made import KNOWN
from tests.viewing.screen import PATIENCE, Screen, screen, within_patience
from tests.viewing.shown import column_of, middle_of, orange

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"
ENGINES = ("mujoco", "pybullet")
TITLE = 130  # rows that may have words about the balls, and nothing else, at the top of MuJoCo's window [pixels]
STANDING = ("--from", "2.49", "--to", "2.5")  # at the end of so little, nothing moves and no text changes
PIXELS = 3.0  # edges are smoothed or not by the driver; a ball's outline is an ellipse, off its centre by a pixel
BULLETS_FOV = 90.0  # of the window of PyBullet, which has no setting for it [deg]
# By how much the ghost is more blue than red, 0 to 255: more than the stand, and than the background, which is 26.
BLUER = {"mujoco": 60, "pybullet": 40}
# A level error that is not there, so that the ball runs far from the recorded one without the effects of the diagnosis.
WRONG = {**KNOWN, "level_angle_rad": 0.01}


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A short case with a wrong level angle."""
    return write_short_case(tmp_path / "case", known=WRONG)


@contextmanager
def viewing(on: Screen, case: Path, engine: str, *options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The command with its window, which begins at the end of the recording and stands there."""
    command = [sys.executable, "-m", "harness", "view", str(case), "--engine", engine, "--effects", str(SEED)]
    process = subprocess.Popen(
        [*command, *options], env=on.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:

        def opened() -> str | None:
            assert process.poll() is None, process.communicate()
            return on.window()

        yield process, within_patience(opened, "opening the window")
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()


def playback_of(case: Path, engine: str, begin: float, end: float) -> Playback:
    """What the command shows."""
    setting, runs = prepare(load_case(case), Choices()), engine_of(engine)
    found = load_diagnosis(SEED)
    known = setting.ball.trusted
    shown = (
        run_without(setting, runs, {}, beside=True),
        run_with(setting, runs, {}, found.record.model, str(SEED)),
    )
    stamps, reading = setting.time[known], setting.recording.position[known]
    return Playback(engine, shown, stamps, reading, begin, end, setting.case.simulated)


def columns(playback: Playback, run: int, width: int, height: int) -> tuple[float, float]:
    """Columns in which the window of the engine has the run's ball and the recorded one at the end."""
    now = playback.at(run, playback.end)
    rig, channel = playback.runs[run].rig, playback.channel
    centres = [centre_of(rig, position, now.angle) for position in (now.position, now.recorded)]
    if playback.engine == "mujoco":
        camera = mujoco.MjvCamera()
        Drawing(playback).aim(camera, width / height)
        engine, recorded = (column_of(centre, camera, FOVY, width, height) for centre in centres)
        return engine, recorded
    target = (channel.centre, 0.0, channel.edge_height)
    view = pybullet.computeViewMatrixFromYawPitchRoll(target, _DISTANCE * channel.length, _YAW, _PITCH, 0.0, 2)
    projection = pybullet.computeProjectionMatrixFOV(BULLETS_FOV, width / height, 0.01, 100.0)
    to_screen = np.reshape(projection, (4, 4)).T @ np.reshape(view, (4, 4)).T
    x, _, _, w = to_screen @ np.column_stack((centres, [1.0, 1.0])).T
    engine, recorded = (0.5 * width * (1.0 + x / w) - 0.5).tolist()
    return engine, recorded


def ghost(picture: NDArray[np.uint8], engine: str) -> NDArray[np.bool_]:
    """Where a picture of the engine's window has the colour of the recorded ball."""
    red, _, blue = np.moveaxis(picture.astype(int), -1, 0)
    return blue - red > BLUER[engine]


def below_the_words(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The part of a picture where nothing is written in the colours of the balls."""
    return picture[TITLE:]


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_both_balls_are_seen_and_enter_switches_the_effects(case: Path, engine: str) -> None:
    """Find both balls in the columns of a camera, without the effects and, after enter, with them; close by a key."""
    begin, end = 2.49, 2.5
    playback = playback_of(case, engine, begin, end)
    apart = abs(playback.at(0, end).position - playback.at(0, end).recorded)
    assert apart > 4.0 * playback.channel.ball_radius, "the balls would hide each other"
    with (
        screen(1280, 960) as on,
        viewing(on, case, engine, "--from", str(begin), "--to", str(end)) as (process, window),
    ):
        height, width, _ = on.picture(window).shape
        without, recorded = columns(playback, 0, width, height)

        def seen(*, there: bool) -> NDArray[np.uint8] | None:
            """The picture once both balls are drawn, the orange one where the run without effects has it, or not."""
            picture = below_the_words(on.picture(window))
            balls = orange(picture), ghost(picture, engine)
            near = balls[0][:, int(without) - 5 : int(without) + 6].sum() > 50
            return picture if near == there and min(one.sum() for one in balls) > 50 else None

        within_patience(lambda: seen(there=False), "drawing the balls with the effects")
        on.press(window, "Return")
        picture = within_patience(lambda: seen(there=True), "switching the effects off")
        assert middle_of(orange(picture)) == pytest.approx(without, abs=PIXELS)
        assert middle_of(ghost(picture, engine)) == pytest.approx(recorded, abs=PIXELS)
        on.press(window, "Return")
        within_patience(lambda: seen(there=False), "switching the effects on")
        on.press(window, "ctrl+q" if engine == "mujoco" else "Escape")
        out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    assert f"{engine}, simulated, beside the measured ball" in out


@contextmanager
def standing(case: Path, engine: str) -> Iterator[tuple[Screen, subprocess.Popen[str], str]]:
    """The window once it stands at the end of a run and the recorded ball is drawn."""
    with screen(1280, 720) as on, viewing(on, case, engine, *STANDING) as (process, window):
        within_patience(
            lambda: True if ghost(on.picture(window), engine).sum() > 50 else None, "drawing the recorded ball"
        )
        yield on, process, window


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_the_window_managers_button_ends_the_command(case: Path, engine: str) -> None:
    """End with 0 and the errors of the runs where the window is closed by its button."""
    with standing(case, engine) as (on, process, window):
        on.close(window)
        out, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, err
        assert "RMS error [mm]" in out
        assert "broken" not in err
        within_patience(lambda: True if on.window() is None else None, "closing the window")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_terminated_command_takes_its_window_along(case: Path, engine: str) -> None:
    """End with 143 and leave no window."""
    with standing(case, engine) as (on, process, _):
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 143, err
        within_patience(lambda: True if on.window() is None else None, "closing the window")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_window_that_crashes_costs_no_result(case: Path, engine: str) -> None:
    """End with 0, the errors of the runs and a word of the crash where the window's process gets a segmentation fault.

    MuJoCo 4.0 gives it one now and then where its window is closed while a run is played.
    """
    with standing(case, engine) as (_, process, _):
        (window,) = psutil.Process(process.pid).children()
        window.send_signal(signal.SIGSEGV)
        out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    assert "crashed (Segmentation fault)" in " ".join(out.split())
    assert "RMS error [mm]" in out
