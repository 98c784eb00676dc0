"""A log for the Rerun viewer: the beam with all balls on it, what is plotted over time, and what happens, in words.

Positions are those of the stamps; nothing is interpolated. All balls lie on the beam at its recorded angle, in the
beam's frame, so that they can be compared by eye also where an effect makes the beam of a run another one.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.geometry import Channel
from analytic.motion import FloatArray
from harness.comparison.setting import Setting
from harness.errors import InputError
from harness.viewing.drawing import ENGINE_COLOUR, GHOST_COLOUR, GHOST_SIZE
from harness.viewing.playback import Playback
from harness.viewing.runs import ShownRun
from harness.viewing.told import Told

SUFFIX = ".rrd"
_APPLICATION = "ball-beam-harness"
TIMELINE = "time"  # [s] of the recording
BEAM, ANGLE, POSITION, RESIDUAL, EVENTS, ABOUT = (
    "world/beam",
    "beam_angle_deg",
    "position_m",
    "residual_mm",
    "events",
    "about",
)
DRIVE, READING = f"{ANGLE}/smoothed", f"{ANGLE}/recorded"
NOT_TRUSTED = f"{POSITION}/outliers"
_WITHOUT_COLOUR = (0.75, 0.30, 0.75)
_GREY, _DARK = (0.55, 0.58, 0.62), (0.35, 0.37, 0.40)
_AWAY, _UP = 1.0, 0.3  # of the eye from the middle of the beam, in its lengths
_SAME_ANGLE = 1e-9  # [rad]: below it the beam of a run is the recorded one, but for rounding
Colour = tuple[float, float, float]


def check_log_target(file: Path) -> None:
    """Refuse a file that no log can be written into, before anything is computed.

    Raises:
        InputError: it does not end in .rrd, or Rerun's package is not installed, or told by RERUN to log nothing.
    """
    if file.suffix.lower() != SUFFIX:
        raise InputError(f"{file}: a log for Rerun is written as {SUFFIX}; name it so")
    try:
        import rerun
    except ImportError as error:
        raise InputError(
            f"{file}: a log for Rerun needs a package that is not installed ({error}): "
            "pip install 'rerun-sdk>=0.41,<0.42'"
        ) from error
    if not rerun.is_enabled(rerun.RecordingStream(_APPLICATION)):
        raise InputError(f"{file}: the environment variable RERUN turns Rerun's logs off; unset it")


def name_of_recorded(playback: Playback) -> str:
    """Name of the recorded ball in a log."""
    return "recorded_simulated" if playback.simulated else "measured"


def name_of_run(playback: Playback, run: int) -> str:
    """Name of a run in a log: engine, that it is simulated, and whether the effects found act in it."""
    alone = re.sub(r"\W+", "_", playback.runs[0].name)  # such as as_rig_toml_says
    kinds = (alone,) if len(playback.runs) == 1 else ("without_effects_found", "with_effects_found")
    return f"{playback.engine}_simulated/{kinds[run]}"


def title_of_run(playback: Playback, run: int) -> str:
    """The same in words, short enough for a legend."""
    kinds = (playback.runs[0].name,) if len(playback.runs) == 1 else ("without the effects", "with the effects found")
    return f"{playback.engine}, simulated, {kinds[run]}"


def write_log(setting: Setting, playback: Playback, told: Sequence[Told], about: str, file: Path) -> int:
    """Write a log of what is shown; the number of stamps in it.

    Args:
        setting: the recording and its drive.
        playback: the runs over it, and which part of it is shown.
        told: what happens, in words.
        about: the whole in words.
        file: to write.

    Raises:
        OSError: it cannot be written.
    """
    import rerun

    stream = rerun.RecordingStream(_APPLICATION)
    storage = rerun.binary_stream(stream)
    stream.send_recording_name(f"{setting.case.path.name}, {setting.recording.name}")
    stream.send_blueprint(_layout(playback))
    log = _Log(stream, setting, playback)
    log.beam()
    log.recorded()
    for run in range(len(playback.runs)):
        log.run(run)
    for one in told:
        stream.set_time(TIMELINE, duration=one.time)
        stream.log(EVENTS, rerun.TextLog(one.text, level=one.level), strict=True)
    stream.reset_time()
    stream.log(ABOUT, rerun.TextDocument(about, media_type="text/plain"), static=True, strict=True)
    written = storage.read()
    assert written is not None, "only a stream that is turned off gives nothing"
    file.write_bytes(written)
    return len(log.time)


class _Log:
    """What goes into a stream of Rerun's, at the stamps of what is shown."""

    def __init__(self, stream: Any, setting: Setting, playback: Playback) -> None:
        import rerun

        self.rerun, self.stream, self.playback = rerun, stream, playback
        time = setting.time
        self.shown = (time >= playback.begin) & (time <= playback.end)
        self.time: FloatArray = time[self.shown]
        self.angle = setting.drive.evaluate(self.time)
        self.reading: FloatArray = setting.recording.angle[self.shown]
        self.position: FloatArray = setting.recording.position[self.shown]
        self.trusted: NDArray[np.bool_] = setting.ball.trusted[self.shown] & np.isfinite(self.position)

    def beam(self) -> None:
        """The turning beam, its angle as it was recorded, and smoothed, with which all runs are driven."""
        rerun, half = self.rerun, 0.5 * self.angle
        zero = np.zeros_like(half)
        turn = np.column_stack((zero, np.sin(half), zero, np.cos(half)))  # about +y, as (x, y, z, w)
        self._static("world", rerun.ViewCoordinates.RIGHT_HAND_Z_UP)
        self._static("world/pivot", rerun.Points3D([[0.0, 0.0, 0.0]], radii=0.004, colors=_rgb(_DARK)))
        self._send(BEAM, self.time, rerun.Transform3D.columns(quaternion=turn))
        channel = self.playback.channel
        centres, halves = boxes_of(channel)
        solid = rerun.components.FillMode.Solid
        boxes = rerun.Boxes3D(centers=centres, half_sizes=halves, colors=_rgb(_GREY), fill_mode=solid)
        self._static(f"{BEAM}/channel", boxes)
        self._points(READING, "recorded", _DARK, self.time, np.degrees(self.reading), size=2.0)
        self._line(DRIVE, "recorded, smoothed", _GREY, self.time, np.degrees(self.angle))

    def recorded(self) -> None:
        """The recorded ball where it is known and trusted, and the other readings of its position."""
        name, title = name_of_recorded(self.playback), self.playback.recorded_name
        wire = self.rerun.components.FillMode.MajorWireframe
        self._ball(name, title, GHOST_COLOUR, np.where(self.trusted, self.position, math.nan), wire, GHOST_SIZE)
        self._points(
            f"{POSITION}/{name}", title, GHOST_COLOUR, self.time[self.trusted], self.position[self.trusted], size=2.0
        )
        left_out = np.isfinite(self.position) & ~self.trusted
        if left_out.any():
            self._points(NOT_TRUSTED, "outliers", _DARK, self.time[left_out], self.position[left_out], size=4.0)

    def run(self, number: int) -> None:
        """One run: ball, positions, differences from the recorded ones, and its beam where that is another."""
        run, name = self.playback.runs[number], name_of_run(self.playback, number)
        title = title_of_run(self.playback, number)
        colour = colour_of(self.playback, number)
        position = at_stamps(run, self.time)
        self._ball(name, title, colour, position, self.rerun.components.FillMode.Solid, 1.0)
        known = np.isfinite(position)
        self._line(f"{POSITION}/{name}", title, colour, self.time[known], position[known])
        both = known & self.trusted
        residual = 1e3 * (position - self.position)[both]
        self._line(f"{RESIDUAL}/{name}", title, colour, self.time[both], residual)
        beam = run.motion.evaluate(self.time)
        if np.max(np.abs(beam - self.angle)) > _SAME_ANGLE:
            self._line(f"{ANGLE}/{name}", f"beam of {title}", colour, self.time, np.degrees(beam))

    def _ball(self, name: str, title: str, colour: Colour, position: FloatArray, fill: Any, size: float) -> None:
        """A ball on the beam at positions of shape (n,) [m]; there is none where they are NaN."""
        path, channel, known = f"{BEAM}/{name}", self.playback.channel, np.isfinite(position)
        count = int(known.sum())
        rest = np.full(count, channel.ball_height)
        centres = np.column_stack((position[known], np.zeros(count), rest))
        halves = np.full((count, 3), size * channel.ball_radius)
        columns = self.rerun.Ellipsoids3D.columns(centers=centres, half_sizes=halves)
        self._send(path, self.time, columns.partition(known.astype(int)))
        self._static(
            path,
            self.rerun.Ellipsoids3D.from_fields(
                colors=[_rgb(colour)], fill_mode=fill, labels=[title], show_labels=False, line_radii=[0.0006]
            ),
        )

    def _line(self, path: str, title: str, colour: Colour, time: FloatArray, value: FloatArray) -> None:
        self._static(path, self.rerun.SeriesLines(names=[title], colors=[_rgb(colour)], widths=[1.5]))
        self._send(path, time, self.rerun.Scalars.columns(scalars=value))

    def _points(self, path: str, title: str, colour: Colour, time: FloatArray, value: FloatArray, size: float) -> None:
        self._static(path, self.rerun.SeriesPoints(names=[title], colors=[_rgb(colour)], marker_sizes=[size]))
        self._send(path, time, self.rerun.Scalars.columns(scalars=value))

    def _static(self, path: str, what: Any) -> None:
        self.stream.log(path, what, static=True, strict=True)

    def _send(self, path: str, time: FloatArray, columns: Any) -> None:
        index = self.rerun.TimeColumn(TIMELINE, duration=time)
        self.stream.send_columns(path, indexes=[index], columns=columns, strict=True)


def at_stamps(run: ShownRun, time: FloatArray) -> FloatArray:
    """Positions of a run at stamps of the recording, shape (n,) [m]; NaN at those that are none of the run's."""
    place = np.searchsorted(run.time, time).clip(max=len(run.time) - 1)
    return np.where(run.time[place] == time, run.position[place], math.nan)


def boxes_of(channel: Channel) -> tuple[FloatArray, FloatArray]:
    """Centres and half sizes of both walls and the floor in the beam's frame, shape (3, 3) each [m]."""
    wall, length = channel.wall_thickness, 0.5 * channel.length
    height, across = 0.5 * (channel.wall_top - channel.floor_top), channel.half_width + 0.5 * wall
    middle = channel.floor_top + height
    under = channel.floor_top - 0.5 * channel.floor_thickness
    centres = [[channel.centre, across, middle], [channel.centre, -across, middle], [channel.centre, 0.0, under]]
    walls = [length, 0.5 * wall, height]
    return np.array(centres), np.array([walls, walls, [length, across + 0.5 * wall, 0.5 * channel.floor_thickness]])


def colour_of(playback: Playback, run: int) -> Colour:
    """Colour of a run, the last one's being that of the engine's ball in videos, 0 to 1."""
    return ENGINE_COLOUR if run == len(playback.runs) - 1 else _WITHOUT_COLOUR


def _rgb(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = (round(255 * one) for one in colour)
    return red, green, blue


def _layout(playback: Playback) -> Any:
    """Which windows the viewer opens with: the rig, three plots, and the words."""
    import rerun.blueprint as views

    titles: Mapping[str, str] = {
        ANGLE: "beam angle [deg]",
        POSITION: "ball position [m]",
        RESIDUAL: f"engine (simulated) − {playback.recorded_name} [mm]",
    }
    plots = [
        views.TimeSeriesView(origin=path, name=title, plot_legend=views.PlotLegend("RightTop"))
        for path, title in titles.items()
    ]
    channel = playback.channel
    eye = views.EyeControls3D(
        position=(channel.centre, -_AWAY * channel.length, _UP * channel.length),
        look_target=(channel.centre, 0.0, channel.edge_height),
        eye_up=(0.0, 0.0, 1.0),
    )
    kinds = [views.encodings.TextLogColumn(kind) for kind in ("LogLevel", "Body")]
    columns = views.archetypes.TextLogColumns(text_log_columns=kinds)
    words = views.Tabs(
        views.TextLogView(origin=EVENTS, name="events", columns=columns),
        views.TextDocumentView(origin=ABOUT, name="about"),
    )
    rig = views.Spatial3DView(origin="world", name="rig", eye_controls=eye)
    return views.Blueprint(
        views.Horizontal(views.Vertical(rig, words, row_shares=[3, 2]), views.Vertical(*plots), column_shares=[1, 1]),
        views.TimePanel(timeline=TIMELINE, state="collapsed"),
        views.SelectionPanel(state="collapsed"),
    )
