"""Shows a recording with an engine's run over it, in a window, as a video, or as a log for the Rerun viewer."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.case import Case, case_of, input_files
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.outputs import sealed_json
from harness.api.progress import shown
from harness.api.saved import LoadedDiagnosis, load_diagnosis
from harness.api.writing import all_or_nothing, hashes_of
from harness.errors import InputError
from harness.formatting import number
from harness.progress import Progress, Stage
from harness.report.tables import Summarised, Summary, Table, texts

if TYPE_CHECKING:
    from harness.comparison.setting import Setting
    from harness.recording import Case as CheckedCase
    from harness.viewing.playback import Playback
    from harness.viewing.windows import Window


@dataclass(frozen=True)
class ViewedRun:
    """One run of the engine over the recording.

    Attributes:
        name: what acts in it, in words.
        effects: names of the effects that act, declared ones included.
        rms_m, max_m: RMS and largest difference from the recorded positions, over the whole run [m].
        lifted_off_s: when the ball lifts off the beam, with which the run ends; `None` if it does not [s].
    """

    name: str
    effects: tuple[str, ...]
    rms_m: float
    max_m: float
    lifted_off_s: float | None = None


@dataclass(frozen=True, repr=False)
class View(Summarised):
    """What `view` showed.

    Attributes:
        case: whose recording was shown.
        recording: name of the recording.
        engine: name of the engine.
        begin: time of the recording from which on it was shown [s].
        end: time until which it was shown [s].
        runs: as rig.toml says, then with the effects of a diagnosis, if one was given.
        video: the video that was written; `None` if none was.
        log: the log for Rerun that was written; `None` if none was.
        stamps: number of those in the log; 0 if none was written.
        frames: number of those of the video; 0 if none was written, as the following.
        frames_per_s: how many are shown in a second [1/s].
        width: of the video [px].
        height: of the video [px].
        playback: positions, angles and turns as functions of time.
        crashed: why the window ended if it was not closed; empty otherwise.
    """

    case: Case
    recording: str
    engine: str
    begin: float
    end: float
    runs: tuple[ViewedRun, ...]
    video: Path | None
    log: Path | None
    stamps: int
    frames: int
    frames_per_s: int
    width: int
    height: int
    playback: Playback = field(compare=False)
    crashed: str = ""

    def content(self) -> dict[str, Any]:
        """As JSON."""
        plain = (
            "recording",
            "engine",
            "begin",
            "end",
            "runs",
            "stamps",
            "frames",
            "frames_per_s",
            "width",
            "height",
            "crashed",
        )
        files = {name: None if file is None else str(file) for name, file in (("video", self.video), ("log", self.log))}
        return {"origin": self.case.origin, **files, **{name: getattr(self, name) for name in (*plain, "crashed")}}

    def summary(self) -> Summary:
        """What was shown, and the errors of each run."""
        return _summary(self.case, self.recording, self.playback, self.runs, self.crashed)


def view(
    case: CheckedCase | str | Path,
    *,
    engine: str = "mujoco",
    recording: str | None = None,
    diagnosis: LoadedDiagnosis | str | Path | None = None,
    video: str | Path | None = None,
    rerun: str | Path | None = None,
    speed: float = 1.0,
    begin: float | None = None,
    end: float | None = None,
    settings: Mapping[str, Any] | None = None,
    effects: Sequence[Given] = (),
    force: bool = False,
    progress: bool | Progress = False,
) -> View:
    """Show an engine's run over a recording, and the recorded ball, in a window, as a video or as a log for Rerun.

    The engine runs over the whole recording first, with the checks of every run; then it is played back.

    Args:
        case: as of `load_case`, or its path.
        engine: `mujoco`, `pybullet` or `dart`.
        recording: which one of the case; the first to identify from if none is named.
        diagnosis: a diagnosis, a diagnosis.json or its folder; the effects found act in a second run.
        video: .mp4 or .gif to write; without it and `rerun` a window is opened, and the call ends when it is closed.
        rerun: .rrd to write, a log for the Rerun viewer; needs the extra `rerun`, and excludes `video`.
        speed: recorded seconds a second, of a window or a video.
        begin: from when on to show the recording, in its own time [s]; from its beginning if not given.
        end: until when; to its end if not given.
        settings: contact parameters of the engine, as in `{"friction": 0.3}`.
        effects: effects of your own that rig.toml or the diagnosis names, as Python files or as `Effect` objects.
        force: replace a file that no view wrote, or that has been changed since, too.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: anything given cannot be used, there is no display or no OpenGL, or a variable keeps MuJoCo from
            being loaded; nothing has been written then.
        EngineFailure: the engine gave no trustworthy run; likewise.
    """
    from harness.engines.catalogue import load_mujoco

    load_mujoco()
    from harness.viewing.film import HEIGHT, RATES, WIDTH, check_target
    from harness.viewing.rerun_log import check_log_target
    from harness.viewing.windows import check_display, window_of

    if not (math.isfinite(speed) and speed > 0.0):
        raise InputError(f"speed: {speed:g} is not a positive number of recorded seconds a second")
    if video is not None and rerun is not None:
        raise InputError("a video and a log for Rerun are written by a call each: drop --video or --rerun")
    if rerun is not None and speed != 1.0:
        raise InputError("a log for Rerun has the recording's own time, and its viewer a speed: drop --speed")
    target = None if video is rerun is None else Path(video if video is not None else rerun)  # type: ignore[arg-type]
    rate = 0
    if target is None:
        check_display()
    elif rerun is not None:
        check_log_target(target)
    else:
        rate = RATES[check_target(target)]
    given = effects or (diagnosis.own_effects if isinstance(diagnosis, LoadedDiagnosis) else ())
    with beside_catalogue(given), shown(progress) as tell:
        case = case_of(case)
        found = load_diagnosis(diagnosis) if isinstance(diagnosis, str | Path) else diagnosis
        inputs = [*input_files(case), *files_of(given), *([found.origin] if found and found.origin.is_file() else [])]
        # Entered first: what cannot be written need not be computed.
        with nullcontext() if target is None else _writing(target, inputs, force) as scratch:
            tell("drive and measured state", share=0.0)
            setting, playback = _played(case, engine, recording, found, settings or {}, (begin, end), tell)
            count = 0
            if target is not None and scratch is not None:
                file = scratch / target.name
                if rate:
                    count = _film(playback, file, speed, rate, Stage(tell, 0.3, 1.0, 1))
                else:
                    count = _log(setting, playback, found, file)
                told = {"command": "view", "recording": {setting.recording.name: setting.recording.sha256}}
                kept = sealed_json({**told, "files": hashes_of(scratch)})
                (scratch / _record(target)).write_text(kept, encoding="utf-8")
    crashed = ""
    if target is None:
        crashed = _open(window_of(engine), playback, speed)
    return View(
        case,
        setting.recording.name,
        engine,
        playback.begin,
        playback.end,
        _viewed(playback),
        video=target if rate else None,
        log=target if rerun is not None else None,
        stamps=0 if rate else count,
        frames=count if rate else 0,
        frames_per_s=rate,
        width=WIDTH if rate else 0,
        height=HEIGHT if rate else 0,
        playback=playback,
        crashed=crashed,
    )


def _film(playback: Playback, file: Path, speed: float, rate: int, progress: Progress) -> int:
    """Write a video; the number of its frames."""
    from harness.viewing.film import times_of, write_film

    times = times_of(playback, speed, rate)
    write_film(playback, file, times, speed=speed, rate=rate, progress=progress)
    return len(times)


def _log(setting: Setting, playback: Playback, found: LoadedDiagnosis | None, file: Path) -> int:
    """Write a log for Rerun; the number of its stamps."""
    from harness.viewing.rerun_log import write_log
    from harness.viewing.told import told_of

    told = told_of(setting, playback, None if found is None else found.record)
    about = _summary(setting.case, setting.recording.name, playback, _viewed(playback))
    return write_log(setting, playback, told, str(about.text()), file)


def _record(target: Path) -> str:
    """Name of the hidden file beside a video that says that it is this command's (`harness.api.writing`)."""
    return f".{target.name}.json"


def _writing(target: Path, inputs: Sequence[Path], force: bool) -> Any:
    record = _record(target)
    return all_or_nothing(target.parent, record=record, names=(target.name, record), inputs=inputs, force=force)


def _played(
    case: Case,
    name: str,
    recording: str | None,
    found: LoadedDiagnosis | None,
    settings: Mapping[str, Any],
    span: tuple[float | None, float | None],
    tell: Progress,
) -> tuple[Setting, Playback]:
    """The engine's runs over a recording, ready to be shown between two times [s]."""
    from harness.comparison import Choices, prepare
    from harness.engines.catalogue import engine_of
    from harness.viewing.playback import Playback
    from harness.viewing.runs import run_with, run_without

    engine = engine_of(name, case.scene)
    setting = prepare(case, Choices(recording=recording))
    begin, end = _span(setting, *span)
    tell(f"{name} over {setting.recording.name}", share=0.1)
    runs = [run_without(setting, engine, settings, beside=found is not None)]
    if found is not None:
        tell(f"{name} with what the diagnosis found", share=0.2)
        runs.append(run_with(setting, engine, settings, found.record.model, str(found.origin)))
    trusted = setting.ball.trusted
    stamps, reading = setting.time[trusted], setting.recording.position[trusted]
    return setting, Playback(name, tuple(runs), stamps, reading, begin, end, case.simulated)


def _span(setting: Setting, begin: float | None, end: float | None) -> tuple[float, float]:
    """What to show of a recording [s]: the whole, or the part that is asked for."""
    first, last = float(setting.time[0]), float(setting.time[-1])
    begin, end = first if begin is None else begin, last if end is None else end
    if not first <= begin < end <= last:
        raise InputError(
            f"{setting.recording.path}: there is nothing from {begin:g} s to {end:g} s to show; the recording is from "
            f"{first:g} s to {last:g} s"
        )
    return begin, end


def _viewed(playback: Playback) -> tuple[ViewedRun, ...]:
    from harness.viewing.runs import rms_and_largest

    stamps, reading = playback.stamps, playback.reading
    return tuple(
        ViewedRun(one.name, one.effects, *rms_and_largest(one, stamps, reading), one.lifted_off)
        for one in playback.runs
    )


def _open(window: Window, playback: Playback, speed: float) -> str:
    """Show a playback until its window is closed; why that crashed, if it did."""
    from harness.viewing.player import Player

    return window(playback, Player(playback.begin, playback.end, len(playback.runs), speed))


def _summary(
    case: CheckedCase, recording: str, playback: Playback, runs: Sequence[ViewedRun], crashed: str = ""
) -> Summary:
    """What was shown, and the errors of each run."""
    lines = [crashed] if crashed else []
    lines += [f"{playback.engine}, simulated, beside the {playback.recorded_name} ball of {recording}"]
    lines += [
        f"{one.name}: the ball lifts off the beam at {one.lifted_off_s:.2f} s, and the run ends there"
        for one in runs
        if one.lifted_off_s is not None
    ]
    since = playback.runs[0].time[0]
    rows = [(one.name, number(1e3 * one.rms_m), number(1e3 * one.max_m)) for one in runs]
    columns = [*texts("run"), "RMS error [mm]", "max error [mm]"]
    return Summary(f"View of {case.path}", lines, [Table(f"One free run from {since:.2f} s on", columns, rows)])
