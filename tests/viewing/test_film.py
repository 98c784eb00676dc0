from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image

from analytic.quintic import QuinticMotion
from harness.errors import InputError
from harness.viewing.drawing import FOVY, Drawing
from harness.viewing.film import HEIGHT, MOST_FRAMES, WIDTH, check_target, times_of, write_film
from harness.viewing.offscreen import kind_of_context, offscreen
from harness.viewing.playback import centre_of
from tests.viewing.shown import blue, column_of, made, middle_of, need_opengl, orange

# Each end of a ball may be off by a pixel, as edges are smoothed.
PIXEL = 1.0


@pytest.mark.slow
@pytest.mark.parametrize("time", [0.0, 0.3, 1.0])
def test_both_balls_are_drawn_where_they_are(time: float) -> None:
    """Find engine's ball and ghost in the columns in which a pinhole camera sees them."""
    need_opengl()
    drawing = Drawing(made())
    camera = mujoco.MjvCamera()
    drawing.aim(camera, WIDTH / HEIGHT)
    with offscreen(drawing, WIDTH, HEIGHT) as renderer:
        now = drawing.place(0, time)
        picture = renderer.picture()
    assert picture.shape == (HEIGHT, WIDTH, 3)
    rig = drawing.playback.runs[0].rig
    for position, mask in ((now.position, orange(picture)), (now.recorded, blue(picture))):
        column = column_of(centre_of(rig, position, now.angle), camera, FOVY, WIDTH, HEIGHT)
        assert middle_of(mask) == pytest.approx(column, abs=PIXEL)


def test_a_ball_that_is_not_known_is_not_drawn() -> None:
    """Leave the engine's ball out after its run has ended, and keep the ghost."""
    need_opengl()
    drawing = Drawing(made(lifted_off=0.62, rolls_until=0.6))
    with offscreen(drawing, WIDTH, HEIGHT) as renderer:
        drawing.place(0, 0.8)
        picture = renderer.picture()
    assert not orange(picture).any()
    assert blue(picture).any()


@pytest.mark.slow
@pytest.mark.parametrize("angle", [-0.1, 0.03, 0.1])
def test_no_wall_shades_itself(angle: float) -> None:
    """Draw the beam without dashes of shadow on it, away from where the balls shade it."""
    need_opengl()
    playback = made()
    motion = QuinticMotion(np.array([0.0, 1.0]), np.array([[angle, 0.0, 0.0]] * 2))
    playback = replace(playback, runs=(replace(playback.runs[0], motion=motion),))
    pictures = []
    for shadows in (True, False):
        drawing = Drawing(playback)
        drawing.model.light_castshadow[:] &= shadows
        with offscreen(drawing, WIDTH, HEIGHT) as renderer:
            drawing.place(0, 0.3)
            pictures.append(renderer.picture().astype(int))
    shaded, plain = pictures
    wall = (plain[..., 2] - plain[..., 0] > 6) & (plain[..., 1] > 160)  # bluish and bright: nothing else is
    balls = np.flatnonzero((orange(plain.astype(np.uint8)) | blue(plain.astype(np.uint8))).sum(axis=0) >= 3)
    near = np.abs(np.arange(WIDTH)[:, None] - balls).min(axis=1) < 30
    dark = (plain - shaded).max(axis=-1) > 20
    assert wall.sum() > 20_000
    assert (wall & dark)[:, ~near].sum() < 40  # single pixels at corners; dashes are hundreds


def test_the_stand_hides_no_ball() -> None:
    """Show a ball above a pivot that is level with the edges as high as one beside the stand."""
    need_opengl()
    playback = made()
    rig = replace(playback.runs[0].rig, eccentricity=0.0)
    run = replace(playback.runs[0], rig=rig, position=playback.runs[0].position - 0.1)  # begins at the pivot
    drawing = Drawing(replace(playback, runs=(run,)))
    with offscreen(drawing, WIDTH, HEIGHT) as renderer:
        heights = []
        for time in (0.0, 1.0):
            drawing.place(0, time)
            heights.append(int((orange(renderer.picture()).sum(axis=1) >= 3).sum()))
    assert heights[0] == pytest.approx(heights[1], abs=2 * PIXEL)


def test_an_animated_picture_has_every_frame(tmp_path: Path) -> None:
    """Write a GIF of 25 frames a second with the ball in its colour."""
    need_opengl()
    playback, file = made(), tmp_path / "clip.gif"
    write_film(playback, file, [0.0, 0.5, 1.0], speed=1.0, rate=25)
    with Image.open(file) as made_picture:
        assert (made_picture.n_frames, made_picture.size) == (3, (WIDTH, HEIGHT))
        assert made_picture.info["duration"] == 40
        made_picture.seek(2)
        assert orange(np.asarray(made_picture.convert("RGB"))[150:]).sum() > 100


def test_frames_are_as_far_apart_as_the_speed_says() -> None:
    """Take one frame each 1/30 s of the user's time, the last not after the end."""
    assert times_of(made(), 1.0, 30) == pytest.approx(np.arange(31) / 30)
    assert times_of(made(), 0.5, 30) == pytest.approx(np.arange(61) / 60)
    assert times_of(made(), 0.7, 30)[-1] <= 1.0


def test_a_video_without_end_is_refused() -> None:
    """Name the options that make it shorter."""
    with pytest.raises(InputError, match=rf"more than {MOST_FRAMES}.*--speed.*--from"):
        times_of(made(), 1e-4, 30)


def test_other_kinds_of_files_are_refused() -> None:
    """Name those that can be written."""
    with pytest.raises(InputError, match=r"\.mp4 or \.gif"):
        check_target(Path("clip.avi"))


def test_where_no_opengl_works_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuse a kind that needs a display where there is none."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    kind_of_context.cache_clear()
    try:
        with pytest.raises(InputError, match="install libegl1 and libgl1-mesa-dri, or libosmesa6"):
            kind_of_context()
    finally:
        kind_of_context.cache_clear()
