"""A video or an animated picture of a playback: every frame with time, angle, positions and error written into it."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.progress import Progress, silent
from harness.viewing.drawing import ENGINE_COLOUR, GHOST_COLOUR, Drawing
from harness.viewing.offscreen import Picture, offscreen
from harness.viewing.playback import Instant, Playback

WIDTH, HEIGHT = 960, 540  # of a frame [pixels]
RATES = {".mp4": 30, ".gif": 25}  # frames a second; that of a GIF is counted in hundredths of a second
MOST_FRAMES = 20_000  # eleven minutes of video, which take about as long to draw
_QUALITY = 8  # of 10, of the H.264 encoder
_SIZE, _LINE, _EDGE, _DOT = 16, 22, 10, 6  # of letters, lines, the margin, a dot before a name [pixels]
_INK, _PAPER = (25, 30, 40), (255, 255, 255, 170)


def check_target(file: Path) -> str:
    """Suffix of a video's file.

    Raises:
        InputError: it is neither .mp4 nor .gif, or a package to write it is not installed.
    """
    suffix = file.suffix.lower()
    if suffix not in RATES:
        raise InputError(f"{file}: a video is written as .mp4 or .gif; name it so")
    try:
        import PIL.Image

        if suffix == ".mp4":
            import imageio_ffmpeg

            imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        raise InputError(
            f"{file}: a video needs packages that are not installed ({error}): pip install 'ball-beam-harness[video]'"
        ) from error
    assert PIL.Image
    return suffix


def times_of(playback: Playback, speed: float, rate: int) -> list[float]:
    """The recording's times of the frames [s], the first at its begin.

    Args:
        playback: what is shown.
        speed: recorded seconds a second of video.
        rate: frames a second.

    Raises:
        InputError: there would be more than `MOST_FRAMES`.
    """
    last = (playback.end - playback.begin) * rate / speed
    if last > MOST_FRAMES:
        raise InputError(
            f"this video would have {last:.3g} frames, more than {MOST_FRAMES}; give a higher --speed, or a part of "
            "the recording with --from and --to"
        )
    return [playback.begin + n * speed / rate for n in range(math.floor(last + 1e-9) + 1)]


def write_film(
    playback: Playback, file: Path, times: list[float], *, speed: float, rate: int, progress: Progress = silent
) -> None:
    """Write the frames at `times` [s] into a file that ends in .mp4 or .gif.

    Args:
        playback: what is shown; each of its runs has a strip of the frame of its own.
        file: to write.
        times: of the recording, one a frame [s].
        speed: recorded seconds a second, which is written into the frames.
        rate: frames a second.
        progress: receives the number of frames.

    Raises:
        InputError: no OpenGL works here.
    """
    with closing(_frames(playback, times, speed, progress)) as frames:
        (_write_gif if file.suffix.lower() == ".gif" else _write_mp4)(file, frames, rate)


def _write_mp4(file: Path, frames: Iterator[Picture], rate: int) -> None:
    import imageio_ffmpeg

    first = next(frames)  # before the encoder is started: drawing may be what does not work
    encoder = imageio_ffmpeg.write_frames(
        str(file),
        (WIDTH, HEIGHT),
        fps=rate,
        codec="libx264",
        quality=_QUALITY,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
    with closing(encoder):
        encoder.send(None)
        encoder.send(first)
        for frame in frames:
            encoder.send(frame)


def _write_gif(file: Path, frames: Iterator[Picture], rate: int) -> None:
    from PIL import Image

    pictures = (Image.fromarray(frame).quantize(256, Image.Quantize.FASTOCTREE) for frame in frames)
    first = next(pictures)
    first.save(file, save_all=True, append_images=pictures, duration=1000 // rate, loop=0)


def _frames(playback: Playback, times: list[float], speed: float, progress: Progress) -> Generator[Picture, None, None]:
    """Every frame, shape (HEIGHT, WIDTH, 3)."""
    count = len(playback.runs)
    with ExitStack() as stack:
        drawing = Drawing(playback)
        renderer = stack.enter_context(offscreen(drawing, WIDTH, HEIGHT // count))
        for number, time in enumerate(times):
            strips = []
            for run in range(count):
                now = drawing.place(run, time)
                strips.append(_labelled(renderer.picture(), playback, run, now, speed))
            if number % 10 == 0:
                progress(f"frame {number} of {len(times)}", share=number / len(times))
            yield np.concatenate(strips)


def _labelled(picture: Picture, playback: Playback, run: int, now: Instant, speed: float) -> Picture:
    """The picture with what is to be read in it."""
    from PIL import Image, ImageDraw

    image = Image.fromarray(picture)
    pen, font, lines = ImageDraw.Draw(image, "RGBA"), _font(), lines_of(playback, run, now, speed)
    rows = [lines[:1], lines[1:2], lines[2:]]  # both balls side by side
    widths = [sum(pen.textlength(text, font) + 7 * _DOT for text, _ in row) for row in rows]
    pen.rectangle((0, 0, max(widths) + _EDGE, len(rows) * _LINE + 1.5 * _EDGE), fill=_PAPER)
    for number, row in enumerate(rows):
        left, top = float(_EDGE), _EDGE + number * _LINE
        for text, colour in row:
            if colour is not None:
                pen.text((left, top), "●", font=font, fill=tuple(int(255 * c) for c in colour))
                left += 3 * _DOT
            pen.text((left, top), text, font=font, fill=_INK)
            left += pen.textlength(text, font) + 4 * _DOT
    return np.asarray(image)


def lines_of(
    playback: Playback, run: int, now: Instant, speed: float
) -> list[tuple[str, tuple[float, float, float] | None]]:
    """What is written into a picture, line by line, and the colour of the dot before a ball's line.

    Args:
        playback: what is shown.
        run: its number.
        now: beam and balls.
        speed: recorded seconds a second.
    """
    ball = f"{_mm(now.position)}{', beyond the drawn beam' if playback.beyond(now) else ''}"
    lifted_off = playback.runs[run].lifted_off
    if lifted_off is not None and not math.isfinite(now.position) and now.time > playback.runs[run].time[0]:
        ball = f"lifted off the beam at {lifted_off:.2f} s"
    pace = "" if speed == 1.0 else f"    shown at {speed:g} × real time"
    return [
        (f"{playback.engine}, simulated {playback.runs[run].name}{pace}", None),
        (f"t = {now.time:6.2f} s    beam angle {math.degrees(now.angle):+6.2f}°    error {_mm(now.error, '+')}", None),
        (f"{playback.engine} {ball}", ENGINE_COLOUR),
        (f"{playback.recorded_name} {_mm(now.recorded)}", GHOST_COLOUR),
    ]


def _mm(value: float, sign: str = "") -> str:
    return f"{1e3 * value:{sign}.1f} mm" if math.isfinite(value) else "not known"


def _font() -> Any:
    """A font with Greek letters, that comes with Matplotlib."""
    import matplotlib
    from PIL import ImageFont

    return ImageFont.truetype(str(Path(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), _SIZE)
