"""`harness view` as a user runs it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import imageio_ffmpeg
import mujoco
import numpy as np
import pytest

from harness.comparison import Choices, prepare
from harness.comparison.sources import run_engine
from harness.engines.catalogue import engine_of
from harness.engines.health import Failure
from harness.errors import EngineFailure
from harness.identify.record import read_record
from harness.recording import load_case
from harness.viewing.drawing import AZIMUTH, ELEVATION, FOVY, Drawing
from harness.viewing.film import HEIGHT, WIDTH
from harness.viewing.playback import Playback, centre_of
from harness.viewing.runs import run_without
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case
from tests.viewing.logged import Logged
from tests.viewing.shown import blue, column_of, middle_of, need_opengl, orange

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"
TEXT = 110  # rows of a frame that may have dots in the colours of the balls [pixels]
# A pixel at each end of a ball, as edges are smoothed, and one more, as a video has half the columns of colour: 1.5 mm.
PIXELS = 2.0


def frames_of(file: Path) -> tuple[dict[str, object], np.ndarray]:
    """What a video says of itself, and its frames, shape (n, h, w, 3)."""
    reader = imageio_ffmpeg.read_frames(str(file))
    facts = next(reader)
    width, height = facts["size"]
    return facts, np.array([np.frombuffer(frame, np.uint8).reshape(height, width, 3) for frame in reader])


@pytest.mark.slow
def test_a_clip_of_the_bundled_recording_shows_both_balls_where_they_are(harness: Harness, tmp_path: Path) -> None:
    """Write 61 frames of two seconds, with both balls in the columns where run and recording have them."""
    need_opengl()
    file = tmp_path / "clip.mp4"
    done = harness("view", "paper_protocol", "--from", 2, "--to", 4, "--video", file, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert (told["frames"], told["frames_per_s"], told["video"]) == (61, 30, str(file))
    assert told["origin"].startswith("simulated")
    facts, frames = frames_of(file)
    assert frames.shape == (61, HEIGHT, WIDTH, 3)
    assert facts["fps"] == 30

    setting = prepare(load_case(Path("paper_protocol")), Choices())
    engine = engine_of("mujoco")
    whole = setting.horizons[0]
    run = run_engine(setting, engine, engine.parameters(), whole)
    known = setting.ball.trusted
    stamps, reading = setting.time[known], setting.recording.position[known]
    shown = run_without(setting, engine, {})
    drawing = Drawing(Playback("mujoco", (shown,), stamps, reading, 2.0, 4.0, True))
    camera = mujoco.MjvCamera()
    drawing.aim(camera, WIDTH / HEIGHT)
    assert (camera.azimuth, camera.elevation) == (AZIMUTH, ELEVATION)
    for number in (0, 60):
        time = 2.0 + number / 30
        angle = float(setting.motion.evaluate(np.array([time]))[0])
        balls = (
            (np.interp(time, setting.time[whole.stamps], run.position), orange),
            (np.interp(time, stamps, reading), blue),
        )
        for position, colour in balls:
            centre = centre_of(setting.rig, float(position), angle)
            column = column_of(centre, camera, FOVY, WIDTH, HEIGHT)
            assert middle_of(colour(frames[number, TEXT:])) == pytest.approx(column, abs=PIXELS)


def test_without_a_display_the_message_names_the_video(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    """End with 2 and say what to give instead."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    done = harness("view", "paper_protocol")
    assert done.code == 2
    assert done.errors == ["error: there is no display here: give --video out.mp4"]


def test_a_video_of_somebody_elses_stays(harness: Harness, tmp_path: Path) -> None:
    """Refuse to replace a file that the command did not write, before anything is computed."""
    file = tmp_path / "holiday.mp4"
    file.write_bytes(b"mine")
    done = harness("view", "paper_protocol", "--video", file)
    assert done.code == 2
    assert "--force" in done.err
    assert file.read_bytes() == b"mine"
    assert [one.name for one in tmp_path.iterdir() if one.name.startswith(".")] == []


@pytest.mark.slow
def test_its_own_video_is_replaced_and_the_answer_is_brief(harness: Harness, tmp_path: Path) -> None:
    """Write the same short clip twice, and print one line when asked to be quiet."""
    need_opengl()
    case, file = write_short_case(tmp_path / "case"), tmp_path / "clip.gif"
    for to in (0.6, 0.7):
        done = harness("view", case, "--engine", "pybullet", "--from", 0.5, "--to", to, "--video", file, "--quiet")
        assert done.code == 0, done.err
        assert done.err == ""
    assert done.out == f"video: {file} (6 frames, 0.2 s)\n"
    one = harness("view", case, "--engine", "pybullet", "--from", 0.5, "--to", 0.51, "--video", file, "--quiet")
    assert one.out == f"video: {file} (1 frame, 0.0 s)\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--video", "clip.avi"), ".mp4 or .gif"),
        (("--video", "clip.mp4", "--from", 5, "--to", 4), "there is nothing from 5 s to 4 s to show"),
        (("--video", "clip.mp4", "--recording", "rec_9.csv"), "there is no recording 'rec_9.csv'"),
        (("--video", "clip.mp4", "--engine", "havok"), "there is no engine 'havok'"),
        (("--video", "clip.mp4", "--effects", "a", "--effects", "b"), "more than one diagnosis"),
        (("--video", "clip.mp4", "--set", "pybullet.restitution=0"), "but mujoco runs"),
        (("--video", "clip.mp4", "--speed", "1e-6"), "give a higher --speed"),
        (("--rerun", "log.mcap"), "written as .rrd"),
        (("--rerun", "log.rrd", "--video", "clip.mp4"), "drop --video or --rerun"),
        (("--rerun", "log.rrd", "--speed", "2"), "drop --speed"),
    ],
)
def test_what_cannot_be_shown_is_refused(harness: Harness, options: tuple[object, ...], said: str) -> None:
    """End with 2 and one message, and leave nothing behind."""
    done = harness("view", "paper_protocol", *options)
    assert done.code == 2
    assert len(done.errors) == 1
    assert said in done.errors[0]
    assert list(done.folder.iterdir()) == []


def test_effects_of_another_rig_are_told(harness: Harness) -> None:
    """Warn where the diagnosis is of a rig with another ball, and not where it is of this one."""
    for case, other in (("open_ball_beam", True), ("paper_protocol", False)):
        done = harness("view", case, "--effects", SEED, "--video", "clip.mp4", "--from", 5, "--to", 4)
        assert done.code == 2
        assert (f"warning: {case}: is of another rig than the diagnosis (mass 0.03900 kg" in done.err) == other


def test_a_changed_diagnosis_is_told(harness: Harness, tmp_path: Path) -> None:
    """Warn of a diagnosis that was edited since `diagnose` wrote it, and only of that."""
    written, changed = tmp_path / "written.json", tmp_path / "changed.json"
    written.write_text(read_record(SEED).text(), encoding="utf-8")
    content = json.loads(written.read_text(encoding="utf-8"))
    content["model"]["band"] = 2.0
    changed.write_text(json.dumps(content), encoding="utf-8")
    for file in (written, changed):
        done = harness("view", "paper_protocol", "--effects", file, "--video", "clip.mp4", "--from", 5, "--to", 4)
        assert ("has been changed since `diagnose` wrote it" in done.err) == (file == changed)


@pytest.mark.slow
def test_a_log_of_nothing_is_refused(harness: Harness) -> None:
    """Name the times between which there is nothing, and write no file."""
    pytest.importorskip("rerun")
    done = harness("view", "paper_protocol", "--rerun", "log.rrd", "--from", 5, "--to", 4)
    assert done.code == 2
    assert "there is nothing from 5 s to 4 s to show" in done.errors[0]
    assert list(done.folder.iterdir()) == []


def test_times_are_plain_numbers(harness: Harness) -> None:
    """Refuse Python's own way to write ten."""
    done = harness("view", "paper_protocol", "--from", "1_0")
    assert done.code == 2
    assert "'1_0' is not a finite number" in done.err


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_a_log_has_the_recorded_ball_and_both_runs(
    harness: Harness, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    """Write a log without a display, with what the command says of it, over its own and not over a changed one."""
    pytest.importorskip("rerun")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    case, file = write_short_case(tmp_path / "case"), tmp_path / "log.rrd"
    command = ("view", case, "--engine", engine, "--effects", SEED, "--rerun", file)
    assert harness(*command, "--quiet").code == 0
    done = harness(*command, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert (told["log"], told["video"], told["frames"]) == (str(file), None, 0)

    read, log = load_case(case), Logged(file)
    (recording, *_) = (read.recordings[name] for name in read.identify)
    assert told["stamps"] == len(recording.time)
    kinds = {f"{engine}_simulated/{kind}_effects_found" for kind in ("without", "with")}
    for place in ("world/beam", "position_m", "residual_mm"):
        assert {f"{place}/{kind}" for kind in kinds} <= log.entities
    time, position = log.scalars("position_m/measured")
    known = np.isfinite(recording.position)
    np.testing.assert_allclose(time, recording.time[known], rtol=0.0, atol=1e-9)  # Rerun counts nanoseconds
    np.testing.assert_array_equal(position, recording.position[known])
    for run, kind in zip(told["runs"], ("without", "with"), strict=True):
        _, residual = log.scalars(f"residual_mm/{engine}_simulated/{kind}_effects_found")
        # The same differences, summed in another order.
        assert np.sqrt(np.mean(residual**2)) == pytest.approx(1e3 * run["rms_m"], rel=1e-9)

    file.write_bytes(file.read_bytes() + b"mine")
    refused = harness(*command)
    assert refused.code == 2
    assert "--force" in refused.err
    assert file.read_bytes().endswith(b"mine")
    assert {one.name for one in tmp_path.iterdir()} == {"case", "work", "log.rrd", ".log.rrd.json"}


def test_without_its_package_no_log_is_begun(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    """End with 2 and the line that installs it."""
    monkeypatch.setitem(sys.modules, "rerun", None)
    done = harness("view", "paper_protocol", "--rerun", "log.rrd")
    assert done.code == 2
    assert len(done.errors) == 1
    assert "pip install 'rerun-sdk>=0.41,<0.42'" in done.errors[0]
    assert list(done.folder.iterdir()) == []


def test_an_engine_that_fails_leaves_no_log(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    """End with 3 and no file where the engine gives no trustworthy run."""
    pytest.importorskip("rerun")

    def fails(*_: object, **__: object) -> None:
        raise EngineFailure("mujoco", Failure.NOT_FINITE, 0.5, "positions are not finite")

    monkeypatch.setattr("harness.viewing.runs.run_without", fails)
    done = harness("view", "paper_protocol", "--rerun", "log.rrd")
    assert done.code == 3
    assert list(done.folder.iterdir()) == []
